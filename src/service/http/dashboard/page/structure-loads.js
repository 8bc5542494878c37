// Loads in the picture of a structure: forces, which point at their nodes, and displacements that supports impose.

import { acting, vector } from "./geometry.js";
import { fromSheet } from "./plot-style.js";
import { components } from "./units.js";

const { plus, length, unit } = vector;
/** Lengths of arrows, as parts of the extent. */
const ARROW = 0.2;
const IMPOSED = 0.12;

/**
 * What acts on the nodes at an increment: `{forces, displacements, motions}`, each a map of names to vectors. Before the first
 * increment: what the stages bring at load factor 1, all of them together.
 */
export function loadsOf(model, increment, reached) {
  const isAtRest = increment.index === null;
  const all = new Map(model.stages.map(({ name }) => [name, 1]));
  const seen = isAtRest ? { stage: null, load_factor: 0 } : increment;
  const of = (member) => acting(model, seen, isAtRest ? all : reached, member);
  return { forces: of("forces"), displacements: of("displacements"), motions: of("obstacle_motion") };
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
  const imposed = [...loads.displacements].filter(here).filter(isSome);
  for (const [name, displacement] of detail.arrows(imposed, "imposed displacements")) {
    const place = now.get(name);
    traces.arrow("imposed displacement", place, plus(place, unit(displacement), IMPOSED * extent.size), fromSheet("--imposed"), {
      words: `imposed displacement of ${name}: ${components(displacement, units.length)}`, isAtHead: true,
    });
  }
}

/** The largest of the forces. */
export const largestOf = (vectors) => [...vectors.values()].reduce((most, one) => Math.max(most, length(one)), 0);
