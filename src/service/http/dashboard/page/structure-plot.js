// The structure at the chosen increment, with a slider and a play button that go along the path.

import { element, fill, onceAFrame } from "./dom.js";
import { projection } from "./geometry.js";
import { axis, CONFIGURATION, fromSheet, layout } from "./plot-style.js";
import { COMPRESSION, STATES, structureDrawing, TENSION } from "./structure-drawing.js";
import { StructureExtent } from "./structure-extent.js";
import { StructureTurn } from "./structure-turn.js";
import { isGivenUp } from "./api.js";
import { kindWords, short } from "./words.js";

/** Milliseconds between increments that are played. */
const PACE = 60;
/** The most increments of a path that are played. */
const PLAYED = 300;
/** The half of the picture's side in a plane, as a part of the structure's extent. */
const HALF = 0.62;
/** Margins around a structure in space, for arrows and cones, and around pieces of planes. */
const AROUND = 0.12;
const EDGE = 0.02;

export class StructurePlot {
  /** Tells `chosen(index)`, `pointedAt(yes)` and `turned([azimuth, elevation])`; `turn`: from where it is seen, or null. */
  constructor(panel, told, turn) {
    this.told = told;
    this.path = null;
    this.largest = 0;
    this.slider = element("input", {
      type: "range", min: 0, max: 0, value: 0, id: "increment", "aria-label": "increment", oninput: () => this.slid(),
    });
    this.button = element("button", { type: "button", onclick: () => this.play(), "aria-label": "play" }, "▶");
    this.words = element("p", { class: "quiet" });
    this.place = element("div", { class: "plot", id: "structure-plot" });
    this.key = element("ul", { class: "legend", "aria-label": "key" });
    this.again = onceAFrame(() => this.redraw());
    this.seen = new StructureTurn(this.place, turn, { turned: told.turned, again: () => this.again() });
    fill(panel, element("h2", {}, "Structure"), element("div", { class: "slider" }, this.button, this.slider), this.words,
      this.seen.sliders, this.place, this.key);
    this.place.addEventListener("pointerenter", () => told.pointedAt(true));
    this.place.addEventListener("pointerleave", () => told.pointedAt(false));
  }

  show(path, at) {
    if (this.path !== path) {
      this.path = path;
      this.largest = 0;
      this.shown = null;
      this.extent = new StructureExtent(path.request.model);
      if (this.playing) this.play();
      this.controls();
    }
    return this.choose(at);
  }

  get isInSpace() {
    return this.path?.request.model.dimension === 3;
  }

  controls() {
    this.seen.allow(this.isInSpace);
    const { model } = this.path.request;
    const swatch = (style, words, kind = "") =>
      element("li", {}, element("span", { class: `swatch ${kind}`, style }), words);
    const sign = (colour, shape, words) =>
      element("li", {}, element("span", { class: "sign", style: `color:var(${colour})` }, shape), words);
    const hasFriction = (model.contacts ?? []).some(({ friction }) => friction > 0);
    const bars = (model.elements ?? []).some(({ kind }) => kind === "bar");
    fill(this.key,
      bars ? [swatch(classes(TENSION), "tension", "long"), swatch(classes(COMPRESSION), "compression", "long"),
        swatch("border-color:var(--faint)", "undeformed", "dotted")] : [],
      (model.elements ?? []).some(({ kind }) => kind === "spring") ? swatch("", "spring", "dashed") : null,
      model.contacts?.length ? [
        STATES.map(([state, , colour]) => swatch(`--colour:var(${colour})`, state, `state ${state}`)),
        sign("--text", "→", "reaction"),
        hasFriction ? [sign("--slip", "→", "slip direction"), sign("--cone", "∨", "friction cone")] : [],
      ].flat(2) : []);
  }

  /** Another increment, or a path that has grown. */
  async choose(at) {
    const { path } = this;
    this.at = at;
    if (!path) return;
    if (path.index.length === 0) {
      this.shown = atRest(path.request.model);
      await this.redraw();
      return;
    }
    const place = at === null ? path.index.length - 1 : path.placeOf(at);
    if (place < 0) {
      this.words.textContent = `There is no increment ${at} among those that are kept.`;
      return;
    }
    this.slider.max = path.index.length - 1;
    this.slider.value = place;
    this.wanted = path.index[place];
    this.slider.setAttribute("aria-valuetext", `increment ${this.wanted}`);
    if (this.asked) return;
    this.asked = true;
    try {
      // While an increment is fetched others may be chosen: the last of them is drawn.
      while (this.shown?.index !== this.wanted || this.isStale) {
        const found = await path.increment(this.wanted);
        if (path !== this.path) break;
        if (!found) {
          this.words.textContent = `Increment ${this.wanted} cannot be shown: the service does not give it.`;
          break;
        }
        this.shown = found;
        this.isStale = false;
        await this.redraw();
      }
    } catch (problem) {
      if (!isGivenUp(problem)) {
        this.isStale = true;
        this.words.textContent = problem.message;
      }
    } finally {
      this.asked = false;
    }
    // Another path has been chosen meanwhile.
    if (path !== this.path && this.path) await this.choose(this.at);
  }

  /** Draws again with the current colours of the page. */
  repaint() {
    if (this.path) this.controls();
    this.again();
  }

  /** Another view than the one that is played. */
  rest() {
    if (this.playing) this.play();
  }

  slid() {
    const index = this.path.index[Number(this.slider.value)];
    if (index !== undefined) this.told.chosen(index);
  }

  play() {
    if (!this.playing && this.path.index.length < 2) return;
    if (this.playing) {
      clearInterval(this.playing);
      this.playing = null;
    } else {
      if (Number(this.slider.value) >= Number(this.slider.max)) this.slider.value = 0;
      const stride = Math.max(1, Math.round(this.path.index.length / PLAYED));
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
    const flat = projection(model.dimension, this.seen.view);
    const { traces, largest, sheets } = structureDrawing(model, shown, {
      flat, extent: this.extent, reached: reached(path), largest: this.largest,
    });
    this.largest = largest;
    const { point } = shown;
    this.words.textContent = shown.index === null ? "No increment yet: the structure as the model has it."
      : `Increment ${shown.index}, ${kindWords(point.kind)}, stage “${shown.stage}”, load factor `
      + `${short(shown.load_factor)}${point.event ? `: ${point.event}` : ""}${leftOut(model, shown)}`;
    const plain = { ...axis(""), zeroline: false, visible: !this.isInSpace };
    const [x, y] = this.isInSpace ? this.rangeInSpace(flat, sheets) : this.range();
    await Plotly.react(this.place, traces, layout({
      margin: { l: 40, r: 8, t: 30, b: 30 }, dragmode: this.isInSpace ? false : "pan",
      xaxis: { ...plain, range: x }, yaxis: { ...plain, range: y, scaleanchor: "x" }, uirevision: path.id,
    }), CONFIGURATION);
  }

  range() {
    const half = HALF * this.extent.size;
    return this.extent.middle.map((middle) => [middle - half, middle + half]);
  }

  /** All of the structure and of the planes, as they are seen from where they are looked at. */
  rangeInSpace(flat, sheets) {
    const { corners, size } = this.extent;
    const places = [[corners, AROUND], [sheets, EDGE]].flatMap(([of, around]) => of.map(flat).flatMap(([x, y]) =>
      [[x - around * size, y - around * size], [x + around * size, y + around * size]]));
    return [0, 1].map((axis) => [Math.min, Math.max].map((end) => end(...places.map((place) => place[axis]))));
  }
}

/** The structure before the first increment. */
function atRest(model) {
  const still = Object.keys(model.nodes).map((name) => [name, Array(model.dimension).fill(0)]);
  return {
    index: null, stage: model.stages[0]?.name, load_factor: 0, displacements: Object.fromEntries(still), contacts: [],
    point: { kind: "start", bifurcation: false, event: null },
  };
}

/** A notice about the parts of the structure that are not recorded, and so not drawn. */
function leftOut(model, shown) {
  const all = Object.keys(model.nodes).length;
  const nodes = Object.keys(shown.displacements).length;
  return nodes < all ? `. Of ${all} nodes ${nodes} are recorded; bars at the others are not drawn` : "";
}

const classes = (colours) => `background:linear-gradient(to right, ${colours.join(", ")})`;

/** The load factor that each stage has reached so far. */
function reached(path) {
  const stages = path.columns.get("stage");
  const loads = path.columns.get("load_factor");
  return new Map(stages.map((stage, place) => [stage, loads[place]]));
}
