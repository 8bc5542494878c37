// The extent of the picture of a structure: the undeformed structure, obstacles that are not much larger, and all positions shown
// so far, so that the picture does not jump from increment to increment.

import { vector } from "./geometry.js";

const { plus, length } = vector;
/** Times the structure's size up to which a ball is in the picture whole. */
const NOT_MUCH = 3;

export class StructureExtent {
  constructor(model) {
    const nodes = Object.values(model.nodes);
    this.low = [...nodes[0]];
    this.high = [...nodes[0]];
    this.widen(nodes);
    const ofNodes = this.diagonal();
    for (const obstacle of Object.values(model.obstacles ?? {})) {
      if (obstacle.kind === "ball" && (ofNodes === 0 || obstacle.radius < NOT_MUCH * ofNodes)) {
        this.widen([-1, 1].map((side) => obstacle.center.map((value) => value + side * obstacle.radius)));
      }
    }
  }

  widen(places) {
    for (const place of places) {
      place.forEach((value, axis) => {
        this.low[axis] = Math.min(this.low[axis], value);
        this.high[axis] = Math.max(this.high[axis], value);
      });
    }
  }

  /** The size of the bounding box. */
  get corners() {
    const both = (corner, low, axis) => [[...corner, low], [...corner, this.high[axis]]];
    return this.low.reduce((found, low, axis) => found.flatMap((corner) => both(corner, low, axis)), [[]]);
  }

  diagonal() {
    return length(plus(this.high, this.low, -1));
  }

  get size() {
    return this.diagonal() || 2;
  }

  get middle() {
    return this.low.map((value, axis) => (value + this.high[axis]) / 2);
  }
}
