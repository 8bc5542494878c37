// The pictures of the structure of one path, which have their extent, the lengths of their arrows and their colours in common.

import { withSides } from "./box-sides.js";
import { nothingDrawn } from "./structure-drawing.js";
import { Detail } from "./structure-detail.js";
import { StructureExtent } from "./structure-extent.js";
import { structureKey } from "./structure-key.js";
import { fittedExaggeration } from "./structure-options.js";
import { structurePicture } from "./structure-picture.js";

export class StructureScene {
  /** `path`: with an id and a request, and columns where there are increments; `exaggeration`: of the displacements. */
  constructor(path, exaggeration) {
    this.path = path;
    this.model = withSides(path.request.model);
    this.detail = new Detail(this.model);
    this.largest = nothingDrawn();
    this.renew(exaggeration);
  }

  /** The displacements are exaggerated otherwise, so that earlier pictures say nothing about the extent. */
  renew(exaggeration) {
    this.exaggeration = exaggeration;
    this.extent = new StructureExtent(this.model);
  }

  /** The picture of an increment, null for the structure before the first one. */
  picture(increment, view) {
    const { path, extent } = this;
    // Loads at load factor 1 say nothing about those of the path.
    const largest = increment ? this.largest : nothingDrawn();
    return structurePicture(this.model, increment ?? atRest(this.model), {
      extent, largest, reached: reached(path), revision: `${path.id} ${this.exaggeration}`, ...view,
    });
  }

  /** Says below the picture what is in it. */
  key(place) {
    structureKey(place, this.model);
  }

  fittedExaggeration(increment) {
    return increment ? fittedExaggeration(increment, new StructureExtent(this.model).size) : 1;
  }
}

/** The structure before the first increment. */
export function atRest(model) {
  const still = Object.keys(model.nodes).map((name) => [name, Array(model.dimension).fill(0)]);
  return {
    index: null, stage: model.stages[0]?.name, load_factor: 0, displacements: Object.fromEntries(still), contacts: [],
    point: { kind: "start", bifurcation: false, event: null },
  };
}

/** The load factor that each stage has reached so far. */
function reached(path) {
  if (!path.columns) return new Map();
  const stages = path.columns.get("stage");
  const loads = path.columns.get("load_factor");
  return new Map(stages.map((stage, place) => [stage, loads[place]]));
}
