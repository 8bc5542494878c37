// Elements in the picture of a structure: bars and beams coloured by their axial force, springs, and where they were undeformed.

import { fromSheet } from "./plot-style.js";
import { components, measured } from "./units.js";

const title = (item, number) => `${item.kind} ${item.name ?? number}`;

export class ElementDrawing {
  /** `forces`: of `elementForces`; `colours`: of bars. */
  constructor(model, traces, { now, forces, colours, units, detail }) {
    Object.assign(this, { model, traces, now, forces, colours, units, detail });
    this.faint = { color: fromSheet("--faint"), width: 1.5, dash: "dot" };
    this.spring = { color: fromSheet("--text"), width: detail.isLarge ? 1 : 2, dash: "dash" };
    (model.elements ?? []).forEach((item, number) => this.draw(item, number));
  }

  draw(item, number) {
    const { model, traces, now, forces, units, detail } = this;
    // It joins two nodes at one place, or a node to the ground.
    if (item.kind === "rotational_spring") return;
    const ends = item.nodes.map((name) => now.get(name));
    const before = item.nodes.map((name) => model.nodes[name]);
    const { axial, force, ends: atEnds } = forces.of[number];
    const named = [title(item, number), item.nodes.join(" – ")];
    if (ends.includes(undefined)) {
      // Its current position is not recorded.
      traces.lines("undeformed", before.length > 1 ? [before] : [], this.faint);
    } else if (ends.length === 1) {
      // To the ground, where its node was.
      const words = [
        ...named, `fixed at ${components(before[0], units.length)}`, `force ${components(force ?? [], units.force)}`,
      ];
      const mark = { symbol: "x-thin", color: this.faint.color, size: 9 };
      if (!detail.isLarge) traces.marker("ground", before[0], mark, words);
      traces.element("spring", [before[0], ends[0]], this.spring, words);
    } else {
      if (!detail.isLarge) traces.lines("undeformed", [before], this.faint);
      if (item.kind === "bar") this.bar(ends, axial, named);
      else if (item.kind === "beam") this.beam(ends, axial, named, atEnds);
      else traces.element("spring", ends, this.spring, [...named, `force ${components(force ?? [], units.force)}`]);
    }
  }

  bar(ends, axial, named) {
    const color = axial === null ? this.faint.color : this.colours.of(axial);
    const force = axial === null ? "force not recorded" : `axial force ${measured(axial, this.units.force)}`;
    this.traces.element(`bar ${color}`, ends, { color, width: this.detail.lineWidth }, [...named, force]);
  }

  /** Straight from node to node: the shape between them is not recorded. */
  beam(places, axial, named, ends) {
    const of = (end) => (end.bending_moments ? [end.torsional_moment, ...end.bending_moments] : [end.bending_moment]);
    const what = ends?.[0].bending_moments ? "torsional and bending moments" : "bending moments";
    const moments = ends ? [`${what} ${components(ends.flatMap(of), "")} at its ends`] : [];
    for (let place = 1; place < places.length; place += 1) {
      this.bar(places.slice(place - 1, place + 1), axial, [...named, ...moments]);
    }
  }
}
