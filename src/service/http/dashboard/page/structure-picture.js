// The picture of a structure: its traces, and axes that they fill, with a triad in space and the exaggeration where there is one.

import { SCALE_HEIGHT } from "./force-colours.js";
import { projection } from "./geometry.js";
import { axis, fromSheet, layout } from "./plot-style.js";
import { structureDrawing } from "./structure-drawing.js";
import { headed, unitsOf } from "./units.js";
import { short, verbatim } from "./words.js";

/** Room around all that is drawn, as a part of the structure's extent. */
const AROUND = 0.04;
/** The length of the triad's arrows and the distance of its origin from the corner, in pixels. */
const TRIAD = 30;
const CORNER = 40;
const TRIAD_COLOURS = ["#d0453b", "#2e9a5b", "#3486cc"];

/** `{traces, layout, leftOut}` for Plotly; `view`: see `structureDrawing`; `revision`: of the reader's zoom; `caption`: words in
 *  the picture. */
export function structurePicture(model, increment, view) {
  const isInSpace = model.dimension === 3;
  const { traces, leftOut, heights } = structureDrawing(model, increment, view);
  const [x, y] = ranges(view.extent, projection(model.dimension, view.turn));
  const unit = unitsOf(model).length;
  const below = traces.some(({ name }) => name === "force scale") ? SCALE_HEIGHT : 0;
  const plain = (name) => ({ ...axis(isInSpace ? "" : headed(name, unit)), zeroline: false, visible: !isInSpace });
  const whole = layout({
    margin: isInSpace ? { l: 8, r: 28, t: 30, b: 8 + below } : { l: 48, r: 28, t: 30, b: 40 + below },
    dragmode: isInSpace ? false : "pan",
    xaxis: { ...plain("x"), range: x }, yaxis: { ...plain("y"), range: y, scaleanchor: "x" },
    annotations: [...said(view, heights), ...(isInSpace ? triad(view.turn) : [])], uirevision: view.revision,
  });
  // Several lines.
  whole.hoverlabel.align = "left";
  return { traces, layout: whole, leftOut };
}

/** All that has been drawn, as it is seen from where it is looked at. */
function ranges(extent, flat) {
  const seen = extent.corners.map(flat);
  const around = AROUND * extent.size;
  return [0, 1].map((which) => {
    const values = seen.map((place) => place[which]);
    return [Math.min(...values) - around, Math.max(...values) + around];
  });
}

const words = (text, more) => ({
  text: verbatim(text), xref: "paper", yref: "paper", showarrow: false, font: { size: 12, color: fromSheet("--text") }, ...more,
});

/** What the picture has to say of itself. */
function said({ exaggeration, caption }, heights) {
  const told = [
    caption, heights, exaggeration === 1 ? null : `displacements × ${short(exaggeration)}; gaps are not to scale`,
  ].filter(Boolean);
  return told.map((text, line) => words(text, {
    x: 0, y: 1, xanchor: "left", yanchor: "top", yshift: -16 * line, name: "caption",
  }));
}

/** The directions of the axes, in the corner. */
function triad(turn) {
  const flat = projection(3, turn);
  return ["x", "y", "z"].map((name, which) => {
    const [right, up] = flat([0, 1, 2].map((one) => (one === which ? TRIAD : 0)));
    return {
      ...words(name), name: `triad ${name}`, showarrow: true, arrowside: "start", startarrowhead: 2, arrowwidth: 1.5, standoff: 0,
      x: 0, y: 0, xshift: CORNER, yshift: CORNER, ax: right, ay: -up, arrowcolor: TRIAD_COLOURS[which],
      font: { size: 12, color: TRIAD_COLOURS[which] },
    };
  });
}
