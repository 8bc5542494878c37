// Elements in the picture of a structure: bars and beams coloured by their axial force, springs, and where they were undeformed.

import { beamShape, spaceBeamShape } from "./beam-shape.js";
import { diagramValues } from "./force-diagrams.js";
import { fromSheet } from "./plot-style.js";
import { edgesOf, isSolid } from "./structure-solids.js";
import { components, measured, moment } from "./units.js";

/** Sizes of the signs of hinges and rotational springs, as parts of the extent. */
const HINGE = 0.018;
const SPIRAL = 0.025;

const title = (item, number) => `${item.kind} ${item.name ?? number}`;

export class ElementDrawing {
  /** `forces`: of `elementForces`; `colours`: of bars; `rotation(name)`: of a node, as it is drawn; `diagrams`: null for none. */
  constructor(model, traces, { now, forces, colours, stressColours, units, detail, rotation, diagrams, size }) {
    Object.assign(this, { model, traces, now, forces, colours, stressColours, units, detail, rotation, diagrams, size });
    this.faint = { color: fromSheet("--faint"), width: 1.5, dash: "dot" };
    this.spring = { color: fromSheet("--text"), width: detail.isLarge ? 1 : 2, dash: "dash" };
    (model.elements ?? []).forEach((item, number) => this.draw(item, number));
  }

  draw(item, number) {
    const { model, traces, now, forces, units, detail } = this;
    const ends = item.nodes.map((name) => now.get(name));
    const before = item.nodes.map((name) => model.nodes[name]);
    const { axial, force } = forces.of[number];
    if (isSolid(item)) {
      this.solid(item, ends, before, forces.of[number], number);
      return;
    }
    const named = [title(item, number), item.nodes.join(" – ")];
    if (item.kind === "rotational_spring") {
      // It joins two nodes at one place, or a node to the ground.
      if (ends[0]) this.spiral(ends[0], [...named, `stiffness ${moment(item.stiffness, units)}`,
        `moment ${moment(forces.of[number].moment, units)}`]);
    } else if (ends.includes(undefined)) {
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
      const isBeam = item.kind === "beam" && model.dimension === 2;
      const inSpace = () => spaceBeamShape(model, item, before, before.map(() => [0, 0, 0]));
      const unstressed = isBeam ? beamShape(model, item, before, before.map(() => 0)) : item.kind === "beam" ? inSpace() : before;
      if (!detail.isLarge) traces.lines("undeformed", [unstressed], this.faint);
      if (isBeam) this.beam(item, ends, forces.of[number], named);
      else if (item.kind === "beam") this.spaceBeam(item, ends, forces.of[number], named);
      else if (item.kind !== "spring") this.bar(ends, axial, named, forces.of[number]);
      else traces.element("spring", ends, this.spring, [...named, `force ${components(force ?? [], units.force)}`]);
    }
  }

  /** `shape`: points from its first to its last node. */
  bar(shape, axial, named, found) {
    const color = axial === null ? this.faint.color : this.colours.of(axial);
    const force = axial === null ? "force not recorded" : `axial force ${measured(axial, this.units.force)}`;
    const values = this.diagrams && diagramValues(this.diagrams.kind, found);
    if (values) this.diagrams.draw(shape, values, named);
    this.traces.element(`bar ${color}`, shape, { color, width: this.detail.lineWidth }, [...named, force]);
  }

  /** In the plane filled, in space its edges; coloured by the equivalent stress. */
  solid(item, places, before, found, number) {
    const { model, traces, units } = this;
    if (places.includes(undefined)) {
      traces.lines("undeformed", edgesOf(item, before), this.faint);
      return;
    }
    const color = this.stressColours.of(found.equivalent ?? null);
    if (model.dimension === 2) edgesOf(item, places).forEach((outline) => traces.body(`solid ${color}`, outline, color, fromSheet("--faint")));
    else traces.lines(`solid ${color}`, edgesOf(item, places), { color, width: 1.5 });
    if (this.detail.isLarge) return;
    const middle = places[0].map((_, axis) => places.reduce((sum, place) => sum + place[axis], 0) / places.length);
    const unit = units.force && units.length ? `${units.force}/${units.length}²` : "";
    traces.unmarked("element values", middle, [title(item, number),
      found.equivalent === undefined || found.equivalent === null ? "stress not recorded"
        : `von Mises stress ${measured(found.equivalent, unit)}`]);
  }

  beam(item, places, found, named) {
    const { model, units } = this;
    const shape = beamShape(model, item, places, item.nodes.map(this.rotation));
    const atEnds = found.ends ? [
      `bending moments ${found.ends.map((end) => moment(end.bending_moment, units)).join(", ")} at its ends`,
      `shear forces ${found.ends.map((end) => measured(end.shear_force, units.force)).join(", ")} at its ends`,
    ] : [];
    this.bar(shape, found.axial, [...named, ...atEnds], found);
    if (this.detail.isLarge) return;
    [[0, 1], [-1, -2]].forEach(([end, beside]) => {
      const name = item.nodes.at(end);
      if (item.releases?.[name]?.includes("rz")) this.hinge(shape.at(end), shape.at(beside), [...named, `hinge at ${name}`]);
    });
  }

  spaceBeam(item, places, found, named) {
    const { units } = this;
    const all = (of) => found.ends.flatMap(of).map((value) => moment(value, units)).join(", ");
    const atEnds = found.ends ? [
      `torsional moments ${all((end) => end.torsional_moment)} at its ends`,
      `bending moments ${all((end) => end.bending_moments)} at its ends`,
    ] : [];
    const shape = spaceBeamShape(this.model, item, places, item.nodes.map(this.rotation));
    this.bar(shape, found.axial, [...named, ...atEnds], found);
  }

  /** A circle beside the node, on the beam that is hinged to it. */
  hinge(node, beside, words) {
    const reach = Math.hypot(beside[0] - node[0], beside[1] - node[1]) || 1;
    const part = Math.min(0.5, (HINGE * this.size) / reach);
    const place = node.map((value, axis) => value + part * (beside[axis] - value));
    this.traces.marker("hinge", place, { symbol: "circle-open", color: fromSheet("--text"), size: 8 }, words);
  }

  spiral(place, words) {
    if (!this.detail.isLarge) {
      const points = Array.from({ length: 40 }, (_, step) => {
        const [angle, radius] = [step / 3, (SPIRAL * this.size * step) / 39];
        return [place[0] + radius * Math.cos(angle), place[1] + radius * Math.sin(angle)];
      });
      this.traces.lines("rotational spring", [points], { color: fromSheet("--text"), width: 1.5 });
    }
    this.traces.unmarked("element values", [place[0] + SPIRAL * this.size, place[1]], words);
  }
}
