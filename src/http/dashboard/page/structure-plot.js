// The structure at the chosen increment: deformed over undeformed, bars by their force, obstacles, contacts by state,
// reactions with their friction cones. A slider and a play button go along the path.

import { element, fill } from "./dom.js";
import { frame, motions, places, projection, tension, vector } from "./geometry.js";
import { axis, CONFIGURATION, fromSheet, layout } from "./plot-style.js";
import { kindWords, short } from "./words.js";

const { plus, times, length, unit, dot } = vector;
/** Classes of force that bars are coloured by, to each side of zero. */
const CLASSES = 4;
const TENSION = ["#f0b7a8", "#e08770", "#cc5540", "#a62a1d"];
const COMPRESSION = ["#b3cdea", "#7fabdb", "#4a86c8", "#2560a8"];
/** Milliseconds between increments that are played. */
const PACE = 60;
/** Arrows and cones, as a part of the structure's extent. */
const ARROW = 0.22;
const CONE = 0.16;
const ROUND = 48;
const STATES = [["free", "circle-open", "--free"], ["stick", "square", "--stick"], ["slip", "diamond", "--slip"]];

export class StructurePlot {
  /** Tells `chosen(index)`. */
  constructor(panel, told) {
    this.told = told;
    this.path = null;
    this.view = { azimuth: -60, elevation: 25 };
    this.largest = 0;
    this.slider = element("input", {
      type: "range", min: 0, max: 0, value: 0, "aria-label": "increment", oninput: () => this.slid(),
    });
    this.button = element("button", { type: "button", onclick: () => this.play(), "aria-label": "play" }, "▶");
    this.words = element("p", { class: "quiet", "aria-live": "polite" });
    this.turns = element("div", { class: "choices" });
    this.place = element("div", { class: "plot", id: "structure-plot" });
    const key = element("ul", { class: "legend" }, STATES.map(([state, , colour]) =>
      element("li", {}, element("span", { class: "swatch", style: `background:var(${colour})` }), state)),
    element("li", {}, element("span", { class: "swatch", style: `background:${TENSION[3]}` }), "tension"),
    element("li", {}, element("span", { class: "swatch", style: `background:${COMPRESSION[3]}` }), "compression"));
    fill(panel, element("h2", {}, "Structure"), element("div", { class: "slider" }, this.button, this.slider), this.words,
      this.turns, this.place, key);
  }

  show(path, at) {
    if (this.path !== path) {
      this.path = path;
      this.largest = 0;
      this.shown = null;
      this.extent = new Extent(path.request.model);
      fill(this.turns, path.request.model.dimension === 3 ? ["azimuth", "elevation"].map((angle) =>
        element("label", {}, `${angle} `, element("input", {
          type: "range", min: angle === "azimuth" ? -180 : -90, max: angle === "azimuth" ? 180 : 90,
          value: this.view[angle],
          oninput: (event) => { this.view[angle] = Number(event.target.value); this.redraw(); },
        }))) : []);
    }
    return this.choose(at);
  }

  /** Another increment, or a path that has grown. */
  async choose(at) {
    const { path } = this;
    if (!path || path.index.length === 0) return;
    const place = at === null ? path.index.length - 1 : path.placeOf(at);
    if (place < 0) return;
    this.slider.max = path.index.length - 1;
    this.slider.value = place;
    this.wanted = path.index[place];
    if (this.asked) return;
    this.asked = true;
    try {
      // While one is fetched others may be wanted: the last of them is drawn.
      while (this.shown?.index !== this.wanted) {
        const found = await path.increment(this.wanted);
        if (path !== this.path || !found) break;
        this.shown = found;
        await this.redraw();
      }
    } catch (problem) {
      if (problem.name !== "AbortError") this.words.textContent = problem.message;
    } finally {
      this.asked = false;
    }
  }

  slid() {
    this.told.chosen(this.path.index[Number(this.slider.value)]);
  }

  play() {
    if (this.playing) {
      clearInterval(this.playing);
      this.playing = null;
    } else {
      if (Number(this.slider.value) >= Number(this.slider.max)) this.slider.value = 0;
      const stride = Math.max(1, Math.round(this.path.index.length / 300));
      this.playing = setInterval(() => {
        if (this.asked) return;
        const next = Math.min(Number(this.slider.value) + stride, Number(this.slider.max));
        this.slider.value = next;
        this.slid();
        if (next >= Number(this.slider.max)) this.play();
      }, PACE);
    }
    this.button.textContent = this.playing ? "⏸" : "▶";
    this.button.setAttribute("aria-label", this.playing ? "pause" : "play");
  }

  async redraw() {
    const { path, shown } = this;
    if (!shown) return;
    const { model } = path.request;
    const flat = projection(model.dimension, this.view);
    const now = places(model, shown);
    this.extent.widen(now.values());
    const scene = new Scene(flat);
    const moved = motions(model, shown, reached(path));
    for (const [name, obstacle] of Object.entries(model.obstacles ?? {})) {
      this.obstacle(scene, name, obstacle, moved.get(name) ?? [], model.dimension);
    }
    this.elements(scene, model, now);
    this.contacts(scene, model, shown, now, moved);
    scene.nodes(now, model.supports ?? {});
    const { point } = shown;
    this.words.textContent = `Increment ${shown.index}, ${kindWords(point.kind)}, stage “${shown.stage}”, load factor `
      + `${short(shown.load_factor)}${point.event ? `: ${point.event}` : ""}`;
    const isPlane = model.dimension === 2;
    const plain = { ...axis(""), zeroline: false };
    const [x, y] = this.range(flat);
    await Plotly.react(this.place, scene.traces, layout({
      margin: { l: 40, r: 8, t: 30, b: 30 },
      xaxis: { ...plain, range: x, visible: isPlane }, yaxis: { ...plain, range: y, visible: isPlane, scaleanchor: "x" },
      uirevision: path.id,
    }), CONFIGURATION);
  }

  range(flat) {
    const half = 0.62 * this.extent.size;
    return flat(this.extent.middle).map((middle) => [middle - half, middle + half]);
  }

  elements(scene, model, now) {
    const drawn = [];
    for (const item of model.elements ?? []) {
      const ends = item.nodes.map((name) => now.get(name));
      const before = item.nodes.map((name) => model.nodes[name]);
      if (ends.length < 2) continue;
      scene.lines("undeformed", [before], { color: fromSheet("--faint"), width: 1.5, dash: "dot" });
      if (item.kind !== "bar") scene.lines("spring", [ends], { color: fromSheet("--text"), width: 2, dash: "dash" });
      else drawn.push([ends, tension(item, ends[0], ends[1], before[0], before[1])]);
    }
    const most = Math.max(...drawn.map(([, force]) => Math.abs(force)), 1e-300);
    for (const [ends, force] of drawn) {
      const place = Math.min(CLASSES - 1, Math.floor((Math.abs(force) / most) * CLASSES));
      const color = force === 0 ? fromSheet("--zero") : (force > 0 ? TENSION : COMPRESSION)[place];
      scene.lines(`bar ${color}`, [ends], { color, width: 4 }, `force ${short(force)}`);
    }
  }

  contacts(scene, model, shown, now, moved) {
    const { size } = this.extent;
    const friction = new Map((model.contacts ?? []).map((item) => [`${item.node}\n${item.obstacle}`, item.friction]));
    const pushing = shown.contacts.map((contact) => Math.hypot(contact.normal_reaction, ...contact.tangential_reaction));
    this.largest = Math.max(this.largest, ...pushing, 1e-300);
    shown.contacts.forEach((contact, number) => {
      const place = now.get(contact.node);
      const obstacle = model.obstacles[contact.obstacle];
      const { normal, tangents } = frame(obstacle, place, moved.get(contact.obstacle));
      const [, symbol, colour] = STATES.find(([state]) => state === contact.status) ?? STATES[0];
      const words = `${contact.node} on ${contact.obstacle}: ${contact.status}, gap ${short(contact.gap)}, normal `
        + `${short(contact.normal_reaction)}, tangential ${contact.tangential_reaction.map(short).join(", ")}`;
      scene.marker(contact.status, place, symbol, fromSheet(colour), words);
      if (contact.status === "free") return;
      const along = (parts) => tangents.reduce((sum, tangent, which) => plus(sum, tangent, parts[which]), times(normal, 0));
      const coefficient = friction.get(`${contact.node}\n${contact.obstacle}`) ?? 0;
      if (coefficient > 0 && shown.contacts.length <= 60) {
        scene.lines("cone", cone(place, normal, tangents, coefficient, CONE * size),
          { color: fromSheet("--faint"), width: 1 }, "friction cone");
      }
      if (pushing[number] > 0) {
        const force = plus(times(normal, contact.normal_reaction), along(contact.tangential_reaction));
        scene.arrow("reaction", place, plus(place, force, (ARROW * size) / this.largest), fromSheet("--text"));
      }
      const slip = along(contact.slip);
      if (contact.status === "slip" && length(slip) > 0) {
        scene.arrow("slip direction", place, plus(place, unit(slip), 0.12 * size), fromSheet("--slip"));
      }
    });
  }

  obstacle(scene, name, obstacle, moved, dimension) {
    const { middle, size } = this.extent;
    const line = { color: fromSheet("--obstacle"), width: 2 };
    if (obstacle.kind === "plane") {
      const through = plus(obstacle.point, moved);
      const { normal, tangents } = frame(obstacle, through);
      const foot = plus(middle, normal, -dot(plus(middle, through, -1), normal));
      const corner = (a, b) => plus(plus(foot, tangents[0], a * size), tangents[1] ?? [], b * size);
      if (dimension === 2) {
        scene.lines("obstacle", [[corner(-2, 0), corner(2, 0)]], line, name);
        const below = (end) => plus(corner(end, 0), normal, -3 * size);
        scene.area([corner(-2, 0), corner(2, 0), below(2), below(-2)]);
      } else {
        scene.lines("obstacle", [[corner(-0.8, -0.8), corner(0.8, -0.8), corner(0.8, 0.8), corner(-0.8, 0.8), corner(-0.8, -0.8)]], line, name);
        scene.area([corner(-0.8, -0.8), corner(0.8, -0.8), corner(0.8, 0.8), corner(-0.8, 0.8)]);
      }
      return;
    }
    if (obstacle.kind !== "ball") return;
    const center = plus(obstacle.center, moved);
    const axes = dimension === 2 ? [[0, 1]] : [[0, 1], [1, 2], [0, 2]];
    for (const [first, second] of axes) {
      const round = [...Array(ROUND + 1).keys()].map((step) => {
        const angle = (2 * Math.PI * step) / ROUND;
        const place = [...center];
        place[first] += obstacle.radius * Math.cos(angle);
        place[second] += obstacle.radius * Math.sin(angle);
        return place;
      });
      scene.lines("obstacle", [round], line, name);
      if (dimension === 2 && obstacle.side !== "inside") scene.area(round);
    }
  }
}

/** Traces of a picture: what is drawn alike is one of them. */
class Scene {
  constructor(flat) {
    this.flat = flat;
    this.traces = [];
    this.byName = new Map();
  }

  trace(name, make) {
    if (!this.byName.has(name)) {
      const made = { x: [], y: [], text: [], name, type: "scatter", hoverinfo: "text", ...make() };
      this.byName.set(name, made);
      this.traces.push(made);
    }
    return this.byName.get(name);
  }

  add(trace, places, words = "") {
    for (const place of places) {
      const [x, y] = this.flat(place);
      trace.x.push(x);
      trace.y.push(y);
      trace.text.push(words);
    }
  }

  lines(name, pieces, line, words) {
    const trace = this.trace(name, () => ({ mode: "lines", line, ...(words ? {} : { hoverinfo: "skip" }) }));
    for (const piece of pieces) {
      this.add(trace, piece, words);
      trace.x.push(null);
      trace.y.push(null);
      trace.text.push("");
    }
  }

  area(outline) {
    const trace = this.trace(`area ${this.traces.length}`, () => ({
      mode: "lines", line: { width: 0 }, fill: "toself", fillcolor: fromSheet("--ground"), hoverinfo: "skip",
    }));
    this.add(trace, outline);
  }

  arrow(name, from, to, color) {
    const trace = this.trace(name, () => ({
      mode: "lines+markers", line: { color, width: 2 }, hoverinfo: "skip",
      marker: { symbol: "arrow", angleref: "previous", size: [], color },
    }));
    this.add(trace, [from, to]);
    trace.x.push(null);
    trace.y.push(null);
    trace.text.push("");
    trace.marker.size.push(0, 12, 0);
  }

  marker(name, place, symbol, color, words) {
    const trace = this.trace(name, () => ({ mode: "markers", marker: { symbol, color, size: 11, line: { width: 2, color } } }));
    this.add(trace, [place], words);
  }

  nodes(now, supports) {
    const held = Object.keys(supports);
    const plain = { mode: "markers", marker: { color: fromSheet("--text"), size: now.size > 200 ? 3 : 5 } };
    const node = this.trace("node", () => plain);
    for (const [name, place] of now) this.add(node, [place], `${name} (${place.map(short).join(", ")})`);
    const support = this.trace("support", () => ({
      mode: "markers", hoverinfo: "skip",
      marker: { symbol: "triangle-up-open", size: 13, color: fromSheet("--text"), line: { width: 1.5 } },
    }));
    for (const name of held) if (now.has(name)) this.add(support, [now.get(name)]);
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

/** What load factor each stage came to so far. */
function reached(path) {
  const stages = path.columns.get("stage");
  const loads = path.columns.get("load_factor");
  return new Map(stages.map((stage, place) => [stage, loads[place]]));
}

/** What the picture holds: the undeformed structure, obstacles that are not much larger, and every place shown so far. */
class Extent {
  constructor(model) {
    const nodes = Object.values(model.nodes);
    this.low = [...nodes[0]];
    this.high = [...nodes[0]];
    this.widen(nodes);
    const ofNodes = this.diagonal();
    for (const obstacle of Object.values(model.obstacles ?? {})) {
      if (obstacle.kind === "ball" && (ofNodes === 0 || obstacle.radius < 3 * ofNodes)) {
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
