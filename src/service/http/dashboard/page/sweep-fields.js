// Fields for what a sweep varies: a place and its values for each parameter, how the values are combined, and the refinement.
// They show what the text of the request has, and report changes.

import { button, choice, element, fill } from "./dom.js";
import { valueWords } from "./sweep-values.js";

/** The most places that are proposed. */
const PROPOSED = 60;
const COMBINED = [["grid", "each with each"], ["list", "the first of each, the second of each, and so on"]];

/** Values of a text: JSON, separated by commas; what is not JSON is a text of its own. */
function valuesOf(text) {
  const parts = text.split(",").map((part) => part.trim()).filter(Boolean);
  try {
    return JSON.parse(`[${parts.join(",")}]`);
  } catch {
    return parts.map((part) => {
      try {
        return JSON.parse(part);
      } catch {
        return part;
      }
    });
  }
}

const textOf = (values) => (Array.isArray(values) ? values.map(valueWords).join(", ") : "");

/** Places whose values are numbers, those that stand for every item first. */
function proposals({ model }) {
  const found = new Set();
  for (const list of ["contacts", "elements"]) {
    const items = Array.isArray(model?.[list]) ? model[list] : [];
    items.forEach((item, place) => {
      for (const [name, value] of Object.entries(item ?? {})) {
        if (typeof value !== "number") continue;
        if (items.length > 1 && items.every((one) => typeof one?.[name] === "number")) found.add(`/model/${list}/*/${name}`);
        found.add(`/model/${list}/${place}/${name}`);
      }
    });
  }
  for (const [name, place] of Object.entries(model?.nodes ?? {})) {
    [place].flat().forEach((_, axis) => found.add(`/model/nodes/${name.replaceAll("~", "~0").replaceAll("/", "~1")}/${axis}`));
  }
  ["arc_length/max", "method"].forEach((name) => found.add(`/analysis/${name}`));
  const stars = [...found].filter((place) => place.includes("*"));
  return [...new Set([...stars, ...found])].slice(0, PROPOSED);
}

export class SweepFields {
  /** Tells `changed(value)`. */
  constructor(changed) {
    this.changed = changed;
    this.value = {};
    this.rows = element("div", {});
    this.known = element("datalist", { id: "sweep-places" });
    this.combine = choice({ id: "setting-combine", onchange: () => this.put("combine", this.combine.value, "grid") }, COMBINED, "grid");
    this.refine = element("input", {
      type: "number", id: "setting-refine", min: 0, step: 1, placeholder: "none",
      onchange: () => this.put("refine", this.refine.valueAsNumber || 0, 0),
    });
    const labelled = (words, input, more) => element("div", { class: "setting" }, element("label", { for: input.id }, words), input,
      element("small", {}, more));
    this.place = element("fieldset", { class: "settings", id: "sweep-fields" }, element("legend", {}, "What is varied"), this.known,
      this.rows, button("Another parameter", () => this.add(), { id: "sweep-add" }),
      labelled("combine", this.combine, "How the values of several parameters meet."),
      labelled("refine", this.refine, "Further runs at most, where the first response, or the limit load, changes most between two values "
        + "of the only parameter."));
  }

  /** Shows the member `sweep` of a request; null if it cannot be read. */
  show(value, request) {
    this.place.disabled = value === null;
    this.value = value ?? {};
    const parameters = Object.entries(this.value.replace ?? {});
    // Fields in which somebody writes are left alone.
    if (this.inputs?.length !== parameters.length) this.draw(parameters.length);
    parameters.forEach(([pointer, values], row) => {
      const shown = [pointer, textOf(values)];
      this.inputs[row].forEach((input, place) => { if (input !== document.activeElement) input.value = shown[place]; });
    });
    this.combine.value = this.value.combine ?? "grid";
    if (this.refine !== document.activeElement) this.refine.value = this.value.refine || "";
    if (request) fill(this.known, proposals(request).map((place) => element("option", { value: place })));
  }

  draw(count) {
    this.inputs = Array.from({ length: count }, (_, row) => [
      element("input", {
        type: "text", list: "sweep-places", "aria-label": `parameter ${row + 1}`, "data-key": `parameter ${row}`,
        placeholder: "/model/contacts/0/friction", onchange: () => this.take(),
      }),
      element("input", {
        type: "text", "aria-label": `values of parameter ${row + 1}`, "data-key": `values ${row}`, placeholder: "0.1, 0.2, 0.3",
        onchange: () => this.take(),
      }),
    ]);
    fill(this.rows, this.inputs.map(([pointer, values], row) => element("div", { class: "setting parameter" }, pointer, values,
      button("Remove", () => this.remove(row), { "aria-label": `remove parameter ${row + 1}` }))));
  }

  /** What the fields say becomes the value. */
  take() {
    const replace = Object.fromEntries(this.inputs.map(([pointer, values]) => [pointer.value.trim(), valuesOf(values.value)]));
    this.tell({ ...this.value, replace });
  }

  add() {
    this.tell({ ...this.value, replace: { ...this.value.replace, "": [] } });
    this.inputs.at(-1)[0].focus();
  }

  remove(row) {
    const rest = Object.entries(this.value.replace ?? {}).filter((_, place) => place !== row);
    this.tell({ ...this.value, replace: Object.fromEntries(rest) });
  }

  put(name, value, standard) {
    const changed = { ...this.value, [name]: value };
    if (value === standard) delete changed[name];
    this.tell(changed);
  }

  tell(value) {
    this.show(value);
    this.changed(value);
  }
}
