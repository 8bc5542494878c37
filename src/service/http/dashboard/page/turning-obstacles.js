// Obstacles that turn, where they are at an increment.

import { acting, vector } from "./geometry.js";

const { plus, times, dot, cross, unit } = vector;

/** Obstacle name to angle (radians), as the stages up to an increment came to. */
export function angles(model, increment, reached) {
  const sums = acting(model, increment, reached, "obstacle_rotation", ({ angle }) => [angle]);
  return new Map([...sums].map(([name, [angle]]) => [name, angle]));
}

/** `{place, axis}`: where an obstacle turns; in the plane without an axis. */
function pivotOf(model, name) {
  const given = model.stages.map((stage) => stage.obstacle_rotation?.[name]).find(Boolean);
  const obstacle = model.obstacles[name];
  const place = given?.about ?? obstacle.point ?? obstacle.center;
  const axis = model.dimension === 3 ? given?.axis ?? (obstacle.kind === "cylinder" ? obstacle.axis : null) : null;
  return place && (model.dimension === 2 || axis) ? { place, axis: axis && unit(axis) } : null;
}

/** A vector turned by an angle. */
function turned(v, axis, angle) {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  if (!axis) return [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]];
  return plus(plus(times(v, cosine), cross(axis, v), sine), axis, (1 - cosine) * dot(axis, v));
}

/** The model with its obstacles turned by these angles. A turned obstacle has `turned`: `{original, pivot, axis, into, outOf}` with
 *  functions of vectors into its own axes and out of them. */
export function withTurned(model, turns) {
  const some = [...turns].filter(([name, angle]) => angle !== 0 && model.obstacles?.[name]);
  if (!some.length) return model;
  const obstacles = { ...model.obstacles };
  for (const [name, angle] of some) {
    const pivot = pivotOf(model, name);
    if (pivot) obstacles[name] = turnedObstacle(model.obstacles[name], pivot, angle);
  }
  return { ...model, obstacles };
}

function turnedObstacle(obstacle, { place: pivot, axis }, angle) {
  const outOf = (v) => turned(v, axis, angle);
  const into = (v) => turned(v, axis, -angle);
  const place = (point) => plus(pivot, outOf(plus(point, pivot, -1)));
  const own = { ...obstacle, turned: { original: obstacle, pivot, axis: axis ?? undefined, into, outOf } };
  for (const member of ["point", "center"]) if (obstacle[member]) own[member] = place(obstacle[member]);
  for (const member of ["normal", "axis"]) if (obstacle[member]) own[member] = outOf(obstacle[member]);
  if (obstacle.section) {
    const { origin, x, y } = obstacle.section;
    own.section = { origin: place(origin), x: outOf(x), y: outOf(y) };
  } else if (obstacle.points) own.points = obstacle.points.map(place);
  return own;
}
