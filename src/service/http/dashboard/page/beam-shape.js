// The shape of a beam between its nodes: cubic pieces, whose directions at the nodes are those of the unstressed
// beam, turned by the rotations there. At a hinge the shape has no curvature.

/** Points of a piece that is bent, and the angle (radians) below which it is drawn straight. */
const POINTS = 12;
const STRAIGHT = 0.01;
/** The largest angle between chord and end for which the piece is that of a circle. */
const LARGEST = 2.5;

const between = (from, to) => [to[0] - from[0], to[1] - from[1]];
const angleOf = ([x, y]) => Math.atan2(y, x);
/** The angle within half a turn of zero. */
const turned = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

/** Directions (radians) of the unstressed beam at its nodes: of a circle through three of them, or of a straight line. */
function directions(nodes) {
  const first = between(nodes[0], nodes[1]);
  if (nodes.length === 2) return [angleOf(first), angleOf(first)];
  const [second, whole] = [between(nodes[1], nodes[2]), between(nodes[0], nodes[2])];
  const lengths = [first, second, whole].map((chord) => Math.hypot(...chord));
  const curvature = (2 * (first[0] * second[1] - first[1] * second[0])) / (lengths[0] * lengths[1] * lengths[2]);
  const half = (length) => Math.asin(Math.max(-1, Math.min(1, (curvature * length) / 2)));
  return [angleOf(first) - half(lengths[0]), angleOf(first) + half(lengths[0]), angleOf(second) + half(lengths[1])];
}

/** The points of a piece; `ends`: directions at them, null at a hinge. */
function piece(from, to, ends) {
  const chord = between(from, to);
  const length = Math.hypot(...chord);
  const along = angleOf(chord);
  const known = ends.map((direction) => (direction === null ? null : turned(direction - along)));
  // Without a moment at an end, the slope there is minus half of that at the other.
  const slopes = known.map((slope, place) => slope ?? -(known[1 - place] ?? 0) / 2);
  if (Math.max(...slopes.map(Math.abs)) < STRAIGHT) return [from, to];
  const bend = Math.min(LARGEST, slopes.reduce((sum, slope) => sum + Math.abs(slope), 0) / 2);
  // The length of the tangents with which the cubic is next to an arc of a circle.
  const reach = length / Math.cos(bend / 2) ** 2;
  const tangents = slopes.map((slope) => [reach * Math.cos(along + slope), reach * Math.sin(along + slope)]);
  return Array.from({ length: POINTS + 1 }, (_, place) => {
    const t = place / POINTS;
    const [u, v] = [t * t * (3 - 2 * t), t * (1 - t)];
    return [0, 1].map((axis) => from[axis] + u * chord[axis] + v * ((1 - t) * tangents[0][axis] - t * tangents[1][axis]));
  });
}

const minus = (a, b) => a.map((value, axis) => value - b[axis]);
const scaled = (a, factor) => a.map((value) => factor * value);
const product = (a, b) => a.reduce((sum, value, axis) => sum + value * b[axis], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => scaled(a, 1 / (Math.hypot(...a) || 1));

/** A vector turned by a rotation vector (radians), by Rodrigues' formula. */
function turnedBy(vector, rotation) {
  const angle = Math.hypot(...rotation);
  if (angle === 0) return vector;
  const axis = scaled(rotation, 1 / angle);
  const [across, along] = [cross(axis, vector), product(axis, vector)];
  return vector.map((value, place) =>
    Math.cos(angle) * value + Math.sin(angle) * across[place] + (1 - Math.cos(angle)) * along * axis[place]);
}

/** Directions of the unstressed beam in space at its nodes: of the parabola through three of them, or of a straight line. */
function directionsInSpace([first, middle, last]) {
  if (last === undefined) return [unit(minus(middle, first)), unit(minus(middle, first))];
  const by = (a, b, c) => unit(first.map((value, axis) => a * value + b * middle[axis] + c * last[axis]));
  return [by(-3, 4, -1), by(-1, 0, 1), by(1, -4, 3)];
}

/** The points of a piece in space with these directions at its ends. */
function pieceInSpace(from, to, ends) {
  const chord = minus(to, from);
  const [length, along] = [Math.hypot(...chord), unit(chord)];
  const angles = ends.map((end) => Math.acos(Math.max(-1, Math.min(1, product(end, along)))));
  if (Math.max(...angles) < STRAIGHT) return [from, to];
  const reach = length / Math.cos(Math.min(LARGEST, (angles[0] + angles[1]) / 2) / 2) ** 2;
  return Array.from({ length: POINTS + 1 }, (_, place) => {
    const t = place / POINTS;
    const [u, v] = [t * t * (3 - 2 * t), t * (1 - t) * reach];
    return from.map((value, axis) => value + u * chord[axis] + v * ((1 - t) * ends[0][axis] - t * ends[1][axis]));
  });
}

/** As `beamShape`, in space; `rotations`: rotation vectors. */
export function spaceBeamShape(model, item, now, rotations) {
  const reference = directionsInSpace(item.nodes.map((name) => model.nodes[name]));
  const at = reference.map((direction, place) => turnedBy(direction, rotations[place]));
  return now.slice(1).reduce((points, to, place) =>
    [...points, ...pieceInSpace(now[place], to, [at[place], at[place + 1]]).slice(1)], [now[0]]);
}

/** The points of a beam in the plane from its first to its last node; `now`: its nodes' positions; `rotations`: theirs, in radians. */
export function beamShape(model, item, now, rotations) {
  const reference = item.nodes.map((name) => model.nodes[name]);
  const isReleased = (name) => Boolean(item.releases?.[name]?.includes("rz"));
  const at = directions(reference).map((direction, place) =>
    (isReleased(item.nodes[place]) ? null : direction + rotations[place]));
  const points = [now[0]];
  for (let place = 1; place < now.length; place += 1) {
    points.push(...piece(now[place - 1], now[place], [at[place - 1], at[place]]).slice(1));
  }
  return points;
}
