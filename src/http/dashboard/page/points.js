// Names of the points that a reader looks for: A, B, C, ... in order of appearance, as in the figures of papers.

const NAMED = new Set(["smooth_limit", "nonsmooth_limit", "smooth_bifurcation", "contact_change"]);

/** A to Z, then AA, AB and so on. */
export function letters(number) {
  let name = "";
  for (let left = number + 1; left > 0; left = Math.floor((left - 1) / 26)) {
    name = String.fromCharCode(65 + ((left - 1) % 26)) + name;
  }
  return name;
}

/**
 * Of a path's points that are not regular: [{name, index, kind, bifurcation, event}]. Of a stretch on which every increment has
 * more than one direction, the first is named.
 */
export function named(path) {
  const found = [];
  let stretch = null;
  for (const { index, point } of path.points) {
    const place = path.placeOf(index);
    const begins = point.bifurcation && stretch !== place - 1;
    if (point.bifurcation) stretch = place;
    if (point.kind === "start" || point.kind === "end") continue;
    if (NAMED.has(point.kind) || begins) {
      const kind = point.kind === "regular" ? "bifurcation" : point.kind;
      found.push({ name: letters(found.length), index, kind, bifurcation: point.bifurcation, event: point.event });
    }
  }
  return found;
}
