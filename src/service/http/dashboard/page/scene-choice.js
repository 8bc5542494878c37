// The choice of a scene for a new run: from which scene the text is, whether it has been changed, and how to restore a replaced
// text.

import { button, choice, element, fill } from "./dom.js";
import { jobOf } from "./state.js";

/** The choice that keeps the current text. */
const AS_IT_IS = "";

const wordsOf = (scene) => (jobOf(scene) ? "the model of a job" : scene);

export class SceneChoice {
  /** `text`: with a `value`. Tells `chosen(scene)`, and `edited()` where the reader's own text has been brought back. */
  constructor(text, told) {
    this.text = text;
    this.told = told;
    this.place = element("label", {});
    this.note = element("p", { class: "quiet", "aria-live": "polite" });
    /** What the text is from, null for a reader's own, and as it was then. */
    this.from = null;
    this.given = null;
    this.former = null;
  }

  get isChanged() {
    return this.given !== null && this.text.value !== this.given;
  }

  /** Puts a text in the place of the one there is, which can be brought back where it is the reader's; `from`: its scene, null
   *  where it is the reader's, too. */
  put(text, from) {
    if (this.isChanged && this.text.value !== text) this.former = { text: this.text.value, from: this.from };
    this.text.value = text;
    this.from = from;
    // As the field has it: it writes line ends its own way.
    if (from !== null) this.given = this.text.value;
    this.say();
  }

  /** Changes the text by what is no edit of the reader's. */
  adapt(text) {
    const isOwn = this.isChanged;
    this.text.value = text;
    if (!isOwn) this.given = this.text.value;
  }

  /** All of it is what the reader has pasted. */
  isOwn() {
    this.from = null;
  }

  say() {
    fill(this.note, this.former ? ["What you had written has been replaced. ", button("Bring it back", () => {
      const { text, from } = this.former;
      this.former = null;
      this.text.value = text;
      this.from = from;
      this.say();
      this.told.edited();
    }, { class: "plain", id: "bring-back" })] : []);
  }

  /** `known`: the scenes; `wanted`: the one that is asked for. */
  draw(known, wanted) {
    const own = this.from === null ? "a text of your own" : `${wordsOf(this.from)}, changed`;
    const key = [wanted, this.isChanged ? own : ""].join("\n");
    if (this.place.dataset.of === key) return;
    this.place.dataset.of = key;
    const names = known.map(({ name }) => name);
    fill(this.place, "Scene ", choice({
      id: "scene", "data-key": "scene", onchange: (event) => this.told.chosen(event.target.value),
    }, [
      ...(this.isChanged ? [[AS_IT_IS, own]] : []), ...(names.includes(wanted) ? [] : [[wanted, wordsOf(wanted)]]),
      ...names.map((name) => [name, name]),
    ], this.isChanged ? AS_IT_IS : wanted));
  }
}
