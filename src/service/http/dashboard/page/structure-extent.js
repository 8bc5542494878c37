// The extent of a structure and of its picture: what has been shown so far counts, so that the picture does not jump from
// increment to increment.

import { fromMiddle, vector } from "./geometry.js";

const { plus, dot, length, unit } = vector;
/** Times the structure's size up to which a ball is in the picture whole, and a cylinder all round. */
const NOT_MUCH = 3;

export class StructureExtent {
  constructor(model) {
    const nodes = Object.values(model.nodes);
    this.low = [...nodes[0]];
    this.high = [...nodes[0]];
    this.outermost = ways(model.dimension).map((way) => ({ way, most: -Infinity, place: null }));
    /** Name of an obstacle to the range of its feet in the coordinates along it. */
    this.feet = new Map();
    this.widen(nodes);
    const ofNodes = this.diagonal();
    this.isWhole = ({ radius }) => radius !== undefined && (ofNodes === 0 || radius < NOT_MUCH * ofNodes);
    const { middle } = this;
    for (const obstacle of Object.values(model.obstacles ?? {}).filter(this.isWhole)) {
      const center = plus(middle, fromMiddle(obstacle, middle), -1);
      // A cylinder reaches less far towards its axis.
      const along = obstacle.axis ? unit(obstacle.axis) : [0, 0, 0];
      const reach = (axis) => obstacle.radius * Math.sqrt(Math.max(0, 1 - along[axis] ** 2));
      this.widen([-1, 1].map((side) => center.map((value, axis) => value + side * reach(axis))));
    }
  }

  /** The structure reaches these positions. */
  widen(places) {
    for (const place of places) {
      place.forEach((value, axis) => {
        this.low[axis] = Math.min(this.low[axis], value);
        this.high[axis] = Math.max(this.high[axis], value);
      });
    }
    this.show(places);
  }

  /** The picture has room for these positions. */
  show(places) {
    for (const place of places) {
      for (const one of this.outermost) {
        const reach = dot(place, one.way);
        if (reach > one.most) Object.assign(one, { most: reach, place });
      }
    }
  }

  /** The positions between which the picture lies, from wherever it is looked at. */
  get corners() {
    return this.outermost.map(({ place }) => place);
  }

  /** Widens the range of the feet on an obstacle; answers it as `[low, high]` for each direction along the obstacle. */
  stand(name, along) {
    const known = this.feet.get(name) ?? along[0]?.map((value) => [value, value]) ?? [];
    const range = known.map(([low, high], axis) => {
      const values = along.map((place) => place[axis]);
      return [values.reduce((a, b) => Math.min(a, b), low), values.reduce((a, b) => Math.max(a, b), high)];
    });
    if (range.length) this.feet.set(name, range);
    return range;
  }

  /** Whether a position is within so many times the structure's size of it. */
  isNear(place, times) {
    const around = times * this.size;
    return place.every((value, axis) => value >= this.low[axis] - around && value <= this.high[axis] + around);
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

/** Directions along the axes and between them. */
function ways(dimension) {
  let found = [[]];
  for (let axis = 0; axis < dimension; axis++) found = found.flatMap((way) => [-1, 0, 1].map((part) => [...way, part]));
  return found.filter((way) => way.some((part) => part !== 0));
}
