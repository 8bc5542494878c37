// The points of a path at which something happens. Those that the picture of `arcslip solve --plot` letters have the same
// letters here: limit points, contact changes, jumps and ends, in order of appearance. Bifurcation points have none.

const LETTERED = new Set(["smooth_limit", "nonsmooth_limit", "contact_change", "end", "jump"]);

/** A to Z, then AA, AB and so on. */
export function letters(number) {
  let name = "";
  for (let left = number + 1; left > 0; left = Math.floor((left - 1) / 26)) {
    name = String.fromCharCode(65 + ((left - 1) % 26)) + name;
  }
  return name;
}

/** Path to its points so far: `{taken, stretch, lettered, found}`. Points are only ever added to a path. */
const known = new WeakMap();

/**
 * Of a path's points that are not regular: [{name, index, kind, bifurcation, event}]. Of a stretch on which every increment has
 * more than one direction, the first is among them. The name is empty where there is no letter.
 */
export function named(path) {
  if (!known.has(path)) known.set(path, { taken: 0, stretch: null, lettered: 0, found: [] });
  const so = known.get(path);
  for (; so.taken < path.points.length; so.taken++) {
    const { index, point } = path.points[so.taken];
    const place = path.placeOf(index);
    const begins = point.bifurcation && so.stretch !== place - 1;
    if (point.bifurcation) so.stretch = place;
    const isLettered = LETTERED.has(point.kind);
    if (point.kind === "start" || !(isLettered || begins || point.kind === "smooth_bifurcation")) continue;
    so.found.push({
      name: isLettered ? letters(so.lettered++) : "", index, kind: isLettered ? point.kind : "bifurcation",
      bifurcation: point.bifurcation, event: point.event,
    });
  }
  return so.found;
}

const MOVED = new Set(["jump", "motion"]);
/** Path to the places of some of its points: `{taken, branching, moved}`. */
const places = new WeakMap();

function placesOf(path) {
  if (!places.has(path)) places.set(path, { taken: 0, branching: new Set(), moved: new Set() });
  const so = places.get(path);
  for (; so.taken < path.points.length; so.taken++) {
    const { index, point } = path.points[so.taken];
    if (point.bifurcation) so.branching.add(path.placeOf(index));
    if (MOVED.has(point.kind)) so.moved.add(path.placeOf(index));
  }
  return so;
}

/** The places of a path's increments at which there is more than one way on. */
export const branchingPlaces = (path) => placesOf(path).branching;
/** The places of a path's increments to which the structure has moved in a jump. */
export const movedPlaces = (path) => placesOf(path).moved;
