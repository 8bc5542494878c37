// Contacts in the picture of a structure: their states, their reactions in friction cones, and where they slip.

import { frame, framed, vector } from "./geometry.js";
import { fromSheet } from "./plot-style.js";
import { counterpart } from "./quantities.js";
import { contactWords } from "./structure-nodes.js";
import { normalOfMesh } from "./triangle-mesh.js";

const { plus, times, dot, cross, length, unit } = vector;
/** Lengths of arrows and cones, as parts of the extent. */
const ARROW = 0.22;
const CONE = 0.16;
const SLIP = 0.12;
/** Steps until normal and tangents agree with a reaction. */
const FRAME_STEPS = 30;
/** With more contacts than this those that are free have no mark. */
const MARKED = 100;
export const STATES = [["free", "circle-open", "--free"], ["stick", "square", "--stick"], ["slip", "diamond", "--slip"]];

export class ContactDrawing {
  /** `most`: the reaction whose arrow has its full length. */
  constructor(model, increment, extent, traces, { now, moved, most, units, detail, hasReactions }) {
    Object.assign(this, { model, extent, traces, now, moved, most, units, detail });
    this.friction = new Map((model.contacts ?? []).map((item) => [`${item.node}\n${counterpart(item)}`, item.friction ?? 0]));
    const { contacts } = increment;
    const drawn = contacts.filter(({ node }) => now.has(node));
    const closed = drawn.filter(({ status }) => status !== "free");
    const marked = drawn.length > MARKED ? closed : drawn;
    const lacking = contacts.length - drawn.length;
    if (marked.length < drawn.length) detail.leave(`${drawn.length - marked.length} free contacts have no mark`);
    if (lacking > 0) detail.leave(`${lacking} contacts of nodes that are not recorded are not drawn`);
    for (const contact of marked) this.mark(contact);
    const rough = closed.filter((contact) => this.frictionOf(contact) > 0);
    if (hasReactions && rough.length && detail.hasCones(rough.length)) rough.forEach((contact) => this.cone(contact));
    const pushed = (hasReactions ? closed : []).map((contact) => [contact, this.reaction(contact)]).filter(([, force]) => length(force) > 0);
    for (const [contact, force] of detail.arrows(pushed, "reactions")) this.arrow(contact, force);
    const slipping = closed.map((contact) => [contact, this.along(contact, contact.slip)])
      .filter(([contact, slip]) => contact.status === "slip" && length(slip) > 0);
    for (const [contact, slip] of detail.arrows(slipping, "slips")) this.slip(contact, slip);
  }

  frictionOf({ node, obstacle }) {
    return this.friction.get(`${node}\n${obstacle}`) ?? 0;
  }

  frame(contact) {
    const { node, obstacle } = contact;
    const touched = this.model.obstacles?.[obstacle];
    if (touched?.kind === "triangle_mesh") return this.frameOfMesh(contact, touched);
    if (touched) return frame(touched, this.now.get(node), this.moved.get(obstacle));
    return this.model.dimension === 3 ? this.frameOfFaces(contact) : frameOfReaction(contact);
  }

  /** The frame of a contact with a mesh: near its edges, which are rounded, that of which the reaction has the known parts. */
  frameOfMesh({ node, obstacle, reaction, normal_reaction: across, tangential_reaction: along }, touched) {
    const { original, pivot, into, outOf } = touched.turned ?? { original: touched, pivot: [0, 0, 0], into: (v) => v, outOf: (v) => v };
    const place = plus(plus(this.now.get(node), this.moved.get(obstacle) ?? [], -1), pivot, -1);
    let own = framed(normalOfMesh(original, plus(pivot, into(place))));
    for (let step = 0; across > 0 && step < FRAME_STEPS; step++) {
      const normal = own.tangents.reduce((sum, tangent, which) => plus(sum, tangent, -along[which]), into(reaction));
      own = framed(unit(normal));
    }
    return { normal: outOf(own.normal), tangents: own.tangents.map(outOf) };
  }

  /** The frame of a contact of bodies in space: across the faces at the node, and along the first edge of the first of them. */
  frameOfFaces({ node, obstacle, reaction }) {
    const own = (this.model.contacts ?? []).find((item) => item.against === obstacle && item.surface !== undefined
      && this.facesAt(item.surface, node).length > 0);
    const faces = own ? this.facesAt(own.surface, node) : [];
    const zero = times(reaction, 0);
    if (!faces.length) return { normal: zero, tangents: [zero, zero] };
    const edges = faces.map((face) => face.slice(1).map((to) => plus(this.now.get(to), this.now.get(node), -1)));
    const area = edges.flatMap((from) => from.slice(1).map((to, before) => cross(from[before], to)))
      .reduce((sum, part) => plus(sum, part), zero);
    // Whichever way the faces run, the other body presses the node back into its own.
    const isOutside = dot(area, reaction) < 0;
    const outside = unit(isOutside ? area : times(area, -1));
    const edge = edges[0].at(isOutside ? 0 : -1);
    const along = unit(plus(edge, outside, -dot(edge, outside)));
    return { normal: times(outside, -1), tangents: [along, cross(outside, along)] };
  }

  /** The faces of a surface at a node whose nodes are all drawn, each from this node on. */
  facesAt(surface, node) {
    const faces = this.model.surfaces?.[surface]?.faces ?? [];
    return faces.filter((face) => face.includes(node) && face.every((other) => this.now.has(other)))
      .map((face) => [...face.slice(face.indexOf(node)), ...face.slice(0, face.indexOf(node))]);
  }

  /** A vector of its components along the tangents. */
  along(contact, parts) {
    const { normal, tangents } = this.frame(contact);
    return tangents.reduce((sum, tangent, which) => plus(sum, tangent, parts[which]), times(normal, 0));
  }

  reaction(contact) {
    return contact.reaction
      ?? plus(this.along(contact, contact.tangential_reaction), this.frame(contact).normal, contact.normal_reaction);
  }

  mark(contact) {
    const [, symbol, colour] = STATES.find(([state]) => state === contact.status) ?? STATES[0];
    const size = this.detail.marksNodes ? 11 : 7;
    // The node tells its values.
    this.traces.marker(contact.status, this.now.get(contact.node), { symbol, color: fromSheet(colour), size });
  }

  cone(contact) {
    const { normal, tangents } = this.frame(contact);
    const lines = cone(this.now.get(contact.node), normal, tangents, this.frictionOf(contact), CONE * this.extent.size);
    this.traces.lines("cone", lines, { color: fromSheet("--cone"), width: 1.5 });
  }

  arrow(contact, force) {
    const place = this.now.get(contact.node);
    this.traces.arrow("reaction", place, plus(place, force, (ARROW * this.extent.size) / this.most), fromSheet("--text"),
      { words: contactWords(contact, this.units), isAtHead: true });
  }

  slip(contact, slip) {
    const place = this.now.get(contact.node);
    this.traces.arrow("slip direction", place, plus(place, unit(slip), SLIP * this.extent.size), fromSheet("--slip"));
  }
}

/** The frame of a contact of bodies, whose reaction has known parts along it; the tangent is the normal turned clockwise. */
function frameOfReaction({ reaction: [x, y], normal_reaction: across, tangential_reaction: [along] }) {
  const square = across * across + along * along;
  const normal = square > 0 ? [(x * across - y * along) / square, (x * along + y * across) / square] : [0, 0];
  return { normal, tangents: [[normal[1], -normal[0]]] };
}

function cone(place, normal, tangents, coefficient, size) {
  const edge = (parts) => plus(place, unit(tangents.reduce((sum, tangent, which) =>
    plus(sum, tangent, coefficient * parts[which]), normal)), size);
  if (tangents.length === 1) return [[edge([-1]), place, edge([1])]];
  const round = [...Array(17).keys()].map((step) =>
    edge([Math.cos((Math.PI * step) / 8), Math.sin((Math.PI * step) / 8)]));
  return [round, [round[0], place, round[8]], [round[4], place, round[12]]];
}
