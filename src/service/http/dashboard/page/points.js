// Names special points of a path: A, B, C, ... in order of appearance, as in the figures of papers.

const NAMED = new Set(["smooth_limit", "nonsmooth_limit", "smooth_bifurcation", "contact_change"]);

/** A to Z, then AA, AB and so on. */
export function letters(number) {
  let name = "";
  for (let left = number + 1; left > 0; left = Math.floor((left - 1) / 26)) {
    name = String.fromCharCode(65 + ((left - 1) % 26)) + name;
  }
  return name;
}

/** Path to its named points so far: `{taken, stretch, found}`. Points are only ever added to a path. */
const known = new WeakMap();

/**
 * Of a path's points that are not regular: [{name, index, kind, bifurcation, event}]. Of a stretch on which every increment has
 * more than one direction, the first is named.
 */
export function named(path) {
  if (!known.has(path)) known.set(path, { taken: 0, stretch: null, found: [] });
  const so = known.get(path);
  for (; so.taken < path.points.length; so.taken++) {
    const { index, point } = path.points[so.taken];
    const place = path.placeOf(index);
    const begins = point.bifurcation && so.stretch !== place - 1;
    if (point.bifurcation) so.stretch = place;
    if (point.kind === "start" || point.kind === "end") continue;
    if (NAMED.has(point.kind) || begins) {
      const kind = point.kind === "regular" ? "bifurcation" : point.kind;
      so.found.push({ name: letters(so.found.length), index, kind, bifurcation: point.bifurcation, event: point.event });
    }
  }
  return so.found;
}
