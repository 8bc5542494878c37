// A structure at an increment as traces: deformed over undeformed, bars by their force, obstacles, contacts by state,
// reactions with their friction cones.

import { frame, motions, places, tension, vector } from "./geometry.js";
import { fromSheet } from "./plot-style.js";
import { StructureTraces } from "./structure-traces.js";
import { short } from "./words.js";

const { plus, times, length, unit, dot } = vector;
/** Classes of force by which bars are coloured, on each side of zero. */
const CLASSES = 4;
export const TENSION = ["#f0b7a8", "#e08770", "#cc5540", "#a62a1d"];
export const COMPRESSION = ["#b3cdea", "#7fabdb", "#4a86c8", "#2560a8"];
/** Forces below this part of the largest axial stiffness count as zero. */
const ROUNDING = 1e-12;
/** Length of arrows and cones, relative to the extent of the structure. */
const ARROW = 0.22;
const CONE = 0.16;
const SLIP = 0.12;
/** With at most this many contacts each has its cone. */
const CONES = 60;
/** Corners of the polygon that represents a circle. */
const ROUND = 48;
/** Half the side of the piece of a plane that is drawn in space, as a part of the extent. */
const SHEET = 0.62;
export const STATES = [["free", "circle-open", "--free"], ["stick", "square", "--stick"], ["slip", "diamond", "--slip"]];

/**
 * Traces of `increment` of a model. `flat`: the projection; `extent`: of what is in the picture, widened by this; `reached`:
 * load factor that each stage came to; `largest`: reaction that has been drawn so far, for the length of arrows. Answers
 * `{traces, largest, sheets}`, the last being corners of the pieces of planes in space.
 */
export function structureDrawing(model, increment, { flat, extent, reached, largest }) {
  const now = places(model, increment);
  extent.widen(now.values());
  const drawing = new Drawing(model, extent, new StructureTraces(flat));
  const moved = motions(model, increment, reached);
  for (const [name, obstacle] of Object.entries(model.obstacles ?? {})) drawing.obstacle(name, obstacle, moved.get(name) ?? []);
  drawing.elements(now);
  const most = drawing.contacts(increment, now, moved, largest);
  drawing.traces.nodes(now, model.supports ?? {});
  return { traces: drawing.traces.all, largest: most, sheets: drawing.sheets };
}

class Drawing {
  constructor(model, extent, traces) {
    this.model = model;
    this.extent = extent;
    this.traces = traces;
    this.sheets = [];
  }

  elements(now) {
    const { model, traces } = this;
    const spring = { color: fromSheet("--text"), width: 2, dash: "dash" };
    const beam = { color: fromSheet("--text"), width: 3 };
    const bars = [];
    for (const item of model.elements ?? []) {
      if (item.kind === "rotational_spring") continue;
      const ends = item.nodes.map((name) => now.get(name));
      const before = item.nodes.map((name) => model.nodes[name]);
      if (ends.includes(undefined)) {
        // Its current position is not recorded.
        traces.lines("undeformed", before.length > 1 ? [before] : [], { color: fromSheet("--faint"), width: 1.5, dash: "dot" });
        continue;
      }
      if (ends.length === 1) {
        // To the ground, where its node was.
        const words = `spring of ${item.nodes[0]}`;
        traces.marker("ground", before[0], { symbol: "x-thin", color: fromSheet("--faint"), size: 9 }, `${words}, fixed here`);
        traces.lines("spring", [[before[0], ends[0]]], spring, words);
        continue;
      }
      traces.lines("undeformed", [before], { color: fromSheet("--faint"), width: 1.5, dash: "dot" });
      if (item.kind === "beam") traces.lines("beam", [ends], beam, `beam ${item.nodes.join(" – ")}`);
      else if (item.kind !== "bar") traces.lines("spring", [ends], spring, `spring ${item.nodes.join(" – ")}`);
      else bars.push([ends, tension(item, ends[0], ends[1], before[0], before[1]), item.nodes.join(" – ")]);
    }
    const most = bars.reduce((sum, [, force]) => Math.max(sum, Math.abs(force)), 1e-300);
    const stiffest = (model.elements ?? []).reduce((sum, item) => Math.max(sum, item.axial_stiffness ?? 0), 0);
    for (const [ends, force, words] of bars) {
      const place = Math.min(CLASSES - 1, Math.floor((Math.abs(force) / most) * CLASSES));
      const color = Math.abs(force) <= ROUNDING * stiffest ? fromSheet("--zero") : (force > 0 ? TENSION : COMPRESSION)[place];
      traces.lines(`bar ${color}`, [ends], { color, width: 4 }, `${words}: force ${short(force)}`);
    }
  }

  contacts(increment, now, moved, largest) {
    const { model, traces, extent: { size } } = this;
    const friction = new Map((model.contacts ?? []).map((item) => [`${item.node}\n${item.obstacle}`, item.friction]));
    const pushing = increment.contacts.map((contact) => Math.hypot(contact.normal_reaction, ...contact.tangential_reaction));
    const most = pushing.reduce((sum, force) => Math.max(sum, force), Math.max(largest, 1e-300));
    increment.contacts.forEach((contact, number) => {
      const place = now.get(contact.node);
      if (!place) return;
      const { normal, tangents } = frame(model.obstacles[contact.obstacle], place, moved.get(contact.obstacle));
      const [, symbol, colour] = STATES.find(([state]) => state === contact.status) ?? STATES[0];
      const words = `${contact.node} on ${contact.obstacle}: ${contact.status}, gap ${short(contact.gap)}, normal `
        + `${short(contact.normal_reaction)}, tangential ${contact.tangential_reaction.map(short).join(", ")}`;
      traces.marker(contact.status, place, { symbol, color: fromSheet(colour) }, words);
      if (contact.status === "free") return;
      const along = (parts) => tangents.reduce((sum, tangent, which) => plus(sum, tangent, parts[which]), times(normal, 0));
      const coefficient = friction.get(`${contact.node}\n${contact.obstacle}`) ?? 0;
      if (coefficient > 0 && increment.contacts.length <= CONES) {
        traces.lines("cone", cone(place, normal, tangents, coefficient, CONE * size),
          { color: fromSheet("--cone"), width: 1.5 }, "friction cone");
      }
      if (pushing[number] > 0) {
        const force = plus(times(normal, contact.normal_reaction), along(contact.tangential_reaction));
        traces.arrow("reaction", place, plus(place, force, (ARROW * size) / most), fromSheet("--text"));
      }
      const slip = along(contact.slip);
      if (contact.status === "slip" && length(slip) > 0) {
        traces.arrow("slip direction", place, plus(place, unit(slip), SLIP * size), fromSheet("--slip"));
      }
    });
    return most;
  }

  obstacle(name, obstacle, moved) {
    const line = { color: fromSheet("--obstacle"), width: 2 };
    if (obstacle.kind === "plane") this.plane(name, obstacle, plus(obstacle.point, moved), line);
    else if (obstacle.kind === "ball") this.ball(name, obstacle, plus(obstacle.center, moved), line);
  }

  plane(name, obstacle, through, line) {
    const { traces, extent: { middle, size } } = this;
    const { normal, tangents } = frame(obstacle, through);
    const foot = plus(middle, normal, -dot(plus(middle, through, -1), normal));
    const corner = (a, b) => plus(plus(foot, tangents[0], a * size), tangents[1] ?? [], b * size);
    if (this.model.dimension === 2) {
      traces.lines("obstacle", [[corner(-2, 0), corner(2, 0)]], line, name);
      const below = (end) => plus(corner(end, 0), normal, -3 * size);
      traces.area([corner(-2, 0), corner(2, 0), below(2), below(-2)]);
      return;
    }
    const sheet = [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(([a, b]) => corner(SHEET * a, SHEET * b));
    traces.lines("obstacle", [sheet], line, name);
    traces.area(sheet);
    this.sheets.push(...sheet);
  }

  ball(name, obstacle, center, line) {
    const { traces, model: { dimension } } = this;
    const axes = dimension === 2 ? [[0, 1]] : [[0, 1], [1, 2], [0, 2]];
    for (const [first, second] of axes) {
      const round = [...Array(ROUND + 1).keys()].map((step) => {
        const angle = (2 * Math.PI * step) / ROUND;
        const place = [...center];
        place[first] += obstacle.radius * Math.cos(angle);
        place[second] += obstacle.radius * Math.sin(angle);
        return place;
      });
      traces.lines("obstacle", [round], line, name);
      if (dimension === 2 && obstacle.side !== "inside") traces.area(round);
    }
  }
}

function cone(place, normal, tangents, coefficient, size) {
  const edge = (parts) => plus(place, unit(tangents.reduce((sum, tangent, which) =>
    plus(sum, tangent, coefficient * parts[which]), normal)), size);
  if (tangents.length === 1) return [[edge([-1]), place, edge([1])]];
  const round = [...Array(17).keys()].map((step) =>
    edge([Math.cos((Math.PI * step) / 8), Math.sin((Math.PI * step) / 8)]));
  return [round, [round[0], place, round[8]], [round[4], place, round[12]]];
}
