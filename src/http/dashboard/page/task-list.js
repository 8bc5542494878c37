// A list of jobs or of studies, newest first, a page at a time; read again while something of it goes on.

import { get } from "./api.js";
import { button, element, fill } from "./dom.js";
import { state } from "./state.js";
import { isGoingOn } from "./words.js";

const PAGE = 40;
/** Milliseconds between readings. */
const AGAIN = 3000;
/** So many times as seldom where nothing goes on. */
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
      // What others queue appears, too, if later.
      if (!document.hidden && (isBusy || rests % QUIET === 0)) this.load();
    }, AGAIN);
  }

  async load(cursor = null) {
    const { status } = state();
    const asked = new URLSearchParams({ limit: PAGE, ...(status ? { status } : {}), ...(cursor ? { cursor } : {}) });
    const place = `/v1/${this.of}?${asked}`;
    try {
      const page = await get(place);
      // The filter is another meanwhile: what was asked for after this counts.
      if (status !== state().status) return;
      const found = page[this.of];
      if (cursor) {
        this.tasks = [...this.tasks, ...found];
        this.cursor = page.next_cursor;
      } else {
        // Older ones that have been asked for stay.
        const last = found.at(-1)?.id;
        const older = page.next_cursor ? (this.tasks ?? []).filter(({ id }) => id < last) : [];
        this.tasks = [...found, ...older];
        if (older.length === 0) this.cursor = page.next_cursor;
      }
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
