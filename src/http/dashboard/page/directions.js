// Directions at the chosen increment where there is more than one: load rate, dissipation, which was taken, and following
// another as a new job that is drawn in the same plot.

import { post } from "./api.js";
import { element, fill } from "./dom.js";
import { isGoingOn, short } from "./words.js";

export class Directions {
  /** Tells `followed(job)`. */
  constructor(panel, told) {
    this.panel = panel;
    this.told = told;
  }

  async choose(path, at) {
    this.wanted = `${path.id} ${at}`;
    const { wanted } = this;
    const index = at ?? path.last();
    // While a path grows its last increment is another every time.
    if (index === null || (at === null && isGoingOn(path.job))) return this.hide();
    let increment = null;
    try {
      increment = await path.increment(index);
    } catch {
      return this.hide();
    }
    if (wanted !== this.wanted) return undefined;
    return increment?.directions ? this.draw(path, increment) : this.hide();
  }

  hide() {
    this.panel.hidden = true;
  }

  draw(path, { index, directions, contacts }) {
    this.panel.hidden = false;
    const problem = element("p", { class: "bad", role: "alert" });
    const states = (direction) => direction.contacts
      .map((status, place) => `${contacts[place] ? `${contacts[place].node}: ` : ""}${status}`).join(", ");
    const follow = async (place, button) => {
      button.disabled = true;
      problem.textContent = "";
      try {
        this.told.followed(await post(`/v1/jobs/${path.id}/follow`, JSON.stringify({ increment: index, direction: place })));
      } catch (refused) {
        problem.textContent = [refused.message, ...(refused.errors ?? []).map(({ detail }) => detail)].join(" ");
        button.disabled = false;
      }
    };
    const rows = directions.map((direction, place) => element("tr", { class: direction.taken ? "taken" : null },
      element("td", {}, String(place)), element("td", {}, states(direction)),
      element("td", { class: "number" }, short(direction.load_rate)),
      element("td", { class: "number" }, short(direction.dissipation_rate)),
      element("td", {}, direction.taken ? "taken" : element("button", {
        type: "button", onclick: (event) => follow(place, event.target), "aria-label": `follow direction ${place}`,
      }, "Follow"))));
    fill(this.panel, element("h2", {}, `Directions at increment ${index}`),
      element("p", { class: "quiet" }, "Each is a way in which the path can go on from this point, in both senses of the load."),
      element("div", { class: "wide" }, element("table", {},
        element("thead", {}, element("tr", {}, ["", "contacts", "load rate", "dissipation rate", ""].map((words) =>
          element("th", {}, words)))),
        element("tbody", {}, rows))), problem);
  }
}
