// A picture of the model in a text, drawn a moment after the text has been changed.

import { element, fill } from "./dom.js";
import { CONFIGURATION } from "./plot-style.js";
import { plotlyLoaded } from "./plotly-loaded.js";
import { StructureTurn } from "./structure-turn.js";

/** Milliseconds without input before the model is drawn. */
const PAUSE = 500;

/** What draws is loaded when something is drawn. */
const drawing = () => Promise.all([import("./drawable-model.js"), import("./structure-scene.js"), plotlyLoaded()]);

export class ModelPreview {
  constructor() {
    this.picture = element("div", { class: "plot", id: "preview-plot" });
    this.said = element("ul", { class: "quiet left-out", id: "preview-said", "aria-live": "polite" });
    this.seen = new StructureTurn(this.picture, null, { turned: () => {}, again: () => this.draw() }, "preview-");
    this.place = element("div", { id: "preview" }, element("h3", {}, "Preview"),
      element("p", { class: "quiet" }, "The model as it stands in the text, with the loads of all its stages at load factor 1."),
      this.seen.sliders, this.picture, this.said);
    this.text = "";
    this.count = 0;
  }

  /** The text is another now. */
  later(text) {
    clearTimeout(this.soon);
    this.soon = setTimeout(() => { this.text = text; this.draw(); }, PAUSE);
  }

  async draw() {
    const asked = ++this.count;
    try {
      const [{ drawableModel }, { StructureScene }] = await drawing();
      if (asked !== this.count) return;
      const { model, problems } = drawableModel(this.text);
      this.picture.hidden = model === null;
      const leftOut = model ? await this.show(new StructureScene({ id: this.text, request: { model } }, 1)) : [];
      this.say([...problems, ...leftOut]);
    } catch (problem) {
      this.say([`The preview cannot be drawn: ${problem.message}`]);
    }
  }

  async show(scene) {
    this.seen.allow(scene.model.dimension === 3);
    const { traces, layout, leftOut } = scene.picture(null, { turn: this.seen.view, exaggeration: 1, hasNames: null });
    await Plotly.react(this.picture, traces, layout, CONFIGURATION);
    return leftOut;
  }

  say(sentences) {
    fill(this.said, sentences.map((words) => element("li", {}, `${words}.`)));
  }
}
