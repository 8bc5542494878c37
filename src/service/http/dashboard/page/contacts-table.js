// The contacts, the forces in members and the reactions of supports at the shown increment as a table, of which one page is
// shown at a time.

import { button, choice, element, fill, table } from "./dom.js";
import { elementForces } from "./element-forces.js";
import { elementWords } from "./quantities.js";
import { vector } from "./geometry.js";
import { headed, measured, moment, unitsOf } from "./units.js";
import { plainWords, short } from "./words.js";

/** The part of the structure's size below which a gap is shown as 0. */
const ROUND_OFF = 1e-13;
/** Rows of a page. */
const ROWS = 20;

const several = (values) => (values ? number(values.map(short).join(", ")) : number("–"));
const number = (text) => element("span", { class: "number" }, text);
const axesOf = ({ dimension }) => [..."xyz"].slice(0, dimension).join(", ");

/** The largest coordinate of a model's nodes; 0 of a model whose nodes are those of a mesh. */
const sizeOf = (model) => Object.values(model.nodes ?? {}).reduce((most, place) => Math.max(most, vector.length(place)), 0);

/** What a table may be of: the words, what is shown of it, how many the model has, those of an increment, head and rows. */
const KINDS = {
  contacts: {
    title: "Contacts", one: "contact",
    shown: [["", "all"], ["closed", "that touch"], ["stick", "that stick"], ["slip", "that slip"], ["free", "that are free"]],
    all: (model) => model.contacts?.length ?? 0,
    of: (model, increment) => {
      const least = ROUND_OFF * sizeOf(model);
      return increment.contacts.map((contact) => (Math.abs(contact.gap) < least ? { ...contact, gap: 0 } : contact));
    },
    chosen: (contacts, wanted) => contacts.filter(({ status }) =>
      wanted === "" || status === wanted || (wanted === "closed" && status !== "free")),
    head: (model) => {
      const { length, force } = unitsOf(model);
      return ["node", "obstacle", "status", headed("gap", length), headed("normal reaction", force),
        headed("tangential reaction", force), headed("slip", length), headed("total slip", length),
        headed(`reaction ${axesOf(model)}`, force)];
    },
    row: (contact) => [
      contact.node, contact.obstacle,
      element("span", {}, element("span", { class: `swatch state ${contact.status}`, style: `--colour:var(--${contact.status})` }),
        plainWords(contact.status), contact.indeterminate ? " (reaction not determined by equilibrium)" : ""),
      number(short(contact.gap)), number(short(contact.normal_reaction)), several(contact.tangential_reaction), several(contact.slip),
      several(contact.slip_total), several(contact.reaction),
    ],
  },
  elements: {
    title: "Members", one: "member",
    shown: [["", "all"], ["largest", "largest axial force first"], ["tension", "in tension"], ["compression", "in compression"]],
    all: (model) => model.elements?.length ?? 0,
    of: (model, increment) => elementForces(model, increment).of.map((found, place) => ({ ...found, place, model })),
    chosen: (members, wanted) => {
      const byAxial = (sense) => members.filter(({ axial }) => axial !== null && sense * axial > 0)
        .sort((one, other) => Math.abs(other.axial) - Math.abs(one.axial));
      if (wanted === "tension") return byAxial(1);
      if (wanted === "compression") return byAxial(-1);
      if (wanted === "largest") return members.toSorted((one, other) => Math.abs(other.axial ?? 0) - Math.abs(one.axial ?? 0));
      return members;
    },
    head: (model) => {
      const { force } = unitsOf(model);
      return ["member", "nodes", headed("axial force", force), "more"];
    },
    row: (found) => {
      const item = found.model.elements[found.place];
      return [elementWords(found.model, found.place), item.nodes?.join(" – ") ?? "", number(short(found.axial)), moreOf(found)];
    },
  },
  supports: {
    title: "Supports", one: "support",
    shown: [["", "all"]],
    all: (model) => Object.keys(model.supports ?? {}).length,
    of: (model, increment) => Object.entries(increment.supports ?? {}).map(([name, force]) => ({ name, force, model })),
    chosen: (supports) => supports,
    head: (model) => {
      const { length, force } = unitsOf(model);
      return ["node", "holds", headed(`reaction ${axesOf(model)}`, force), headed("moment", length && force ? `${force} ${length}` : "")];
    },
    row: ({ name, force, model }) => [name, (model.supports[name] ?? []).join(", "), several(force.slice(0, model.dimension)),
      force.length > model.dimension ? several(force.slice(model.dimension)) : number("–")],
  },
};

/** What a member has besides its axial force. */
function moreOf({ force, ends, moment: turning, equivalent, model }) {
  const units = unitsOf(model);
  const unit = units.force && units.length ? ` ${units.force}/${units.length}²` : "";
  return [
    force ? `force ${force.map(short).join(", ")}` : null,
    ends ? `shear forces ${ends.flatMap((end) => end.shear_force ?? end.shear_forces).map((value) => measured(value, units.force)).join(", ")}` : null,
    ends ? `bending moments ${ends.flatMap((end) => end.bending_moment ?? end.bending_moments).map((value) => moment(value, units)).join(", ")}` : null,
    turning !== null && turning !== undefined ? `moment ${moment(turning, units)}` : null,
    equivalent !== null && equivalent !== undefined ? `von Mises stress ${short(equivalent)}${unit}` : null,
  ].filter(Boolean).join("; ") || "–";
}

/** Place to its table, which keeps its page and filter. */
const made = new WeakMap();

/** Shows what there is at an increment of a path in that place; null before the first increment. */
export function showContacts(panel, path, increment) {
  if (!made.has(panel)) made.set(panel, new StatesTable(panel));
  made.get(panel).show(path, increment);
}

class StatesTable {
  constructor(panel) {
    this.panel = panel;
    this.kind = null;
    this.wanted = "";
    this.page = 0;
  }

  show(path, increment) {
    const { model } = path.request;
    this.kinds = Object.keys(KINDS).filter((kind) => KINDS[kind].all(model) > 0);
    this.panel.hidden = this.kinds.length === 0;
    if (this.panel.hidden) return;
    if (this.path !== path) this.page = 0;
    if (!this.kinds.includes(this.kind)) this.change(this.kinds[0]);
    Object.assign(this, { path, increment });
    this.draw();
  }

  change(kind) {
    Object.assign(this, { kind, wanted: "", page: 0 });
  }

  draw() {
    const { increment, path: { request: { model } } } = this;
    const kind = KINDS[this.kind];
    const all = increment ? kind.of(model, increment) : [];
    const found = kind.chosen(all, this.wanted);
    const pages = Math.max(1, Math.ceil(found.length / ROWS));
    this.page = Math.min(this.page, pages - 1);
    const first = this.page * ROWS;
    const shown = found.slice(first, first + ROWS);
    const turn = (words, by) => button(words, () => { this.page += by; this.draw(); }, {
      "data-key": words, disabled: this.page + by < 0 || this.page + by >= pages,
    });
    const plural = `${kind.one}s`;
    fill(this.panel,
      element("div", { class: "bar" }, element("h2", {}, `${kind.title}${increment ? ` at increment ${increment.index}` : ""}`),
        this.kinds.length > 1 ? element("label", {}, "Table of ", choice({
          id: "states-kind", "data-key": "kind", onchange: (event) => { this.change(event.target.value); this.draw(); },
        }, this.kinds.map((one) => [one, `${KINDS[one].one}s`]), this.kind)) : null,
        kind.shown.length > 1 ? element("label", {}, "Show ", choice({
          id: "contacts-shown", "data-key": "shown",
          onchange: (event) => { this.wanted = event.target.value; this.page = 0; this.draw(); },
        }, kind.shown, this.wanted)) : null),
      element("p", { class: "quiet", id: "contacts-said" }, this.words(kind, all.length, found.length, first, shown.length)),
      shown.length ? table(kind.head(model), shown.map(kind.row)) : null,
      pages > 1 ? element("div", { class: "actions" }, turn(`Previous ${plural}`, -1), turn(`Next ${plural}`, 1)) : null);
  }

  words({ title, one, all: count }, recorded, found, first, shown) {
    const { increment, path: { request: { model } } } = this;
    const all = count(model);
    const plural = `${one}s`;
    if (!increment) return `There is no increment yet; the model has ${all === 1 ? `one ${one}` : `${all} ${plural}`}.`;
    const notRecorded = recorded < all ? `Of ${all} ${plural} this increment records ${recorded}. ` : "";
    if (found === 0) return `${notRecorded}${recorded === 0 ? "" : "None is like that here."}`;
    if (shown === found) return `${notRecorded}${found === 1 ? `One ${one}.` : `All ${found} of them.`}`;
    return `${notRecorded}${title} ${first + 1} to ${first + shown} of ${found}; the others are on other pages.`;
  }
}
