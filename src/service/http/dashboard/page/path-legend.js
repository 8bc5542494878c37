// What stands below the plot of the paths: the names of the curves, the key of lines and marks, and the points of the first
// path at which something happens.

import { element, fill } from "./dom.js";
import { MARKS } from "./path-curve.js";
import { pathNames } from "./path-names.js";
import { dashedSwatch, EXACT, fromSheet, stageColour, stageDash } from "./plot-style.js";
import { branchingPlaces, movedPlaces, named } from "./points.js";
import { quantityWords } from "./quantities.js";
import { kindWords, pointWords, short } from "./words.js";

/** The most points in the list, and the most stages in the key. */
const LISTED = 60;
const STAGES = 20;
/** The part of an axis from which on a stretch is seen. */
const SEEN = 0.005;
const SIGNS = { smooth_limit: "●", nonsmooth_limit: "◆", contact_change: "○", end: "■", jump: "▲", bifurcation: "◇" };

/** A name for each curve. */
export function curveNames(curves, runs) {
  const paths = [...new Set(curves.map(({ path }) => path))];
  const isOne = curves.every(({ ordinate }) => ordinate === curves[0].ordinate);
  const ofPath = new Map(paths.length > 1 ? pathNames(paths, runs).map((name, place) => [paths[place], name]) : []);
  return curves.map(({ path, ordinate, yaxis }) => [
    ofPath.get(path),
    isOne ? null : `${quantityWords(ordinate, path.request)}${yaxis === "y2" ? " (axis on the right)" : ""}`,
  ].filter(Boolean).join(": "));
}

/** `exact`: the path in closed form that is drawn under them, or null. */
export function pathLegend(place, curves, runs, exact) {
  const names = curves.length > 1 ? curveNames(curves, runs) : [];
  fill(place, names.map((name, which) => {
    const { colour, dash } = curves[which];
    const without = curves[which].lacks();
    return element("li", { class: without ? "lacking" : null },
      element("span", { class: "swatch long line", style: dashedSwatch(colour, dash) }),
      name, without ? element("span", { class: "quiet" }, ` (not drawn: it has no ${quantityWords(without)})`) : null);
  }),
  exact ? element("li", { title: exact.formula }, element("span", { class: "swatch long", style: `background:var(--text);opacity:${EXACT.opacity}` }), `exact (${exact.name})`) : null);
}

/** The rows of the key, `[{words, colour, dash} or {words, colour, filling, sign, symbol}]`. */
export function keyRows(curves) {
  const paths = [...new Set(curves.map(({ path }) => path))];
  const isAlone = curves.length === 1;
  const rows = isAlone ? stageRows(curves[0]) : [];
  const ink = fromSheet("--text");
  if (paths.some(falls)) {
    const words = "the load falls: a load that only grows leaves the path here";
    rows.push({ words, colour: isAlone ? curves[0].colour : ink, dash: "dot" });
  }
  if (curves.some(showsBranches)) {
    rows.push({ words: "bifurcation points: more than one way on", colour: fromSheet("--bifurcation"), dash: "solid" });
  }
  if (paths.some((path) => movedPlaces(path).size > 0)) {
    rows.push({ words: "jump: no states of equilibrium between", colour: fromSheet("--quiet"), dash: "dash" });
  }
  const kinds = new Set(paths.flatMap((path) => named(path).map(({ kind }) => kind)));
  for (const [kind, [colour, symbol, filling]] of Object.entries(MARKS)) {
    if (!kinds.has(kind)) continue;
    const words = kind === "bifurcation" ? "bifurcation points begin" : kindWords(kind);
    rows.push({ words, colour: fromSheet(colour), filling: fromSheet(filling), sign: SIGNS[kind], symbol });
  }
  return rows;
}

export function lineKey(place, curves) {
  fill(place, keyRows(curves).map(({ words, colour, dash, sign }) => element("li", {},
    sign ? element("span", { class: "sign", style: `color:${colour}`, "aria-hidden": "true" }, sign)
      : element("span", { class: "swatch long line", style: dashedSwatch(colour, dash) }), words)));
}

function stageRows({ path, colour }) {
  const names = stagesOf(path);
  const rows = names.slice(0, STAGES).map((name, stage) => ({
    words: `stage ${name}`, colour: stage % 4 ? stageColour(stage) : colour, dash: stageDash(stage),
  }));
  if (names.length > STAGES) rows.push({ words: `and ${names.length - STAGES} more stages`, colour: "transparent", dash: "solid" });
  return rows;
}

/** The names of the stages that the path has reached, in order. */
export function stagesOf(path) {
  return path.columns.get("stage").filter((name, place, all) => place === 0 || name !== all[place - 1]);
}

/** Whether a line of the path begins at a bifurcation; a jump from one is a line of its own. */
function branches(path) {
  const moved = movedPlaces(path);
  return [...branchingPlaces(path)].some((place) => !moved.has(place + 1));
}

/** Whether a stretch of bifurcation points is long enough to be seen. */
function showsBranches({ path, xs, ys }) {
  if (!branches(path)) return false;
  const places = [...branchingPlaces(path)].filter((place) => place + 1 < path.index.length);
  return [xs, ys].some((values) => {
    const [low, high] = values.reduce(([least, most], value) =>
      (typeof value === "number" ? [Math.min(least, value), Math.max(most, value)] : [least, most]), [Infinity, -Infinity]);
    const gone = places.reduce((sum, place) => sum + Math.abs((values[place + 1] ?? 0) - (values[place] ?? 0)), 0);
    return gone > SEEN * (high - low);
  });
}

function falls(path) {
  const [stages, loads] = [path.columns.get("stage"), path.columns.get("load_factor")];
  return loads.some((load, place) => place > 0 && stages[place] === stages[place - 1] && load < loads[place - 1]);
}

/** A point of the list in words. */
export function namedWords(path, point) {
  const load = path.columns.get("load_factor")[path.placeOf(point.index)];
  return `${pointWords(point)} at load ${short(load)}${point.event ? `: ${point.event}` : ""}`;
}

/** The points of paths `{path, whose, choose}`: `whose` is the name of the path where others are drawn, too; `choose(index)` is
 *  told of a point that is chosen. */
export function namedPoints(place, paths) {
  fill(place, paths.flatMap(({ path, whose, choose }) => {
    const found = named(path);
    return [
      whose && found.length > 0 ? element("li", { class: "quiet" }, `Points of ${whose}:`) : null,
      ...found.slice(0, LISTED).map((point) => element("li", {}, element("button", {
        type: "button", class: "plain", "data-key": `point ${path.id} ${point.index}`, onclick: () => choose(point.index),
      }, element("span", { class: "letter" }, point.name || SIGNS.bifurcation), ` ${namedWords(path, point)}`))),
      found.length > LISTED ? element("li", {}, `and ${found.length - LISTED} more`) : null,
    ];
  }));
}
