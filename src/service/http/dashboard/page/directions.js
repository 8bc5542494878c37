// Directions at the chosen increment where there is more than one, and where none is chosen at the last bifurcation: load rate,
// dissipation, which was taken, and following another as a new job that is drawn in the same plot.

import { post } from "./api.js";
import { button, element, fill, table } from "./dom.js";
import { short } from "./words.js";

/** Increments that a followed direction is given at least, where nothing else is asked for: else as many as the path has. */
const FEWEST = 20;

export class Directions {
  /** Tells `followed(job)` and `chosen(index)`. */
  constructor(panel, told) {
    this.panel = panel;
    this.told = told;
    this.shown = "";
  }

  async choose(path, at) {
    const index = at ?? path.lastBifurcation() ?? path.last();
    const wanted = `${path.id} ${at} ${index}`;
    this.wanted = wanted;
    if (wanted === this.shown) return;
    let increment = null;
    try {
      increment = index === null ? null : await path.increment(index);
    } catch {
      // What cannot be fetched is told of where the structure is drawn; the next choice asks again.
      this.shown = "";
      this.panel.hidden = true;
      return;
    }
    if (wanted !== this.wanted) return;
    this.shown = wanted;
    if (increment?.directions) this.draw(path, at, increment);
    else if (increment || index === null) this.hide(path, index);
    else this.miss(index);
  }

  /** What there is to choose between is not known. */
  miss(index) {
    this.shown = "";
    this.panel.hidden = false;
    fill(this.panel, element("h2", {}, "Directions"), element("p", { class: "bad", role: "alert" },
      `The directions at increment ${index} cannot be shown: the service does not give it.`));
  }

  /** Nothing to choose between here; where there was says so. */
  hide(path, index) {
    const last = path.points.findLast((one) => one.point.bifurcation && one.index < index)?.index;
    this.panel.hidden = last === undefined;
    if (last === undefined) return;
    fill(this.panel, element("h2", {}, "Directions"), element("p", { class: "quiet" },
      `Increment ${index} has no other direction that is kept. The bifurcation before it is at `,
      button(`increment ${last}`, () => this.told.chosen(last), { class: "plain" }), "."));
  }

  draw(path, at, { index, directions, contacts }) {
    this.panel.hidden = false;
    const problem = element("p", { class: "bad", role: "alert" });
    const states = (direction) => direction.contacts
      .map((status, place) => `${contacts[place] ? `${contacts[place].node}: ` : ""}${status}`).join(", ");
    const most = element("input", {
      type: "number", id: "follow-most", "data-key": "most", min: 1, max: path.job.progress.max_increments, step: 1,
      value: Math.min(path.job.progress.max_increments, Math.max(FEWEST, path.index.length)),
    });
    const follow = async (place, pressed) => {
      // Not disabled: focus would go.
      if (pressed.ariaDisabled === "true") return;
      pressed.ariaDisabled = "true";
      problem.textContent = "";
      const asked = { increment: index, direction: place, ...(most.value ? { max_increments: Number(most.value) } : {}) };
      try {
        this.told.followed(await post(`/v1/jobs/${path.id}/follow`, JSON.stringify(asked)));
      } catch (refused) {
        problem.textContent = [refused.message, ...(refused.errors ?? []).map(({ detail }) => detail)].join(" ");
      }
      pressed.ariaDisabled = "false";
    };
    const hasContacts = directions.some((direction) => direction.contacts.length > 0);
    // What can be done stands first: on a phone the last columns are out of sight.
    const rows = directions.map((direction, place) => element("tr", { class: direction.taken ? "taken" : null },
      element("td", {}, String(place)),
      element("td", {}, direction.taken ? "taken" : button("Follow", (event) => follow(place, event.target), {
        "aria-label": `follow direction ${place}`, "data-key": `follow ${place}`,
      })),
      hasContacts ? element("td", {}, states(direction)) : null,
      element("td", { class: "number" }, short(direction.load_rate)),
      element("td", { class: "number" }, short(direction.dissipation_rate))));
    const where = at === null ? [` at increment ${index}, the last bifurcation of the path`] : [` at increment ${index}`];
    fill(this.panel, element("h2", {}, "Directions", where),
      element("p", { class: "quiet" }, "Each is a way in which the path can go on from this point, in both senses of the load. ",
        at !== null ? null
          : button("Show the structure there", () => this.told.chosen(index), { class: "plain", "data-key": "there" })),
      table(["", "", ...(hasContacts ? ["contacts"] : []), "load rate", "dissipation rate"], rows),
      directions.every(({ taken }) => taken) ? null
        : element("p", {}, element("label", {}, "Follow another for at most ", most, " increments.")), problem);
  }
}
