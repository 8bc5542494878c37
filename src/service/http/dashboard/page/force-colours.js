// Colours of bars by their axial force: classes of equal width from the largest compression to the largest tension, and their
// scale in the picture.

import { fromSheet } from "./plot-style.js";
import { headed } from "./units.js";
import { short, verbatim } from "./words.js";

export const TENSION = ["#f0b7a8", "#e08770", "#cc5540", "#a62a1d"];
export const COMPRESSION = ["#b3cdea", "#7fabdb", "#4a86c8", "#2560a8"];
/** Classes on each side of zero. */
const CLASSES = TENSION.length;
/** Forces below this part of the largest axial stiffness count as zero. */
const ROUNDING = 1e-12;
/** Pixels below the picture that the scale takes. */
export const SCALE_HEIGHT = 44;

export class ForceColours {
  /** `most`: the force at the ends of the scale. */
  constructor(model, most) {
    this.model = model;
    this.zero = ROUNDING * (model.elements ?? []).reduce((sum, item) => Math.max(sum, item.axial_stiffness ?? 0), 0);
    this.most = most > this.zero ? most : 0;
    // Asked for once, as it takes long for very many bars.
    this.none = fromSheet("--zero");
  }

  of(force) {
    if (Math.abs(force) <= this.zero || this.most === 0) return this.none;
    const place = Math.min(CLASSES - 1, Math.floor((Math.abs(force) / this.most) * CLASSES));
    return (force > 0 ? TENSION : COMPRESSION)[place];
  }

  /** A trace without points that brings the scale; null where no bar has a force. */
  scale(unit) {
    if (this.most === 0) return null;
    const { most } = this;
    const stops = [...[...COMPRESSION].reverse(), ...TENSION];
    const marks = [-1, -0.5, 0, 0.5, 1].map((part) => part * most);
    return {
      name: "force scale", type: "scatter", mode: "markers", x: [null], y: [null], hoverinfo: "skip",
      marker: {
        color: [0], cmin: -most, cmax: most, showscale: true,
        colorscale: stops.flatMap((colour, place) => [[place / stops.length, colour], [(place + 1) / stops.length, colour]]),
        colorbar: {
          orientation: "h", thickness: 9, len: 0.9, x: 0.5, y: 0, yref: "container", yanchor: "bottom", ypad: 2, outlinewidth: 0,
          tickvals: marks, ticktext: marks.map((mark) => short(Number(mark.toPrecision(3)))), tickfont: { size: 11 },
          title: { text: verbatim(headed("axial force, tension positive", unit)), side: "bottom", font: { size: 12 } },
        },
      },
    };
  }
}
