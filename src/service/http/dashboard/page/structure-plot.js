// The structure at the chosen increment, with what goes along the path and what changes the picture.

import { isGivenUp } from "./api.js";
import { element, fill, onceAFrame } from "./dom.js";
import { CONFIGURATION } from "./plot-style.js";
import { StructureExport } from "./structure-export.js";
import { StructureOptions } from "./structure-options.js";
import { Playback } from "./structure-playback.js";
import { StructureTurn } from "./structure-turn.js";
import { kindWords, short } from "./words.js";

/** What draws is loaded when something is drawn, as the path comes first. */
const drawing = () => import("./structure-scene.js");

/** What is not certain of the directions at an increment. */
function doubts(shown) {
  const { unexplored_modes: unexplored, degenerate } = shown?.point ?? {};
  return [
    unexplored ? `${unexplored} combinations of contact modes were not examined here: there may be other directions.` : null,
    degenerate ? "The directions here may not be all (degenerate)." : null,
  ];
}

export class StructurePlot {
  /** Tells `chosen(index)`, `pointedAt(yes)`, `seen({turn} or {exaggeration})` as the reader changes it, and
   *  `shown(path, increment)`; `turn` and `exaggeration` as the address has them. */
  constructor(panel, told, { turn, exaggeration }) {
    this.told = told;
    this.path = null;
    this.playback = new Playback({
      chosen: (place) => { if (this.path.index[place] !== undefined) told.chosen(this.path.index[place]); },
      isBusy: () => this.asked,
    });
    this.words = element("p", { class: "quiet" });
    this.place = element("div", { class: "plot", id: "structure-plot" });
    this.left = element("ul", { class: "quiet left-out", "aria-label": "not in the picture" });
    this.key = element("ul", { class: "legend", "aria-label": "key" });
    this.again = onceAFrame(() => this.redraw());
    const turned = (angles) => told.seen({ turn: angles });
    this.seen = new StructureTurn(this.place, turn, { turned, again: () => this.again() });
    this.options = new StructureOptions({
      changed: () => this.optionsChanged(),
      fitted: () => this.scene?.fittedExaggeration(this.shown) ?? 1,
    }, exaggeration);
    this.exports = new StructureExport({ scene: () => this.scene, view: () => this.view, shown: () => this.shown });
    fill(panel, element("h2", {}, "Structure"), this.playback.place, this.words, this.options.place, this.seen.sliders,
      this.place, this.key, this.left, this.exports.place);
    this.place.addEventListener("pointerenter", () => told.pointedAt(true));
    this.place.addEventListener("pointerleave", () => told.pointedAt(false));
  }

  show(path, at) {
    if (this.path !== path) {
      this.path = path;
      this.shown = null;
      this.scene = null;
      this.rest();
      this.seen.allow(path.request.model.dimension === 3);
    }
    return this.choose(at);
  }

  get view() {
    const { exaggeration, hasNames, diagram, hides, ownScale } = this.options;
    return { turn: this.seen.view, exaggeration, hasNames, diagram, hides, hasOwnScale: ownScale.checked };
  }

  /** Another increment, or a path that has grown. */
  async choose(at) {
    const { path } = this;
    this.at = at;
    if (!path) return;
    if (path.index.length === 0) {
      this.shown = null;
      await this.redraw();
      return;
    }
    const place = at === null ? path.index.length - 1 : path.placeOf(at);
    if (place < 0) {
      this.words.textContent = `There is no increment ${at} among those that are kept.`;
      return;
    }
    this.wanted = path.index[place];
    this.playback.show(path.index.length, place, this.wanted);
    if (this.asked) return;
    this.asked = true;
    try {
      await this.fetchWanted(path);
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

  /** While an increment is fetched others may be chosen: the last of them is drawn. */
  async fetchWanted(path) {
    while (this.shown?.index !== this.wanted || this.isStale) {
      const found = await path.increment(this.wanted);
      if (path !== this.path) return;
      if (!found) {
        this.words.textContent = `Increment ${this.wanted} cannot be shown: the service does not give it.`;
        return;
      }
      this.shown = found;
      this.isStale = false;
      await this.redraw();
    }
  }

  /** Draws again with the current colours of the page. */
  repaint() {
    this.again();
  }

  optionsChanged() {
    const { exaggeration } = this.options;
    if (this.scene && this.scene.exaggeration !== exaggeration) this.scene.renew(exaggeration);
    this.told.seen({ exaggeration });
    this.again();
  }

  /** From where it is seen, and how exaggerated, as the address says: one may have gone back. */
  lookAs({ turn, exaggeration }) {
    this.seen.lookFrom(turn);
    this.options.exaggerate(String(exaggeration));
  }

  /** Plays or pauses for a key, if there is something to be played. */
  play(event) {
    if (!this.path) return;
    event.preventDefault();
    this.playback.toggle();
  }

  /** Another view than the one that is played. */
  rest() {
    if (this.playback.isPlaying) this.playback.stop();
  }

  async redraw() {
    const { path } = this;
    if (!path) return;
    const { StructureScene } = await drawing();
    if (path !== this.path) return;
    if (this.scene?.path !== path) {
      this.scene = new StructureScene(path, this.options.exaggeration);
      this.scene.key(this.key);
      this.options.allow(this.scene.detail);
    }
    const { shown } = this;
    const { traces, layout, leftOut } = this.scene.picture(shown, this.view);
    this.say(shown, leftOut);
    await Plotly.react(this.place, traces, layout, CONFIGURATION);
    this.told.shown(path, shown);
  }

  say(shown, leftOut) {
    const nodes = Object.keys(this.path.request.model.nodes).length;
    const recorded = shown ? Object.keys(shown.displacements).length : nodes;
    const notRecorded = recorded < nodes ? `. Of ${nodes} nodes ${recorded} are recorded; bars at the others are not drawn` : "";
    this.words.textContent = !shown
      ? "No increment yet: the structure as the model has it, with the loads of all its stages at load factor 1."
      : `Increment ${shown.index}, ${kindWords(shown.point.kind)}, stage “${shown.stage}”, load factor `
      + `${short(shown.load_factor)}${shown.point.event ? `: ${shown.point.event}` : ""}${notRecorded}`;
    const sentences = [...leftOut.map((words) => `${words}.`), ...doubts(shown), this.playback.words].filter(Boolean);
    // Not at each increment that is played.
    if (this.left.dataset.of === sentences.join()) return;
    this.left.dataset.of = sentences.join();
    fill(this.left, sentences.map((words) => element("li", {}, words)));
  }
}
