// Sentences below the plot of paths on what it does not show, and the exact path under it.

import { EXACT, fromSheet } from "./plot-style.js";
import { notRecordedWords } from "./quantity-groups.js";
import { ofDisplacement, quantityWords } from "./quantities.js";
import { stagesOf } from "./path-legend.js";

/** `marked`: increments up to which each has a marker; `lettered`: curves up to which points have letters. */
export function pathWords({ curves, sweep, runs, marked, lettered }) {
  const [{ path }] = curves;
  const many = Math.max(...curves.map((curve) => curve.path.index.length));
  const lacking = curves.length === 1 ? curves[0].lacks() : null;
  const isEmpty = curves.every((curve) => curve.path.index.length === 0);
  return [
    isEmpty ? "No increment is stored yet: there is nothing to draw." : null,
    lacking ? `Nothing is drawn: no increment has a value of ${quantityWords(lacking, path.request)}.` : null,
    curves.length > 1 && curves.some((curve) => stagesOf(curve.path).length > 1)
      ? "A line is interrupted where a stage begins; a square is where one ends." : null,
    curves.length > lettered
      ? `With more than ${lettered} curves points have no letters; they are named below, of the first path.` : null,
    many > marked ? `Of more than ${marked} increments none has a dot.` : null,
    sweep?.problem ? `The sweep of these runs cannot be read, and so it gives no colours: ${sweep.problem}` : null,
    runs && !runs.isScale ? "What differs in these runs is no number, and so the colours have no scale." : null,
    notRecordedWords(path.request),
  ].filter(Boolean).join(" ");
}

/** The exact solution of the first path, drawn as a pale band under all of them; null where there is none of what is drawn. */
export function exactTrace(curves) {
  const found = curves[0]?.path.exact?.path;
  const of = ofDisplacement(curves[0]?.abscissa);
  const curve = curves.find(({ path, ordinate }) => path === curves[0].path && ordinate === "load_factor");
  if (!found || !of || !curve) return null;
  const [x, y] = [[], []];
  for (const stage of found.stages) {
    x.push(...(stage.displacements[of.node]?.[of.component] ?? []), null);
    y.push(...stage.load_factor, null);
  }
  return {
    x, y, type: "scatter", mode: "lines", name: "exact", hoverinfo: "skip", yaxis: curve.yaxis, zorder: 0, showlegend: false,
    opacity: EXACT.opacity, line: { color: fromSheet("--text"), width: EXACT.width },
  };
}
