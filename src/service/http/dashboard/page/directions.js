// The directions at the chosen increment, or at the last bifurcation or the end if none is chosen: their load rate and dissipation, and
// which one the path takes. Another direction can be followed by a new job, which is drawn in the same plot.

import { post } from "./api.js";
import { button, element, fill, table } from "./dom.js";
import { short } from "./words.js";

/** The default number of increments of a followed direction is that of the path, but at least this. */
const FEWEST = 20;
/** Of more contacts than this, those in which the directions differ are named and the others counted. */
const MANY = 12;

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
      // The view of the structure reports the error; the next choice fetches the directions again.
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

  /** The directions are not known. */
  miss(index) {
    this.shown = "";
    this.panel.hidden = false;
    fill(this.panel, element("h2", {}, "Directions"), element("p", { class: "bad", role: "alert" },
      `The directions at increment ${index} cannot be shown: the service does not give it.`));
  }

  /** There are no directions here. */
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
    const differs = contacts.map((_, place) => new Set(directions.map((one) => one.contacts[place])).size > 1);
    const states = (direction) => statesOf(direction, contacts, differs);
    const most = element("input", {
      type: "number", id: "follow-most", "data-key": "most", min: 1, max: path.job.progress.max_increments, step: 1,
      value: Math.min(path.job.progress.max_increments, Math.max(FEWEST, path.index.length)),
    });
    const follow = async (place, pressed) => {
      // Not disabled, as it would lose focus.
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
    // The actions are in the first column, as the last columns may be out of sight on a small screen.
    const rows = directions.map((direction, place) => element("tr", { class: direction.taken ? "taken" : null },
      element("td", {}, String(place)),
      element("td", {}, direction.taken ? "taken" : button("Follow", (event) => follow(place, event.target), {
        "aria-label": `follow direction ${place}`, "data-key": `follow ${place}`,
      })),
      hasContacts ? element("td", {}, states(direction)) : null,
      element("td", { class: "number" }, short(direction.load_rate)),
      element("td", { class: "number" }, short(direction.dissipation_rate))));
    const isLastBifurcation = at === null && index === path.lastBifurcation();
    const where = [` at increment ${index}${isLastBifurcation ? ", the last bifurcation of the path" : ""}`];
    fill(this.panel, element("h2", {}, "Directions", where),
      element("p", { class: "quiet" }, "Each is a way in which the path can go on from this point, in both senses of the load. ",
        at !== null ? null
          : button("Show the structure there", () => this.told.chosen(index), { class: "plain", "data-key": "there" })),
      table(["", "", ...(hasContacts ? ["contacts"] : []), "load rate", "dissipation rate"], rows),
      directions.every(({ taken }) => taken) ? null
        : element("p", {}, element("label", {}, "Follow another for at most ", most, " increments.")), problem);
  }
}

/** The states of the contacts of a direction; of many contacts those in which the directions differ. */
function statesOf(direction, contacts, differs) {
  const all = direction.contacts.map((status, place) => ({ node: contacts[place]?.node, status }));
  const named = all.length > MANY ? all.filter((_, place) => differs[place]) : all;
  const rest = all.length - named.length;
  return [
    ...named.map(({ node, status }) => (node === undefined ? status : `${node}: ${status}`)),
    ...(rest ? [`${rest} alike in all directions`] : []),
  ].join(", ");
}
