// The legend below the plot of the paths: the names of the lines, paths that cannot be drawn, and the named points of the first
// path.

import { element, fill } from "./dom.js";
import { pathNames } from "./path-names.js";
import { dashedSwatch } from "./plot-style.js";
import { named } from "./points.js";
import { pointWords, short } from "./words.js";

/** The most named points in the list. */
const LISTED = 60;

/** `lacks(path)`: what the path has no values of, in words, or null; `exact`: the path in closed form that is laid over, or
 *  null. */
export function pathLegend(place, paths, looks, lacks, exact) {
  const names = paths.length > 1 ? pathNames(paths) : [];
  fill(place, names.map((name, which) => {
    const without = lacks(paths[which]);
    return element("li", { class: without ? "lacking" : null },
      element("span", { class: "swatch long line", style: dashedSwatch(looks.colour(paths[which]), looks.dash(paths[which])) }),
      name, without ? element("span", { class: "quiet" }, ` (not drawn: it has no ${without})`) : null);
  }),
  exact ? element("li", { title: exact.formula }, element("span", { class: "swatch dashed" }), `exact (${exact.name})`) : null);
}

/** `choose(index)` is told of a named point that is chosen. */
export function namedPoints(place, path, choose) {
  const found = named(path);
  const loads = path.columns.get("load_factor");
  fill(place, found.slice(0, LISTED).map((point) => element("li", {},
    element("button", {
      type: "button", class: "plain", "data-key": point.name, onclick: () => choose(point.index),
    }, element("b", {}, point.name), ` ${pointWords(point)} at load ${short(loads[path.placeOf(point.index)])}`,
    point.event ? `: ${point.event}` : ""))),
  found.length > LISTED ? element("li", {}, `and ${found.length - LISTED} more`) : null);
}
