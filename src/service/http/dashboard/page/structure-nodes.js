// Nodes in the picture of a structure, with all that is known of each by hovering, their supports and their names.

import { vector } from "./geometry.js";
import { fromSheet } from "./plot-style.js";
import { drawTurn } from "./structure-loads.js";
import { components, measured, moment } from "./units.js";

const { plus } = vector;
const AXES = "xyz";
/** The height of the triangle of a support, and of one in a large structure, as parts of the extent. */
const SUPPORT = 0.035;
const SMALL = 0.015;
/** The length of the largest reaction, as a part of the extent, and the part of it below which a reaction has no arrow. */
const [ARROW, SMALLEST] = [0.22, 1e-6];

/** Lines on a contact. */
export function contactWords(contact, units) {
  return [
    `${contact.node} on ${contact.obstacle}: ${contact.status}`, `gap ${measured(contact.gap, units.length)}`,
    `normal reaction ${measured(contact.normal_reaction, units.force)}`,
    `tangential reaction ${components(contact.tangential_reaction, units.force)}`,
  ];
}

export class NodeDrawing {
  /** `loads`: node to force; `most`: the reaction whose arrow has its full length. */
  constructor(model, increment, extent, traces, { now, loads, units, detail, hasNames, most, hasReactions }) {
    Object.assign(this, { model, increment, extent, traces, now, loads, units, detail, most });
    this.contacts = Map.groupBy(increment.contacts, ({ node }) => node);
    this.supports();
    if (hasReactions) this.reactions();
    this.nodes();
    if (hasNames) traces.names(now, fromSheet("--text"));
  }

  /** A triangle for each component that is held, with its tip at the node. */
  supports() {
    const { model, traces, now, extent } = this;
    const height = (this.detail.marksNodes ? SUPPORT : SMALL) * extent.size;
    const line = { color: fromSheet("--text"), width: this.detail.marksNodes ? 1.5 : 1 };
    for (const [name, held] of Object.entries(model.supports ?? {})) {
      const place = now.get(name);
      if (!place) continue;
      for (const component of held) {
        if (component === "rz") {
          // Held against turning: a square about the node.
          const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]];
          traces.lines("support", [corners.map((way) => plus(place, way, height / 3))], line);
          continue;
        }
        const axis = AXES.indexOf(component);
        const beside = axis === 0 ? 1 : 0;
        const corner = (aside) => place.map((value, which) =>
          value - (which === axis ? height : 0) + (which === beside ? aside * height : 0));
        traces.lines("support", [[place, corner(-0.6), corner(0.6), place]], line);
      }
    }
  }

  /** The forces of supports on the structure. */
  reactions() {
    const { increment, model, detail, traces, now, extent, most } = this;
    const forces = Object.entries(increment.supports ?? {}).map(([name, force]) => [name, force.slice(0, model.dimension)])
      .filter(([name, force]) => now.has(name) && Math.hypot(...force) > SMALLEST * most);
    for (const [name, force] of detail.arrows(forces, "reactions of supports")) {
      const place = now.get(name);
      traces.arrow("reaction of a support", place, plus(place, force, (ARROW * extent.size) / most), fromSheet("--support"),
        { words: this.words(name), isAtHead: true });
    }
    if (model.dimension === 2) this.moments();
  }

  /** The moments of supports on the structure, in the plane, that are not small beside the largest. */
  moments() {
    const { increment, detail, traces, now, extent, units } = this;
    const all = Object.entries(increment.supports ?? {}).map(([name, force]) => [name, force[2] ?? 0]);
    const least = SMALLEST * all.reduce((most, [, value]) => Math.max(most, Math.abs(value)), 0);
    const shown = all.filter(([name, value]) => now.has(name) && Math.abs(value) > least).map(([name, value]) => [name, [value]]);
    for (const [name, [value]] of detail.arrows(shown, "moments of supports")) {
      drawTurn(traces, extent, {
        trace: "moment of a support", place: now.get(name), value, color: fromSheet("--support"),
        words: [...this.words(name), `moment ${moment(value, units)}`],
      });
    }
  }

  words(name) {
    const { increment, units, model } = this;
    const reaction = increment.supports?.[name];
    const held = model.supports?.[name];
    const load = this.loads.get(name);
    return [
      name, `at ${components(plus(model.nodes[name], increment.displacements[name]), units.length)}`,
      increment.index === null ? null : `displacement ${components(increment.displacements[name], units.length)}`,
      held?.length ? `held in ${held.join(", ")}${reaction ? `, reaction ${components(reaction, units.force)}` : ""}` : null,
      load ? `load ${components(load, units.force)}` : null,
      ...(this.contacts.get(name) ?? []).flatMap((contact) => contactWords(contact, units)),
    ];
  }

  nodes() {
    const { traces, detail } = this;
    const node = traces.trace("node", () => (!detail.marksNodes ? { mode: "lines", line: { width: 0 } }
      : { mode: "markers", marker: { color: fromSheet("--text"), size: 5 } }));
    for (const [name, place] of this.now) {
      traces.add(node, [place], this.words(name));
      // No lines between nodes.
      if (!detail.marksNodes) traces.interrupt(node);
    }
  }
}
