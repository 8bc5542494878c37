// Loads in the picture of a structure: forces, which point at their nodes, and displacements that supports impose.

import { acting, frame, vector } from "./geometry.js";
import { fromSheet } from "./plot-style.js";
import { angles } from "./turning-obstacles.js";
import { components, moment } from "./units.js";

const { plus, length, unit } = vector;
/** Lengths of arrows, as parts of the extent. */
const ARROW = 0.2;
const IMPOSED = 0.12;
/** Of the arc of a moment: its radius as a part of the extent, its points, and the angle (radians) that it goes through. */
const MOMENT = 0.05;
const POINTS = 16;
const THROUGH = 1.5 * Math.PI;

/**
 * What acts at an increment: `{forces, moments, displacements, motions}`, each a map of names to vectors, and `turns`, names of obstacles to
 * angles. Before the first increment: what the stages bring at load factor 1, all of them together.
 */
export function loadsOf(model, increment, reached) {
  const isAtRest = increment.index === null;
  const all = new Map(model.stages.map(({ name }) => [name, 1]));
  const seen = isAtRest ? { stage: null, load_factor: 0 } : increment;
  const of = (member) => acting(model, seen, isAtRest ? all : reached, member);
  return {
    forces: of("forces"), moments: of("moments"), displacements: of("displacements"), motions: of("obstacle_motion"),
    turns: angles(model, seen, isAtRest ? all : reached),
  };
}

const isSome = ([, vectorOf]) => length(vectorOf) > 0;

/** `most`: the force whose arrow has its full length. */
export function drawLoads(loads, extent, traces, { now, most, units, detail }) {
  const here = ([name]) => now.has(name);
  const forces = [...loads.forces].filter(here).filter(isSome);
  for (const [name, force] of detail.arrows(forces, "loads")) {
    const place = now.get(name);
    const tail = plus(place, force, -(ARROW * extent.size) / most);
    traces.arrow("load", tail, place, fromSheet("--load"), { words: `load on ${name}: ${components(force, units.force)}` });
  }
  for (const [name, [value]] of detail.arrows([...loads.moments].filter(here).filter(isSome), "moments")) {
    turn("moment", now.get(name), value, fromSheet("--load"), `moment on ${name}: ${moment(value, units)}`);
  }
  const { dimension } = detail;
  const shifts = [...loads.displacements].map(([name, vectorOf]) => [name, vectorOf.slice(0, dimension)]);
  const rotations = [...loads.displacements].map(([name, vectorOf]) => [name, vectorOf.slice(dimension)]);
  for (const [name, [angle]] of detail.arrows(rotations.filter(here).filter(isSome), "imposed rotations")) {
    turn("imposed rotation", now.get(name), angle, fromSheet("--imposed"), `imposed rotation of ${name}: ${angle} rad`);
  }
  const imposed = shifts.filter(here).filter(isSome);
  for (const [name, displacement] of detail.arrows(imposed, "imposed displacements")) {
    const place = now.get(name);
    traces.arrow("imposed displacement", place, plus(place, unit(displacement), IMPOSED * extent.size), fromSheet("--imposed"), {
      words: `imposed displacement of ${name}: ${components(displacement, units.length)}`, isAtHead: true,
    });
  }

  function turn(trace, place, value, color, words) {
    drawTurn(traces, extent, { trace, place, value, color, words });
  }
}

/** An arc about a place, in space about an axis through it, with its arrow in the direction of the value. */
export function drawTurn(traces, extent, { trace, place, axis, value, color, words }) {
  const radius = MOMENT * extent.size;
  const [first, second] = axis ? frame({ kind: "plane", normal: axis }, place).tangents : [[1, 0], [0, 1]];
  const points = Array.from({ length: POINTS + 1 }, (_, step) => {
    const angle = -Math.PI / 4 + Math.sign(value) * (step / POINTS) * THROUGH;
    return plus(plus(place, first, radius * Math.cos(angle)), second, radius * Math.sin(angle));
  });
  traces.lines(trace, [points.slice(0, -1)], { color, width: 2 });
  traces.arrow(`${trace} arrow`, points.at(-2), points.at(-1), color, { words });
}

/** The largest of the forces. */
export const largestOf = (vectors) => [...vectors.values()].reduce((most, one) => Math.max(most, length(one)), 0);
