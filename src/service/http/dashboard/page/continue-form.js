// Follows a point of the path in a number of the model: the form below the directions, at the chosen limit point, bifurcation
// point or contact change, or at the first limit point.

import { post } from "./api.js";
import { button, element, fill } from "./dom.js";
import { mayJump } from "./quantities.js";
import { kindWords, short } from "./words.js";

const LIMITS = ["smooth_limit", "nonsmooth_limit"];
const FOLLOWED = [...LIMITS, "smooth_bifurcation", "contact_change"];
/** Places that are suggested of each kind. */
const SUGGESTED = 12;
/** Names of stiffnesses. */
const STIFFNESSES = ["axial_stiffness", "bending_stiffness", "shear_stiffness"];

export class ContinueForm {
  /** Tells `continued(curve)`. */
  constructor(panel, told) {
    this.panel = panel;
    this.told = told;
    this.shown = "";
  }

  choose(path, at) {
    const points = path.points.filter(({ point }) => FOLLOWED.includes(point.kind));
    const chosen = points.find(({ index }) => index === at) ?? points.find(({ point }) => LIMITS.includes(point.kind)) ?? points[0];
    // Of a path that jumps no point is followed.
    const wanted = chosen && !path.job.parent && !mayJump(path.request) ? `${path.id} ${chosen.index}` : "";
    if (wanted === this.shown) return;
    this.shown = wanted;
    this.panel.hidden = !wanted;
    if (wanted) this.draw(path, chosen);
  }

  draw(path, { index, point }) {
    const { model } = path.request;
    const places = suggestions(model);
    const problem = element("p", { class: "bad", role: "alert" });
    const [from, to] = ["from", "to"].map((end) => element("input", { type: "number", step: "any", id: `curve-${end}`, "data-key": end }));
    const parameter = element("input", {
      type: "text", id: "curve-parameter", "data-key": "parameter", list: "curve-parameters", value: places[0] ?? "", size: 36,
      spellcheck: "false", oninput: () => fit(),
    });
    /** A range around the model's own value. */
    const fit = () => {
      const own = valueAt(model, parameter.value);
      if (typeof own !== "number") return;
      const width = 0.5 * Math.abs(own) || 1;
      from.value = short(parameter.value.endsWith("friction") || own > 0 ? Math.max(0, own - width) : own - width);
      to.value = short(own + width);
    };
    fit();
    const follow = async (pressed) => {
      if (pressed.ariaDisabled === "true") return;
      pressed.ariaDisabled = "true";
      problem.textContent = "";
      const asked = { increment: index, parameter: parameter.value, range: [Number(from.value), Number(to.value)] };
      try {
        this.told.continued(await post(`/v1/jobs/${path.id}/continue`, JSON.stringify(asked)));
      } catch (refused) {
        problem.textContent = [refused.message, ...(refused.errors ?? []).map(({ detail }) => detail)].join(" ");
      }
      pressed.ariaDisabled = "false";
    };
    fill(this.panel, element("h2", {}, "A point in a parameter"),
      element("p", { class: "quiet" },
        `Follow the ${kindWords(point.kind)} at increment ${index} as a number of the model varies, such as its load over friction.
        Another limit point, bifurcation point or contact change is followed where it is the shown increment.`),
      slipsInPlane(model) ? element("p", { class: "quiet" },
        `In space a point cannot be followed where contacts slip against friction on the way to it, since the direction of
        slip turns: sweep the number instead.`) : null,
      element("datalist", { id: "curve-parameters" }, places.map((place) => element("option", { value: place }))),
      element("div", { class: "actions" },
        element("label", {}, "Place ", parameter), element("label", {}, "from ", from), element("label", {}, "to ", to),
        button("Follow the point", (event) => follow(event.target), { id: "continue" })), problem);
  }
}

/** Whether contacts of the model may slip against friction in a plane. */
function slipsInPlane({ dimension, contacts = [] }) {
  return dimension === 3 && contacts.some(({ friction }) => friction > 0);
}

/** Pointers to numbers that are often varied. */
function suggestions(model) {
  const contacts = model.contacts ?? [];
  const frictions = contacts.map(({ friction }) => friction);
  const isOne = frictions.length > 1 && frictions.every((friction) => friction === frictions[0]);
  const stiffness = ({ element: one, place }) => STIFFNESSES.filter((name) => typeof one[name] === "number")
    .map((name) => `/model/elements/${place}/${name}`);
  return [
    ...(isOne ? ["/model/contacts/*/friction"] : []),
    ...contacts.slice(0, SUGGESTED).flatMap(({ friction }, place) => (typeof friction === "number" ? [`/model/contacts/${place}/friction`] : [])),
    ...(model.elements ?? []).slice(0, SUGGESTED).flatMap((one, place) => stiffness({ element: one, place })),
    ...Object.entries(model.nodes ?? {}).slice(0, SUGGESTED).flatMap(([name, place]) => place.map((_, axis) => `/model/nodes/${name}/${axis}`)),
  ];
}

/** The number at a pointer; of a step `*` that of the first item. */
function valueAt(model, pointer) {
  let value = { model };
  for (const step of pointer.split("/").slice(1)) {
    const name = step.replaceAll("~1", "/").replaceAll("~0", "~");
    value = name === "*" ? Object.values(value ?? {})[0] : value?.[name];
  }
  return value;
}
