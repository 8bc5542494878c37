// Boxes as what is drawn and touched of them: the closed polyline or the triangles of their sides.

import { vector } from "./geometry.js";

const { plus, times, dot, cross, unit } = vector;
/** The rounding of a box that gives none, as a part of its shortest side. */
const USUAL_ROUNDING = 0.05;
/** Corners of the faces, counter-clockwise as seen from outside; the sign along the first side changes first. */
const FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/** The unit vectors along the sides. */
function axesOf({ center, x, y }) {
  if (center.length === 2) {
    const first = unit(x ?? [1, 0]);
    return [first, [-first[1], first[0]]];
  }
  const first = unit(x ?? [1, 0, 0]);
  const towards = y ?? [0, 1, 0];
  const second = unit(plus(towards, first, -dot(towards, first)));
  return [first, second, cross(first, second)];
}

function cornersOf(box) {
  const axes = axesOf(box);
  return [...Array(2 ** axes.length).keys()].map((corner) => axes.reduce((place, axis, number) =>
    plus(place, times(axis, (box.size[number] / 2) * ((corner >> number) & 1 ? 1 : -1))), box.center));
}

function sidesOf(box) {
  const { center, side } = box;
  const rounding = box.rounding ?? USUAL_ROUNDING * Math.min(...box.size);
  const points = cornersOf(box);
  if (center.length === 2) {
    return { kind: "polyline", points: [0, 1, 3, 2].map((corner) => points[corner]), closed: true, rounding, side, center };
  }
  const triangles = FACES.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]);
  return { kind: "triangle_mesh", points, triangles, rounding, side, center };
}

/** The model with the sides of its boxes in their place. */
export function withSides(model) {
  const entries = Object.entries(model.obstacles ?? {});
  if (!entries.some(([, { kind }]) => kind === "box")) return model;
  const lowered = entries.map(([name, obstacle]) => [name, obstacle.kind === "box" ? sidesOf(obstacle) : obstacle]);
  return { ...model, obstacles: Object.fromEntries(lowered) };
}
