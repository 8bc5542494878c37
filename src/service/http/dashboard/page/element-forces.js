// The forces of elements at an increment: as the increment has them, or else computed from the positions of the nodes.

import { places, tension, vector } from "./geometry.js";

const { plus } = vector;

/**
 * For each element of the model `{axial, force, ends, moment, equivalent}`: the axial force of a bar or beam or the force of a spring, null where it is
 * not known, and where they are recorded the forces at a beam's ends, the moment of a rotational spring and the equivalent
 * stress of a solid.
 * `isComputed`: some of them are not recorded, and have been computed here.
 */
export function elementForces(model, increment) {
  const recorded = new Map((increment.elements ?? []).map((state) => [state.element, state]));
  // Forces belong to the positions as they are, however exaggerated the picture is.
  const now = places(model, increment);
  let isComputed = false;
  const of = (model.elements ?? []).map((item, number) => {
    const state = recorded.get(number);
    if (state) return recordedForces(state);
    // Those of beams need more than the positions of their nodes.
    if (item.kind !== "bar" && item.kind !== "spring") return { axial: null, force: null };
    if (item.nodes.some((name) => !now.has(name))) return { axial: null, force: null };
    isComputed = true;
    return computed(model, increment, item, now);
  });
  return { of, isComputed };
}

/** Of a beam the mean of its ends. */
function recordedForces(state) {
  const axial = state.ends ? (state.ends[0].axial_force + state.ends[1].axial_force) / 2 : state.axial_force;
  return {
    axial: axial ?? null, force: state.force ?? null, ends: state.ends, moment: state.moment ?? null, equivalent: state.von_mises ?? null,
  };
}

function computed(model, increment, item, now) {
  const [from, to] = item.nodes;
  if (item.kind === "bar") {
    return { axial: tension(item, now.get(from), now.get(to), model.nodes[from], model.nodes[to]), force: null };
  }
  const moved = (name) => increment.displacements[name];
  const relative = to === undefined ? moved(from) : plus(moved(from), moved(to), -1);
  return {
    axial: null, force: item.stiffness.map((row) => row.reduce((sum, value, axis) => sum + value * relative[axis], 0)),
  };
}
