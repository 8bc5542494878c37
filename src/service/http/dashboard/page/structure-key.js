// The key below the picture of a structure: what its lines, marks and arrows mean.

import { element, fill } from "./dom.js";
import { STATES } from "./structure-contacts.js";
import { Detail } from "./structure-detail.js";
import { isSolid } from "./structure-solids.js";

const swatch = (style, words, kind = "") => element("li", {}, element("span", { class: `swatch ${kind}`, style }), words);
const sign = (colour, shape, words) =>
  element("li", {}, element("span", { class: "sign", style: `color:var(${colour})` }, shape), words);

/** Fills the key for what a model has. */
export function structureKey(place, model) {
  const { isLarge } = new Detail(model);
  const elements = model.elements ?? [];
  const contacts = model.contacts ?? [];
  const brings = (member) => model.stages.some((stage) => Object.keys(stage[member] ?? {}).length > 0);
  fill(place,
    elements.some(({ kind }) => kind === "bar" || kind === "beam") && !isLarge ? swatch("border-color:var(--faint)", "undeformed", "dotted") : null,
    elements.some(isSolid) ? swatch("background:#348d8b", "solid") : null,
    elements.some(({ kind }) => kind === "spring") ? swatch("", "spring", "dashed") : null,
    elements.some(({ releases }) => Object.keys(releases ?? {}).length) && !isLarge ? sign("--text", "○", "hinge") : null,
    elements.some(({ kind }) => kind === "rotational_spring") && !isLarge ? sign("--text", "@", "rotational spring") : null,
    Object.keys(model.supports ?? {}).length ? [sign("--text", "△", "support"), sign("--support", "→", "reaction of a support")] : null,
    brings("forces") ? sign("--load", "→", "load") : null,
    brings("moments") ? sign("--load", "↺", "moment") : null,
    brings("displacements") ? sign("--imposed", "→", "imposed displacement") : null,
    contacts.length ? [
      ...STATES.map(([state, , colour]) => swatch(`--colour:var(${colour})`, state, `state ${state}`)),
      sign("--text", "→", "reaction of a contact"),
      ...(contacts.some(({ friction }) => friction > 0)
        ? [sign("--slip", "→", "slip direction"), sign("--cone", "∨", "friction cone")] : []),
    ] : []);
}
