// A list of jobs, studies or sweeps, newest first, page by page; it is read again while one of them has not ended.

import { get } from "./api.js";
import { button, element, fill } from "./dom.js";
import { state } from "./state.js";
import { found, foundWords } from "./task-search.js";
import { isGoingOn } from "./words.js";

const PAGE = 40;
/** The most entries of a page of the service. */
const LARGEST_PAGE = 200;
/** Milliseconds between readings. */
const AGAIN = 3000;
/** Factor of this interval if all have ended. */
const QUIET = 4;

export class TaskList {
  /** `of`: the call's address and the name of its list; `rows(tasks)` answers the `li`s; `empty(status)` what an empty list
   *  says; `come()` is called when it has been read. */
  constructor({ title, of, rows, empty, come = () => {} }) {
    Object.assign(this, { of, rowsOf: rows, empty, come });
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
    const read = [];
    let from = cursor;
    try {
      do {
        const limit = Math.min(LARGEST_PAGE, wanted - read.length);
        const asked = new URLSearchParams({ limit, ...(status ? { status } : {}), ...(from ? { cursor: from } : {}) });
        const page = await get(`/v1/${this.of}?${asked}`);
        // The filter is another meanwhile: what was asked for after this counts.
        if (status !== state().status) return;
        read.push(...page[this.of]);
        from = page.next_cursor;
      } while (from && read.length < wanted);
      this.tasks = cursor ? [...this.tasks, ...read] : read;
      this.cursor = from;
      this.problem = null;
    } catch (problem) {
      this.problem = problem;
    }
    this.draw();
    this.come();
  }

  draw() {
    const { tasks, problem } = this;
    const { search, status } = state();
    const shown = tasks && search ? found(tasks, search) : tasks;
    if (shown) fill(this.rows, this.rowsOf(shown));
    const says = tasks?.length === 0 ? this.empty(status)
      : shown && search ? foundWords(shown.length, tasks.length, this.cursor !== null) : null;
    fill(this.below, problem ? element("p", { class: "bad", role: "alert" }, problem.message) : null,
      !tasks && !problem ? element("p", { class: "quiet" }, "Loading …") : null,
      says ? element("p", { class: "quiet" }, says) : null,
      this.cursor ? button("Load older ones", () => this.load(this.cursor), { "data-key": "older" }) : null);
  }
}
