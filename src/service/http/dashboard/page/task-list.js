// A list of jobs, studies or sweeps, newest first, page by page; it is read again while one of them has not ended.

import { get } from "./api.js";
import { button, element, fill } from "./dom.js";
import { state } from "./state.js";
import { isGoingOn } from "./words.js";

const PAGE = 40;
/** The most entries of a page of the service. */
const LARGEST_PAGE = 200;
/** Milliseconds between readings. */
const AGAIN = 3000;
/** Factor of this interval if all have ended. */
const QUIET = 4;

export class TaskList {
  /** `of`: the call's address and the name of its list; `row(task)` answers an `li`; `empty(status)` what an empty list says. */
  constructor({ title, of, row, empty }) {
    Object.assign(this, { of, row, empty });
    this.tasks = null;
    this.cursor = null;
    this.problem = null;
    this.rows = element("ul", { class: "tasks", "aria-label": title });
    this.below = element("div", {});
    this.place = element("div", {}, this.rows, this.below);
    let rests = 0;
    setInterval(() => {
      const isBusy = this.problem || this.tasks?.some(isGoingOn);
      rests = isBusy ? 0 : rests + 1;
      // Jobs that others queue appear, too, but later.
      if (!document.hidden && (isBusy || rests % QUIET === 0)) this.load();
    }, AGAIN);
  }

  async load(cursor = null) {
    const { status } = state();
    // Older ones that have been requested are read again with the others.
    const wanted = cursor ? PAGE : Math.max(PAGE, this.tasks?.length ?? 0);
    const found = [];
    let from = cursor;
    try {
      do {
        const limit = Math.min(LARGEST_PAGE, wanted - found.length);
        const asked = new URLSearchParams({ limit, ...(status ? { status } : {}), ...(from ? { cursor: from } : {}) });
        const page = await get(`/v1/${this.of}?${asked}`);
        // The filter is another meanwhile: what was asked for after this counts.
        if (status !== state().status) return;
        found.push(...page[this.of]);
        from = page.next_cursor;
      } while (from && found.length < wanted);
      this.tasks = cursor ? [...this.tasks, ...found] : found;
      this.cursor = from;
      this.problem = null;
    } catch (problem) {
      this.problem = problem;
    }
    this.draw();
  }

  draw() {
    const { tasks, problem } = this;
    if (tasks) fill(this.rows, tasks.map((task) => this.row(task)));
    const says = tasks?.length === 0 ? this.empty(state().status) : null;
    fill(this.below, problem ? element("p", { class: "bad", role: "alert" }, problem.message) : null,
      !tasks && !problem ? element("p", { class: "quiet" }, "Loading …") : null,
      says ? element("p", { class: "quiet" }, says) : null,
      this.cursor ? button("Older ones", () => this.load(this.cursor), { "data-key": "older" }) : null);
  }
}
