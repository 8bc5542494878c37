// The curve of an obstacle along a polyline: a cubic spline through its points, or its edges with rounded corners.

const STEPS = 12;
/** Sweeps of the iteration for the spline's slopes, each of which halves the error at least. */
const SWEEPS = 40;

const plus = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1]];
const minus = (a, b) => plus(a, b, -1);
const size = (a) => Math.hypot(...a);
const unit = (a) => a.map((value) => value / (size(a) || 1));
const known = new WeakMap();

/** Places along the curve with the unit normals into the free side; `isClosed`, and `outwards`: the directions in which the ends of
 *  an open curve go on. */
export function planeCurve(obstacle) {
  if (!known.has(obstacle)) known.set(obstacle, made(obstacle));
  return known.get(obstacle);
}

/** The normal at the drawn place of the curve that is closest to a place. */
export function normalOfCurve(obstacle, place) {
  const far = (at) => size(minus(at.place, place));
  return planeCurve(obstacle).places.reduce((best, at) => (far(at) < far(best) ? at : best)).normal;
}

function made({ points, closed = false, rounding, side }) {
  const pieces = rounding === undefined ? through(points, closed) : rounded(points, closed, rounding);
  const area = points.reduce((sum, [x, y], number) => {
    const [nextX, nextY] = points[(number + 1) % points.length];
    return sum + x * nextY - y * nextX;
  }, 0);
  const isLeftFree = !closed || area > 0 === (side === "inside");
  const at = (piece, t) => {
    const [[x, dx], [y, dy]] = [0, 1].map((k) => {
      const [a, b, c, d] = piece.map((part) => part[k]);
      return [a + t * (b + t * (c + t * d)), b + t * (2 * c + 3 * t * d)];
    });
    const left = unit([-dy, dx]);
    return { place: [x, y], normal: isLeftFree ? left : left.map((value) => -value) };
  };
  const places = pieces.flatMap((piece) => [...Array(STEPS).keys()].map((step) => at(piece, step / STEPS)));
  places.push(at(pieces.at(-1), 1));
  const along = ({ normal: [x, y] }) => [y, -x];
  const outwards = closed ? [] : [along(places[0]).map((value) => -value), along(places.at(-1))];
  return { places, isClosed: closed, outwards };
}

/** A piece in powers of its parameter, from its ends and the slopes there. */
const between = (start, end, leaves, arrives) => [start, leaves,
  [0, 1].map((k) => 3 * (end[k] - start[k]) - 2 * leaves[k] - arrives[k]),
  [0, 1].map((k) => leaves[k] + arrives[k] - 2 * (end[k] - start[k]))];

const edgesOf = (points, closed) => [...Array(points.length - (closed ? 0 : 1)).keys()].map((number) =>
  [points[number], points[(number + 1) % points.length]]);

function through(points, closed) {
  const edges = edgesOf(points, closed);
  const lengths = edges.map(([start, end]) => size(minus(end, start)));
  const count = points.length;
  const slopes = points.map(() => [0, 0]);
  for (let sweep = 0; sweep < SWEEPS; sweep++) {
    points.forEach((_, point) => {
      let [sum, weight] = [[0, 0], 0];
      for (const [edge, other] of [[point - 1, point - 1], [point, point + 1]]) {
        const number = closed ? (edge + count) % count : edge;
        const length = lengths[number];
        if (length === undefined) continue;
        const [start, end] = edges[number];
        sum = plus(plus(sum, minus(end, start), 3 / (length * length)), slopes[(other + count) % count], -1 / length);
        weight += 2 / length;
      }
      slopes[point] = sum.map((value) => value / weight);
    });
  }
  const scaled = (slope, length) => slope.map((value) => value * length);
  return edges.map(([start, end], edge) =>
    between(start, end, scaled(slopes[edge], lengths[edge]), scaled(slopes[(edge + 1) % count], lengths[edge])));
}

function rounded(points, closed, rounding) {
  const edges = edgesOf(points, closed);
  const ways = edges.map(([start, end]) => unit(minus(end, start)));
  return edges.flatMap(([from, corner], edge) => {
    const isFirst = !closed && edge === 0;
    const isLast = !closed && edge === edges.length - 1;
    const [start, end] = [plus(from, ways[edge], isFirst ? 0 : rounding), plus(corner, ways[edge], isLast ? 0 : -rounding)];
    const straight = [between(start, end, minus(end, start), minus(end, start))];
    if (isLast) return straight;
    const onwards = ways[(edge + 1) % ways.length];
    const control = [plus(end, ways[edge], -rounding), end, corner, plus(corner, onwards, rounding), plus(corner, onwards, 2 * rounding)];
    return [...straight, ...[0, 1].map((first) => spline(control.slice(first, first + 4)))];
  });
}

/** A piece of the uniform cubic B-spline with these control points. */
function spline([p, q, r, s]) {
  const sum = (...parts) => [0, 1].map((k) => parts.reduce((total, [point, weight]) => total + point[k] * weight, 0));
  return [sum([p, 1 / 6], [q, 4 / 6], [r, 1 / 6]), sum([p, -0.5], [r, 0.5]), sum([p, 0.5], [q, -1], [r, 0.5]),
    sum([p, -1 / 6], [q, 0.5], [r, -0.5], [s, 1 / 6])];
}
