// The viewing angles of a structure in space, changed by dragging or by two sliders.

import { element, fill } from "./dom.js";

const ANGLES = { azimuth: 180, elevation: 90 };
/** The default azimuth and elevation. */
const USUAL = [-60, 25];
/** Degrees per pixel of dragging. */
const TURN = 0.5;

const seenFrom = (turn) => {
  const [azimuth, elevation] = turn ?? USUAL;
  return { azimuth, elevation };
};

export class StructureTurn {
  /** `place`: of the picture; `turn`: as the address has it; `before`: what the ids of the sliders begin with. Tells
   *  `turned([azimuth, elevation])` of what the reader does, and `again()` where the picture is another. */
  constructor(place, turn, { turned, again }, before = "") {
    this.place = place;
    this.before = before;
    this.told = { turned, again };
    this.view = seenFrom(turn);
    this.isInSpace = false;
    this.sliders = element("div", { class: "choices" });
    this.byDragging();
  }

  /** Whether the structure can be turned. */
  allow(isInSpace) {
    this.isInSpace = isInSpace;
    this.place.classList.toggle("turns", isInSpace);
    fill(this.sliders, isInSpace ? Object.keys(ANGLES).map((angle) => element("label", {}, `${angle} `, element("input", {
      type: "range", id: `${this.before}${angle}`, "data-key": angle, min: -ANGLES[angle], max: ANGLES[angle], value: this.view[angle],
      oninput: (event) => this.turn({ [angle]: Number(event.target.value) }),
    }))) : []);
  }

  turn(view) {
    this.view = { ...this.view, ...view };
    this.told.turned([this.view.azimuth, this.view.elevation]);
    this.show();
  }

  /** As the address says: azimuth and elevation, null for the usual ones. */
  lookFrom(turn) {
    const view = seenFrom(turn);
    // The address has whole degrees.
    if (Object.keys(ANGLES).every((angle) => Math.abs(view[angle] - this.view[angle]) < 1)) return;
    this.view = view;
    this.show();
  }

  show() {
    for (const angle of Object.keys(ANGLES)) {
      const slider = this.sliders.querySelector(`#${this.before}${angle}`);
      if (slider) slider.value = this.view[angle];
    }
    this.told.again();
  }

  byDragging() {
    let from = null;
    this.place.addEventListener("pointerdown", (event) => {
      if (!this.isInSpace || event.button !== 0 || event.target.closest(".modebar")) return;
      from = { x: event.clientX, y: event.clientY, ...this.view };
      this.place.setPointerCapture(event.pointerId);
    });
    this.place.addEventListener("pointermove", (event) => {
      if (!from) return;
      const azimuth = from.azimuth - TURN * (event.clientX - from.x);
      const elevation = from.elevation + TURN * (event.clientY - from.y);
      this.turn({
        azimuth: ((azimuth + 540) % 360 + 360) % 360 - 180,
        elevation: Math.min(ANGLES.elevation, Math.max(-ANGLES.elevation, elevation)),
      });
    });
    for (const end of ["pointerup", "pointercancel"]) this.place.addEventListener(end, () => { from = null; });
  }
}
