// Solids in the picture of a structure: their outlines, and their colours by the equivalent stress.

import { fromSheet } from "./plot-style.js";
import { headed } from "./units.js";
import { short, verbatim } from "./words.js";

/** The corners of an outline in order, with the middles of edges where the element has them; in space one outline a face. */
const OUTLINES = {
  triangle3: [[0, 1, 2]],
  triangle6: [[0, 3, 1, 4, 2, 5]],
  quadrilateral4: [[0, 1, 2, 3]],
  quadrilateral8: [[0, 4, 1, 5, 2, 6, 3, 7]],
  tetrahedron4: [[0, 1, 2], [0, 3], [1, 3], [2, 3]],
  tetrahedron10: [[0, 4, 1, 5, 2, 6], [0, 7, 3], [1, 8, 3], [2, 9, 3]],
  hexahedron8: [[0, 1, 2, 3], [4, 5, 6, 7], [0, 4], [1, 5], [2, 6], [3, 7]],
  hexahedron20: [
    [0, 8, 1, 9, 2, 10, 3, 11], [4, 12, 5, 13, 6, 14, 7, 15], [0, 16, 4], [1, 17, 5], [2, 18, 6], [3, 19, 7],
  ],
};

/** How many nodes each kind has. */
export const SOLIDS = {
  triangle3: [3], triangle6: [6], quadrilateral4: [4], quadrilateral8: [8],
  tetrahedron4: [4], tetrahedron10: [10], hexahedron8: [8], hexahedron20: [20],
};

export const isSolid = ({ kind }) => Object.hasOwn(SOLIDS, kind);

/** A single outline is a ring, and so are the first of a tetrahedron and the first two of a hexahedron. */
const isRing = ({ kind }, outline) =>
  OUTLINES[kind].indexOf(outline) < (kind.startsWith("hexahedron") ? 2 : 1);

/** Lines along the edges; rings are closed. */
export function edgesOf(item, places) {
  return (OUTLINES[item.kind] ?? []).map((outline) => {
    const line = outline.map((node) => places[node]);
    return isRing(item, outline) ? [...line, line[0]] : line;
  });
}

/** From no stress to the largest one. */
const STRESSES = ["#eef3d2", "#cfe3b4", "#9ccb9e", "#63ae94", "#348d8b", "#226a7f", "#27486f", "#2a2858"];

export class StressColours {
  /** `most`: the stress at the end of the scale. */
  constructor(most) {
    this.most = most;
    this.none = fromSheet("--zero");
  }

  of(stress) {
    if (stress === null || !(this.most > 0)) return this.none;
    return STRESSES[Math.min(STRESSES.length - 1, Math.floor((stress / this.most) * STRESSES.length))];
  }

  /** A trace without points that brings the scale; null where no solid has a stress. */
  scale(units) {
    if (!(this.most > 0)) return null;
    const { most } = this;
    const unit = units.force && units.length ? `${units.force}/${units.length}²` : "";
    const marks = [0, 0.25, 0.5, 0.75, 1].map((part) => part * most);
    return {
      name: "stress scale", type: "scatter", mode: "markers", x: [null], y: [null], hoverinfo: "skip",
      marker: {
        color: [0], cmin: 0, cmax: most, showscale: true,
        colorscale: STRESSES.flatMap((colour, place) => [[place / STRESSES.length, colour], [(place + 1) / STRESSES.length, colour]]),
        colorbar: {
          orientation: "h", thickness: 9, len: 0.9, x: 0.5, y: 0, yref: "container", yanchor: "bottom", ypad: 2, outlinewidth: 0,
          tickvals: marks, ticktext: marks.map((mark) => short(Number(mark.toPrecision(3)))), tickfont: { size: 11 },
          title: { text: verbatim(headed("von Mises stress", unit)), side: "bottom", font: { size: 12 } },
        },
      },
    };
  }
}
