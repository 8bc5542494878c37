// How the structure is drawn, as the reader chooses it: the exaggeration of its displacements, the names of its nodes, what is
// left out, and which forces the colours span.

import { button, element, fill } from "./dom.js";

/** What the largest displacement comes to where the exaggeration is fitted, as a part of the structure's size. */
const SEEN = 0.1;

/** Diagrams of forces in members: the member of a beam's end forces, in words, and on which side positive values are. */
export const DIAGRAMS = {
  bending_moment: { words: "bending moment", side: -1 },
  shear_force: { words: "shear force", side: 1 },
  axial_force: { words: "axial force", side: 1 },
};

export class StructureOptions {
  /** Tells `changed()`; asks `fitted()` for the exaggeration at which displacements are seen; `exaggeration`: the
   *  factor to begin with. */
  constructor({ changed, fitted }, exaggeration) {
    this.exaggeration = exaggeration;
    /** Whether nodes have their names; null for the usual. */
    this.hasNames = null;
    this.told = { changed };
    this.factor = element("input", {
      type: "number", id: "exaggeration", min: 0, step: "any", value: exaggeration,
      oninput: () => this.exaggerate(this.factor.value),
    });
    this.problem = element("span", { class: "bad", role: "alert" });
    this.names = element("input", {
      type: "checkbox", id: "node-names", onchange: () => { this.hasNames = this.names.checked; changed(); },
    });
    const kinds = Object.entries(DIAGRAMS).map(([kind, { words }]) => element("option", { value: kind }, words));
    this.kinds = element("select", { id: "diagram", onchange: () => changed() }, element("option", { value: "" }, "none"), kinds);
    this.diagrams = element("label", { hidden: true }, "diagram ", this.kinds);
    /** What is left out of the picture by the reader's choice. */
    this.hides = new Set();
    const shown = (what) => element("label", {}, element("input", {
      type: "checkbox", id: `show-${what}`, checked: true, onchange: ({ target }) => {
        if (target.checked) this.hides.delete(what);
        else this.hides.add(what);
        changed();
      },
    }), ` ${what}`);
    this.ownScale = element("input", { type: "checkbox", id: "own-scale", onchange: () => changed() });
    this.place = element("div", { class: "choices" });
    fill(this.place, element("label", {}, "displacements × ", this.factor),
      button("Fit", () => this.exaggerate(String(fitted())), {
        id: "fit-exaggeration", title: "Choose a factor at which the displacements are seen",
      }), element("label", {}, this.names, " names of nodes"), ["loads", "reactions", "obstacles"].map(shown),
      element("label", { title: "Colours from the largest force of this increment, in place of the largest of all increments that have been shown" }, this.ownScale, " colours of this increment"),
      this.diagrams, this.larger(), this.problem);
  }

  larger() {
    return button("Larger", ({ target }) => {
      const isLarge = this.place.parentElement.classList.toggle("large");
      target.textContent = isLarge ? "Smaller" : "Larger";
      // The picture follows the size of its place.
      dispatchEvent(new Event("resize"));
    }, { id: "larger" });
  }

  /** The kind of diagram beside the members, null for none. */
  get diagram() {
    return this.kinds.value || null;
  }

  exaggerate(text) {
    const factor = Number(text);
    const isOne = text.trim() !== "" && Number.isFinite(factor) && factor >= 0;
    this.problem.textContent = isOne ? "" : "The factor is a number, 0 or more.";
    if (!isOne || factor === this.exaggeration) return;
    if (Number(this.factor.value) !== factor) this.factor.value = text;
    this.exaggeration = factor;
    this.told.changed();
  }

  /** A model has come whose nodes usually have their names, or may have them. */
  allow({ hasNames, canHaveNames, hasBeams }) {
    this.diagrams.hidden = !hasBeams;
    if (!hasBeams) this.kinds.value = "";
    this.names.checked = canHaveNames && (this.hasNames ?? hasNames);
    this.names.disabled = !canHaveNames;
    this.names.parentElement.title = canHaveNames ? "" : "There are too many nodes for their names";
  }
}

/** The factor, of one digit, at which the displacements of an increment are seen on a structure of that size. */
export function fittedExaggeration(increment, size) {
  const most = Object.values(increment.displacements).reduce((sum, one) => Math.max(sum, Math.hypot(...one)), 0);
  if (most === 0) return 1;
  return Number(((SEEN * size) / most).toPrecision(1));
}
