// The contacts of the shown increment as a table, of which one page is shown at a time.

import { button, choice, element, fill, table } from "./dom.js";
import { headed, unitsOf } from "./units.js";
import { plainWords, short } from "./words.js";

/** Rows of a page. */
const ROWS = 20;
const SHOWN = [["", "all"], ["closed", "that touch"], ["stick", "that stick"], ["slip", "that slip"], ["free", "that are free"]];

/** Place to its table, which keeps its page and filter. */
const made = new WeakMap();

/** Shows the contacts of an increment of a path in that place; null before the first increment. */
export function showContacts(panel, path, increment) {
  if (!made.has(panel)) made.set(panel, new ContactsTable(panel));
  made.get(panel).show(path, increment);
}

class ContactsTable {
  constructor(panel) {
    this.panel = panel;
    this.wanted = "";
    this.page = 0;
    this.key = "";
  }

  show(path, increment) {
    const { model } = path.request;
    const all = model.contacts?.length ?? 0;
    this.panel.hidden = all === 0;
    if (all === 0) return;
    if (this.path !== path) this.page = 0;
    Object.assign(this, { path, increment, all });
    this.draw();
  }

  draw() {
    const { increment } = this;
    const contacts = (increment?.contacts ?? []).filter(({ status }) =>
      this.wanted === "" || status === this.wanted || (this.wanted === "closed" && status !== "free"));
    const pages = Math.max(1, Math.ceil(contacts.length / ROWS));
    this.page = Math.min(this.page, pages - 1);
    const first = this.page * ROWS;
    const shown = contacts.slice(first, first + ROWS);
    const turn = (words, by) => button(words, () => { this.page += by; this.draw(); }, {
      "data-key": words, disabled: this.page + by < 0 || this.page + by >= pages,
    });
    fill(this.panel,
      element("div", { class: "bar" }, element("h2", {}, `Contacts${increment ? ` at increment ${increment.index}` : ""}`),
        element("label", {}, "Show ", choice({
          id: "contacts-shown", "data-key": "shown",
          onchange: (event) => { this.wanted = event.target.value; this.page = 0; this.draw(); },
        }, SHOWN, this.wanted))),
      element("p", { class: "quiet", id: "contacts-said" }, this.words(contacts.length, first, shown.length)),
      shown.length ? table(this.head(), shown.map(row)) : null,
      pages > 1 ? element("div", { class: "actions" }, turn("Previous contacts", -1), turn("Next contacts", 1)) : null);
  }

  words(found, first, shown) {
    const { increment, all } = this;
    if (!increment) return `There is no increment yet; the model has ${all === 1 ? "one contact" : `${all} contacts`}.`;
    const recorded = increment.contacts.length;
    const notRecorded = recorded < all ? `Of ${all} contacts this increment records ${recorded}. ` : "";
    if (found === 0) return `${notRecorded}${recorded === 0 ? "" : "None is like that here."}`;
    if (shown === found) return `${notRecorded}${found === 1 ? "One contact." : `All ${found} of them.`}`;
    return `${notRecorded}Contacts ${first + 1} to ${first + shown} of ${found}; the others are on other pages.`;
  }

  head() {
    const { length, force } = unitsOf(this.path.request.model);
    return ["node", "obstacle", "status", headed("gap", length), headed("normal reaction", force),
      headed("tangential reaction", force), headed("slip", length), headed("total slip", length),
      headed(`reaction ${[..."xyz"].slice(0, this.path.request.model.dimension).join(", ")}`, force)];
  }
}

const several = (values) => (values ? number(values.map(short).join(", ")) : number("–"));
const number = (text) => element("span", { class: "number" }, text);

const row = (contact) => [
  contact.node, contact.obstacle,
  element("span", {}, element("span", { class: `swatch state ${contact.status}`, style: `--colour:var(--${contact.status})` }),
    plainWords(contact.status), contact.indeterminate ? " (reaction not determined by equilibrium)" : ""),
  number(short(contact.gap)), number(short(contact.normal_reaction)), several(contact.tangential_reaction), several(contact.slip),
  several(contact.slip_total), several(contact.reaction),
];
