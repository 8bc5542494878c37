// Positions and forces of a structure at an increment, in the coordinates of the model.

import { normalOfCurve } from "./plane-curve.js";

const plus = (a, b, factor = 1) => a.map((value, place) => value + factor * (b[place] ?? 0));
const times = (a, factor) => a.map((value) => value * factor);
const dot = (a, b) => a.reduce((sum, value, place) => sum + value * b[place], 0);
const length = (a) => Math.hypot(...a);
const unit = (a) => times(a, 1 / (length(a) || 1));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

export const vector = { plus, times, dot, length, unit, cross };

/** Node name to position, for the recorded nodes, with displacements so many times as large as they are. */
export function places(model, increment, exaggeration = 1) {
  return new Map(Object.entries(model.nodes).filter(([name]) => increment.displacements[name])
    .map(([name, place]) => [name, plus(place, increment.displacements[name], exaggeration)]));
}

/** What acts at an increment of a member of the stages (`forces`, `moments`, `displacements`, `obstacle_motion`), by name: the patterns of
 *  earlier stages times what they came to, plus that of the current stage times its load factor. `numbers`: those of a pattern. */
export function acting(model, increment, reached, member, numbers = (given) => [given].flat()) {
  const sums = new Map();
  for (const stage of model.stages) {
    const isRunning = stage.name === increment.stage;
    const factor = isRunning ? increment.load_factor : reached.get(stage.name) ?? 0;
    for (const [name, given] of Object.entries(stage[member] ?? {})) {
      const pattern = numbers(given);
      sums.set(name, plus(sums.get(name) ?? times(pattern, 0), pattern, factor));
    }
    if (isRunning) break;
  }
  return sums;
}

/** A place relative to the centre of a ball, or to the axis of a cylinder and perpendicular to it. */
export function fromMiddle(obstacle, place, moved = []) {
  if (obstacle.kind === "ball") return plus(place, plus(obstacle.center, moved), -1);
  const axis = unit(obstacle.axis);
  const from = plus(place, plus(obstacle.point, moved), -1);
  return plus(from, axis, -dot(from, axis));
}

/** The unit vectors of the coordinates of a polyline's points, and across their plane. */
export function sectionAxes({ section }) {
  const x = unit(section.x);
  const across = unit(cross(x, section.y));
  return [x, cross(across, x), across];
}

/** The normal of a polyline in space, or in the plane. */
function normalOfPolyline(obstacle, place) {
  if (!obstacle.section) return normalOfCurve(obstacle, place);
  const [x, y] = sectionAxes(obstacle);
  const from = plus(place, obstacle.section.origin, -1);
  const [along, up] = normalOfCurve(obstacle, [dot(from, x), dot(from, y)]);
  return plus(times(x, along), y, up);
}

/** The normal of an obstacle into the free side at a position, and the tangents to which the reactions refer. */
export function frame(obstacle, place, moved = []) {
  if (obstacle.turned) {
    // The tangents of an obstacle that turns turn with it.
    const { original, pivot, into, outOf } = obstacle.turned;
    const own = frame(original, plus(pivot, into(plus(plus(place, moved, -1), pivot, -1))));
    return { normal: outOf(own.normal), tangents: own.tangents.map(outOf) };
  }
  return framed(normalOf(obstacle, place, moved));
}

function normalOf(obstacle, place, moved) {
  if (obstacle.kind === "plane") return unit(obstacle.normal);
  if (obstacle.kind === "polyline") return normalOfPolyline(obstacle, plus(place, moved, -1));
  const out = unit(fromMiddle(obstacle, place, moved));
  return obstacle.side === "inside" ? times(out, -1) : out;
}

/** A normal with the tangents that belong to it. */
export function framed(normal) {
  if (normal.length === 2) return { normal, tangents: [[normal[1], -normal[0]]] };
  // Of axes equally aligned but for round-off the first.
  const least = normal.findIndex((value) => Math.abs(value) <= Math.min(...normal.map(Math.abs)) + 1e-9);
  const along = [0, 0, 0].map((_, axis) => (axis === least ? 1 : 0));
  const first = unit(plus(along, normal, -dot(along, normal)));
  return { normal, tangents: [first, cross(normal, first)] };
}

/** The tension of a bar for its strain measure. */
export function tension(bar, from, to, referenceFrom, referenceTo) {
  const reference = bar.rest_length ?? length(plus(referenceTo, referenceFrom, -1));
  const stretch = length(plus(to, from, -1)) / reference;
  const stiffness = bar.axial_stiffness;
  const prestress = bar.prestress ?? 0;
  switch (bar.strain ?? "engineering") {
    case "green": return (stiffness * (stretch * stretch - 1) / 2) * stretch + prestress;
    case "log": return (stiffness * Math.log(stretch)) / stretch + prestress;
    default: return stiffness * (stretch - 1) + prestress;
  }
}

/** Projects positions in space onto the picture for an azimuth and an elevation (degrees); plane positions are unchanged. */
export function projection(dimension, { azimuth, elevation }) {
  if (dimension === 2) return (place) => place;
  const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
  const right = [-Math.sin(a), Math.cos(a), 0];
  const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
  return (place) => [dot(place, right), dot(place, up)];
}
