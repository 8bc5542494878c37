// A structure at an increment as traces: deformed over undeformed, bars by their force, obstacles, supports, loads, contacts by
// state, reactions with their friction cones.

import { elementForces } from "./element-forces.js";
import { ForceDiagrams, diagramValues } from "./force-diagrams.js";
import { ForceColours } from "./force-colours.js";
import { places, projection, vector } from "./geometry.js";
import { ContactDrawing } from "./structure-contacts.js";
import { Detail } from "./structure-detail.js";
import { ElementDrawing } from "./structure-elements.js";
import { StressColours } from "./structure-solids.js";
import { drawLoads, largestOf, loadsOf } from "./structure-loads.js";
import { NodeDrawing } from "./structure-nodes.js";
import { ObstacleDrawing } from "./structure-obstacles.js";
import { withTurned } from "./turning-obstacles.js";
import { StructureTraces } from "./structure-traces.js";
import { unitsOf } from "./units.js";

const { times } = vector;
/** Against division by zero. */
const LEAST = 1e-300;

/** The largest reaction, load, axial force and value of each diagram that have been drawn so far, for lengths and colours that can be compared. */
export const nothingDrawn = () => ({ reaction: LEAST, load: LEAST, axial: 0, diagram: {} });

/**
 * Traces of `increment` of a model. `turn`: from where it is seen; `exaggeration`: of displacements; `hasNames`: of nodes, null
 * for the usual; `hides`: a set of `loads`, `reactions`, `obstacles`; `hasOwnScale`: colours span the forces of this increment; `diagram`: of the forces in members, null for none; `extent` and `largest`: of what has been drawn so far, widened by this; `reached`: load factor that each stage
 * came to. Answers `{traces, leftOut, heights}`: sentences on what is not in the picture, and what the height of a diagram means.
 */
export function structureDrawing(posted, increment, view) {
  const { extent, largest, exaggeration } = view;
  const now = places(posted, increment, exaggeration);
  extent.widen(now.values());
  const loads = loadsOf(posted, increment, view.reached);
  // Where nodes are drawn further on, so are the obstacles that push them.
  const isAtRest = increment.index === null;
  const moved = new Map(isAtRest ? [] : [...loads.motions].map(([name, motion]) => [name, times(motion, exaggeration)]));
  const turns = new Map(isAtRest ? [] : [...loads.turns].map(([name, angle]) => [name, angle * exaggeration]));
  const model = withTurned(posted, turns);
  const detail = new Detail(model);
  const traces = new StructureTraces(projection(model.dimension, view.turn), detail.isLarge);
  const units = unitsOf(model);
  const forces = elementForces(model, increment);
  keepLargest(largest, increment, loads, forces, model);
  const kind = model.dimension === 2 ? view.diagram : null;
  const diagrams = kind ? new ForceDiagrams(kind, traces, {
    most: largestValue(largest, kind, forces), size: extent.size, units,
  }) : null;
  const rotation = (name) => {
    const turns = increment.displacements[name] ?? [];
    if (model.dimension === 2) return exaggeration * (turns[2] ?? 0);
    return [3, 4, 5].map((place) => exaggeration * (turns[place] ?? 0));
  };
  const hides = view.hides ?? new Set();
  const here = () => forces.of.reduce((most, { axial }) => Math.max(most, Math.abs(axial ?? 0)), 0);
  const colours = new ForceColours(model, view.hasOwnScale ? here() : largest.axial);
  const stressColours = new StressColours(largest.stress ?? 0);
  const common = { now, moved, units, detail };
  if (!hides.has("obstacles")) new ObstacleDrawing(model, extent, traces, { ...common, moves: loads.motions, turns: loads.turns });
  new ElementDrawing(model, traces, { ...common, forces, colours, stressColours, rotation, diagrams, size: extent.size });
  diagrams?.label();
  if (!hides.has("loads")) drawLoads(loads, extent, traces, { ...common, most: largest.load });
  new ContactDrawing(model, increment, extent, traces, { ...common, most: largest.reaction, hasReactions: !hides.has("reactions") });
  const hasNames = detail.canHaveNames && (view.hasNames ?? detail.hasNames);
  new NodeDrawing(model, increment, extent, traces, {
    ...common, loads: loads.forces, hasNames, most: largest.reaction, hasReactions: !hides.has("reactions"),
  });
  extent.show(traces.reach);
  if (forces.isComputed && largest.axial > 0 && !isAtRest) {
    detail.leave("Forces of elements are not all recorded; those that are not are computed from the displacements");
  }
  const scale = stressColours.scale(units) ?? colours.scale(units.force);
  return { traces: scale ? [...traces.all, scale] : traces.all, leftOut: detail.leftOut, heights: diagrams?.scale ?? null };
}

/** The largest value of a diagram so far. */
function largestValue(largest, kind, forces) {
  for (const found of forces.of) {
    const values = diagramValues(kind, found) ?? [];
    largest.diagram[kind] = Math.max(largest.diagram[kind] ?? 0, ...values.map(Math.abs));
  }
  return largest.diagram[kind] ?? 0;
}

function keepLargest(largest, increment, loads, forces, { dimension }) {
  for (const { normal_reaction: normal, tangential_reaction: tangential } of increment.contacts) {
    largest.reaction = Math.max(largest.reaction, Math.hypot(normal, ...tangential));
  }
  for (const force of Object.values(increment.supports ?? {})) largest.reaction = Math.max(largest.reaction, Math.hypot(...force.slice(0, dimension)));
  largest.load = Math.max(largest.load, largestOf(loads.forces));
  for (const { axial, equivalent } of forces.of) {
    largest.axial = Math.max(largest.axial, Math.abs(axial ?? 0));
    largest.stress = Math.max(largest.stress ?? 0, equivalent ?? 0);
  }
}
