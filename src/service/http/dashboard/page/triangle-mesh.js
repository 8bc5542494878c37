// Triangle meshes as obstacles: their edges in the picture, and the normals of their faces.

import { vector } from "./geometry.js";

const { plus, times, dot, cross, length, unit } = vector;
/** Neighbours whose normals have a cosine above this are one face. */
const FLAT = 1 - 1e-9;

const cornersOf = ({ points, triangles }) => triangles.map((numbers) => numbers.map((number) => points[number]));

const areaOf = ([a, b, c]) => cross(plus(b, a, -1), plus(c, a, -1));

/** 1 where the triangles are counter-clockwise as seen from outside, otherwise -1. */
function senseOf(corners) {
  const origin = corners[0][0];
  const volume = corners.reduce((sum, triangle) => {
    const [a, b, c] = triangle.map((corner) => plus(corner, origin, -1));
    return sum + dot(a, cross(b, c));
  }, 0);
  return volume < 0 ? -1 : 1;
}

/** The edges between faces that are not in one plane, as pairs of positions. */
export function meshEdges(mesh) {
  const normals = cornersOf(mesh).map((corners) => unit(areaOf(corners)));
  const beside = new Map();
  mesh.triangles.forEach(([a, b, c], number) => {
    for (const [from, to] of [[a, b], [b, c], [c, a]]) {
      const ends = [Math.min(from, to), Math.max(from, to)];
      const key = ends.join(" ");
      if (!beside.has(key)) beside.set(key, { ends, triangles: [] });
      beside.get(key).triangles.push(number);
    }
  });
  const isSharp = ({ triangles: [one, other] }) => other === undefined || dot(normals[one], normals[other]) < FLAT;
  return [...beside.values()].filter(isSharp).map(({ ends }) => ends.map((end) => mesh.points[end]));
}

function distanceToSide(place, from, to) {
  const way = plus(to, from, -1);
  const part = Math.min(1, Math.max(0, dot(plus(place, from, -1), way) / (dot(way, way) || 1)));
  return length(plus(plus(place, from, -1), way, -part));
}

function distanceTo(place, corners) {
  const normal = unit(areaOf(corners));
  const sides = corners.map((from, number) => [from, corners[(number + 1) % 3]]);
  const isOver = sides.every(([from, to]) => dot(cross(plus(to, from, -1), plus(place, from, -1)), normal) >= 0);
  if (isOver) return Math.abs(dot(plus(place, corners[0], -1), normal));
  return Math.min(...sides.map(([from, to]) => distanceToSide(place, from, to)));
}

/** The normal, into the free side, of the face nearest to a position. */
export function normalOfMesh(mesh, place) {
  const corners = cornersOf(mesh);
  const distances = corners.map((triangle) => distanceTo(place, triangle));
  const nearest = distances.indexOf(distances.reduce((least, distance) => Math.min(least, distance), Infinity));
  const outwards = times(unit(areaOf(corners[nearest])), senseOf(corners));
  return mesh.side === "inside" ? times(outwards, -1) : outwards;
}
