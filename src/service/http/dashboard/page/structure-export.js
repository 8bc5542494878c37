// Takes pictures of the structure out of the page: the shown increment as PNG or SVG, the path as an animation.

import { button, element, fill } from "./dom.js";

/** What makes the files is loaded when one is asked for. */
const making = () => import("./structure-files.js");

export class StructureExport {
  /** Asks for the `scene()`, the `view()` and the `shown()` increment. */
  constructor(asked) {
    this.asked = asked;
    this.given = null;
    this.said = element("span", { class: "quiet", role: "status", id: "export-said" });
    this.buttons = element("span", { class: "asking" });
    this.place = element("div", { class: "actions" }, this.buttons, this.said);
    this.offer();
  }

  offer() {
    fill(this.buttons, ["png", "svg"].map((format) =>
      button(`Picture (${format})`, () => this.make(({ savePicture }) => savePicture(this.picture(), format)), {
        id: `picture-${format}`, "data-key": format,
      })),
    button("Animation (apng)", () => this.animate(), { id: "animation", "data-key": "animation" }));
  }

  picture() {
    return { scene: this.asked.scene(), view: this.asked.view(), shown: this.asked.shown() };
  }

  async animate() {
    this.given = new AbortController();
    const { signal } = this.given;
    fill(this.buttons, button("Cancel the animation", () => this.given.abort(), { "data-key": "animation" }));
    await this.make(({ saveAnimation }) => saveAnimation(this.picture(), signal, (words) => { this.said.textContent = words; }));
    this.offer();
  }

  async make(work) {
    try {
      if (!this.asked.scene()) throw new Error("there is no picture yet");
      this.said.textContent = await work(await making());
    } catch (problem) {
      this.said.textContent = problem.name === "AbortError" ? "The animation has been given up."
        : `This cannot be made: ${problem.message}.`;
    }
  }
}
