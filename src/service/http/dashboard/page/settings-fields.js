// Fields for settings, with descriptions and defaults from the OpenAPI description. They show the values in the text of the
// request and report changes, so that fields and text always agree.

import { choice, element } from "./dom.js";
import { plain, resolved } from "./schema.js";
import { plainWords } from "./words.js";

export class SettingsFields {
  /** `schema`: of the object whose members are the fields; `first`: names of those that are shown at once, in
   *  their order. Tells `changed(value)`. */
  constructor(document, schema, first, changed) {
    this.document = document;
    this.changed = changed;
    this.value = {};
    this.fields = [];
    const { properties } = resolved(document, schema);
    const made = Object.entries(properties).map(([name, property]) => [name, this.member([name], resolved(document, property))]);
    const fields = new Map(made);
    const rest = [...fields.keys()].filter((name) => !first.includes(name));
    const of = (names) => names.map((name) => fields.get(name));
    this.place = element("fieldset", { class: "settings" }, of(first),
      rest.length ? element("details", {}, element("summary", {}, "More settings"), of(rest)) : null);
  }

  /** Shows the values of the request in the fields; null if it cannot be read. */
  show(value) {
    this.place.disabled = value === null;
    this.value = value ?? {};
    for (const { steps, put, input } of this.fields) {
      if (input !== document.activeElement) put(steps.reduce((within, step) => within?.[step], this.value));
    }
  }

  /** A field; null for a setting that is better edited in the text. */
  member(steps, schema) {
    const name = steps.at(-1);
    if (schema.properties) {
      const within = Object.entries(schema.properties)
        .map(([member, property]) => this.member([...steps, member], resolved(this.document, {
          ...property, ...(schema.default?.[member] === undefined ? {} : { default: schema.default[member] }),
        })));
      return element("fieldset", {}, element("legend", {}, plainWords(name)),
        element("p", { class: "quiet" }, plain(schema.description)), within);
    }
    const input = this.input(steps, schema);
    if (!input) return null;
    const id = `setting-${steps.join("-")}`;
    input.id = id;
    return element("div", { class: "setting" }, element("label", { for: id }, plainWords(name)), input,
      schema.description ? element("small", {}, plain(schema.description)) : null);
  }

  input(steps, schema) {
    const types = [schema.type].flat();
    const standard = schema.default ?? null;
    const words = standard === null ? "" : `${plainWords(JSON.stringify(standard)).replaceAll("\"", "")} (default)`;
    const field = (input, put, taken) => {
      input.addEventListener("change", () => this.set(steps, taken(), put));
      this.fields.push({ steps, put, input });
      put(undefined);
      return input;
    };
    if (schema.enum) {
      const others = schema.enum.filter((one) => one !== standard);
      const input = choice({}, [["", words], ...others.map((one) => [one, plainWords(one)])], "");
      return field(input, (value) => { input.value = others.includes(value) ? value : ""; }, () => input.value || undefined);
    }
    if (types.includes("boolean") && types.includes("null")) {
      // The default may depend on other settings, as the description says.
      const input = choice({}, [["", "by default"], ["true", "yes"], ["false", "no"]], "");
      return field(input, (value) => { input.value = value ?? ""; }, () => (input.value ? input.value === "true" : undefined));
    }
    if (types.includes("boolean")) {
      const input = element("input", { type: "checkbox" });
      return field(input, (value) => { input.checked = value ?? standard ?? false; },
        () => (input.checked === (standard ?? false) ? undefined : input.checked));
    }
    if (types.includes("integer") || types.includes("number")) {
      const input = element("input", {
        type: "number", step: types.includes("integer") ? 1 : "any", min: schema.minimum ?? schema.exclusiveMinimum,
        max: schema.maximum, placeholder: words || (types.includes("null") ? "as the scene asks" : "none"),
      });
      return field(input, (value) => { input.value = value ?? ""; },
        () => (Number.isNaN(input.valueAsNumber) ? undefined : input.valueAsNumber));
    }
    if (types.includes("array")) {
      const isOfNumbers = resolved(this.document, schema.items).type === "number";
      const input = element("input", { type: "text", placeholder: "one after another, with commas between" });
      return field(input, (value) => { input.value = (value ?? []).join(", "); }, () => {
        const parts = input.value.split(",").map((part) => part.trim()).filter(Boolean);
        return parts.length ? parts.map((part) => (isOfNumbers && !Number.isNaN(Number(part)) ? Number(part) : part)) : undefined;
      });
    }
    return null;
  }

  /** Omits values that are equal to the default, and objects that become empty. */
  set(steps, value, put) {
    const changed = structuredClone(this.value);
    const way = [changed];
    for (const step of steps.slice(0, -1)) way.push(way.at(-1)[step] ??= {});
    if (value === undefined) delete way.at(-1)[steps.at(-1)];
    else way.at(-1)[steps.at(-1)] = value;
    for (let depth = steps.length - 1; depth > 0; depth--) {
      if (Object.keys(way[depth]).length === 0) delete way[depth - 1][steps[depth - 1]];
    }
    this.value = changed;
    put(value);
    this.changed(changed);
  }
}
