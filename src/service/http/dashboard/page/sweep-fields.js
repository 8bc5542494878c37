// Fields for what a sweep varies: a place and its values for each parameter, how the values are combined, what is told of each
// path, and the refinement.
// They show what the text of the request has, and report changes.

import { button, choice, element, fill } from "./dom.js";
import { valueWords } from "./sweep-values.js";

/** The most places that are proposed. */
const PROPOSED = 60;
/** Places of a path that have a name; any other text is a column and a number that it reaches. */
const NAMED = ["first_limit", "largest_load", "first_slip", "first_contact_change", "end"];
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

/** The place of a response as the command line has it: a name, or `tip.x=2`. */
const placeText = (at) => (typeof at === "string" ? at : at ? `${at.value ?? ""}=${at.reaches ?? ""}` : "");

function placeOfText(text) {
  const [, column, number] = /^(.*)=([^=]*)$/.exec(text) ?? [];
  return column === undefined ? text : { value: column.trim(), reaches: number.trim() === "" ? null : Number(number) };
}

/** Columns of a path that a response may have. */
function columnsOf({ model }) {
  const axes = ["x", "y", "z"].slice(0, model?.dimension ?? 2);
  const nodes = Object.keys(model?.nodes ?? {}).flatMap((name) => axes.map((axis) => `${name}.${axis}`));
  const contacts = (Array.isArray(model?.contacts) ? model.contacts : []).flatMap(({ node, obstacle }) =>
    (obstacle ? ["gap", "normal_reaction", "status"].map((name) => `${node}/${obstacle}.${name}`) : []));
  return ["load_factor", "arc_length", "dissipated", ...nodes, ...contacts].slice(0, PROPOSED);
}

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
    this.columns = element("datalist", { id: "sweep-columns" });
    this.told = element("div", {});
    this.combine = choice({ id: "setting-combine", onchange: () => this.put("combine", this.combine.value, "grid") }, COMBINED, "grid");
    this.refine = element("input", {
      type: "number", id: "setting-refine", min: 0, step: 1, placeholder: "none",
      onchange: () => this.put("refine", this.refine.valueAsNumber || 0, 0),
    });
    const labelled = (words, input, more) => element("div", { class: "setting" }, element("label", { for: input.id }, words), input,
      element("small", {}, more));
    this.place = element("fieldset", { class: "settings", id: "sweep-fields" }, element("legend", {}, "What is varied"), this.known,
      this.columns, element("datalist", { id: "sweep-named" }, NAMED.map((name) => element("option", { value: name }))),
      this.rows, button("Another parameter", () => this.add(), { id: "sweep-add" }),
      element("p", {}, "What is told of each path (a name, a column of path.csv, and where: a name, or ",
        element("code", {}, "tip.x=2"), ", where a column reaches a number):"),
      this.told, button("Another response", () => this.addResponse(), { id: "sweep-add-response" }),
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
    const responses = Object.entries(this.value.responses ?? {});
    if (this.asked?.length !== responses.length) this.drawResponses(responses.length);
    responses.forEach(([name, response], row) => {
      const shown = [name, response?.value ?? "load_factor", placeText(response?.at)];
      this.asked[row].forEach((input, place) => { if (input !== document.activeElement) input.value = shown[place]; });
    });
    this.combine.value = this.value.combine ?? "grid";
    if (this.refine !== document.activeElement) this.refine.value = this.value.refine || "";
    if (!request) return;
    fill(this.known, proposals(request).map((place) => element("option", { value: place })));
    fill(this.columns, columnsOf(request).map((name) => element("option", { value: name })));
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

  drawResponses(count) {
    const field = (name, row, attributes) => element("input", {
      type: "text", "aria-label": `${name} of response ${row + 1}`, "data-key": `${name} ${row}`, onchange: () => this.takeResponses(), ...attributes,
    });
    this.asked = Array.from({ length: count }, (_, row) => [
      field("name", row, { placeholder: "tip at limit" }),
      field("column", row, { list: "sweep-columns", placeholder: "load_factor" }),
      field("place", row, { list: "sweep-named", placeholder: "first_limit" }),
    ]);
    fill(this.told, this.asked.map((inputs, row) => element("div", { class: "setting parameter" }, inputs,
      button("Remove", () => this.removeResponse(row), { "aria-label": `remove response ${row + 1}` }))));
  }

  takeResponses() {
    // Members other than these, such as the stage, stay.
    const before = Object.values(this.value.responses ?? {});
    const responses = Object.fromEntries(this.asked.map(([name, column, place], row) => [name.value.trim(), {
      ...before[row], value: column.value.trim() || "load_factor", at: placeOfText(place.value.trim()),
    }]));
    this.put("responses", responses);
  }

  addResponse() {
    const name = `response ${Object.keys(this.value.responses ?? {}).length + 1}`;
    this.put("responses", { ...this.value.responses, [name]: { value: "load_factor", at: "first_limit" } });
    this.asked.at(-1)[0].focus();
  }

  removeResponse(row) {
    const rest = Object.entries(this.value.responses ?? {}).filter((_, place) => place !== row);
    if (rest.length) this.put("responses", Object.fromEntries(rest));
    else this.put("responses", null, null);
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
