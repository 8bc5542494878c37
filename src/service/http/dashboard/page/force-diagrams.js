// Diagrams of the forces in members, beside each member: moments on the side that is in tension, shear and axial forces on the
// left of the member where they are positive.

import { vector } from "./geometry.js";
import { fromSheet } from "./plot-style.js";
import { DIAGRAMS } from "./structure-options.js";
import { measured } from "./units.js";

const { plus, unit } = vector;
/** The height of the largest value, as a part of the extent. */
const HEIGHT = 0.12;

/** Values at the first and the last node of an element; null where there are none. */
export function diagramValues(kind, { ends, axial }) {
  if (ends) return ends.map((end) => end[kind]);
  return kind === "axial_force" && axial !== null ? [axial, axial] : null;
}

export class ForceDiagrams {
  /** `most`: the value that has the full height; `size`: of the extent. */
  constructor(kind, traces, { most, size, units }) {
    Object.assign(this, { kind, traces, units, most, ...DIAGRAMS[kind] });
    /** The largest value that is drawn, and the place of it. */
    this.largest = { value: 0, place: null };
    this.factor = most > 0 ? (this.side * HEIGHT * size) / most : 0;
    this.colour = fromSheet("--diagram");
  }

  /** `shape`: points along the member. */
  draw(shape, values, named) {
    const last = shape.length - 1;
    const tops = shape.map((place, which) => {
      const [x, y] = unit(plus(shape[Math.min(which + 1, last)], shape[Math.max(which - 1, 0)], -1));
      const value = values[0] + (which / last) * (values[1] - values[0]);
      return plus(place, [-y, x], this.factor * value);
    });
    this.traces.filled("diagram", [...shape, ...[...tops].reverse(), shape[0]], this.colour);
    [0, last].forEach((place, end) => this.traces.unmarked("diagram values", tops[place], [
      ...named, `${this.words} ${measured(values[end], this.unit)}`,
    ]));
    [0, last].forEach((place, end) => {
      if (Math.abs(values[end]) > Math.abs(this.largest.value)) this.largest = { value: values[end], place: tops[place] };
    });
  }

  /** Writes the largest value beside its place, once all is drawn. */
  label() {
    const { value, place } = this.largest;
    if (place) this.traces.labels("diagram label", [[measured(value, this.unit), place]], this.colour);
  }

  /** What the height means, in words; null where nothing has one. */
  get scale() {
    return this.factor === 0 ? null : `${this.words}: full height ${measured(this.most, this.unit)}`;
  }

  /** Of moments there is no label, as a model has none for them but those of its force and length. */
  get unit() {
    const { length, force } = this.units;
    if (this.kind !== "bending_moment") return force;
    return force && length ? `${force} ${length}` : "";
  }
}
