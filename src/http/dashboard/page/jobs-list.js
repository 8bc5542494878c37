// The list of jobs: progress, filter, which are drawn together, cancel, delete, download.

import { download, get, save } from "./api.js";
import { choice, element, fill } from "./dom.js";
import { act, everyIncrement } from "./path-data.js";
import { change, state } from "./state.js";
import { ago, isGoingOn } from "./words.js";

const STATUSES = ["queued", "running", "completed", "stopped", "cancelled", "failed"];
const PAGE = 40;
const AGAIN = 3000;

export class JobsList {
  constructor(place, failed) {
    this.place = place;
    this.failed = failed;
    this.jobs = null;
    this.cursor = null;
    this.rows = element("ul", { class: "jobs" });
    this.below = element("div", {});
    this.filter = element("label", {}, "Show ");
    fill(place, element("div", { class: "bar" }, element("h2", {}, "Jobs"), this.filter), this.rows, this.below);
    this.load();
    setInterval(() => {
      if (!document.hidden && this.jobs?.some(isGoingOn)) this.load();
    }, AGAIN);
  }

  async load(cursor = null) {
    const { status } = state();
    try {
      const place = `/v1/jobs?limit=${PAGE}${status ? `&status=${status}` : ""}${cursor ? `&cursor=${cursor}` : ""}`;
      const page = await get(place);
      this.jobs = cursor ? [...this.jobs, ...page.jobs] : page.jobs;
      this.cursor = page.next_cursor;
      this.problem = null;
    } catch (problem) {
      this.problem = problem;
    }
    this.draw();
  }

  draw() {
    const { jobs: shown, status } = state();
    if (!this.filter.contains(document.activeElement)) {
      fill(this.filter, "Show ", choice({ onchange: (event) => change({ status: event.target.value }) },
        [["", "all"], ...STATUSES.map((name) => [name, name])], status));
    }
    const { key } = document.activeElement?.dataset ?? {};
    if (this.jobs) fill(this.rows, this.jobs.map((job) => this.row(job, shown)));
    if (key) this.rows.querySelector(`[data-key="${key}"]`)?.focus();
    const nothing = this.jobs?.length === 0 && (status ? `No job is ${status}.` : "There are no jobs yet: start with New run.");
    fill(this.below, this.problem ? element("p", { class: "bad" }, this.problem.message) : null,
      this.jobs ? null : this.problem ? null : element("p", { class: "quiet" }, "Loading …"),
      nothing ? element("p", { class: "quiet" }, nothing) : null,
      this.cursor ? element("button", { type: "button", onclick: () => this.load(this.cursor) }, "Older jobs") : null);
  }

  row(job, shown) {
    const place = shown.indexOf(job.id);
    const { increments, max_increments: most } = job.progress;
    const others = shown.filter((id) => id !== job.id);
    return element("li", { class: place === 0 ? "chosen" : null },
      element("input", {
        type: "checkbox", checked: place >= 0, "data-key": `draw ${job.id}`, "aria-label": `draw ${job.name} with the others`,
        onchange: (event) => change({
          jobs: event.target.checked ? [...others, job.id] : others, run: false, ...(place === 0 ? { at: null } : {}),
        }),
      }),
      element("a", {
        href: `/?jobs=${job.id}`, "data-key": `open ${job.id}`, "aria-current": place === 0 ? "true" : null,
        onclick: (event) => {
          if (event.ctrlKey || event.metaKey || event.shiftKey) return;
          event.preventDefault();
          change({ jobs: [job.id], at: null, abscissa: null, run: false });
        },
      }, job.name),
      element("span", { class: `status ${job.status}` }, job.status),
      element("small", {}, `${increments} increments, ${ago(job.created_at)}${job.parent ? ", a branch" : ""}`),
      isGoingOn(job) ? element("progress", { max: most, value: increments, "aria-label": "increments" }) : null);
  }

  /** What can be done with a job. */
  actions(job) {
    const then = async (what) => {
      try {
        await what();
        await this.load();
      } catch (problem) {
        this.failed(problem);
      }
    };
    const button = (words, what, more = {}) =>
      element("button", { type: "button", ...more, onclick: () => then(what) }, words);
    const { id } = job;
    return element("div", { class: "actions" },
      isGoingOn(job) ? button("Cancel", () => act(id, "cancel")) : null,
      button("Path (csv)", () => download(`/v1/jobs/${id}/path.csv`, `path-${id}.csv`)),
      button("Increments (json)", () => everyIncrement(id).then((blob) => save(blob, `increments-${id}.json`))),
      button("Model (json)", () => download(`/v1/jobs/${id}/request`, `request-${id}.json`)),
      button("Run again, changed", async () => change({ run: true, scene: `job:${id}` })),
      button("Delete", async () => {
        if (!confirm(`Delete “${job.name}” and all its increments?`)) return;
        await act(id, "delete");
        change({ jobs: state().jobs.filter((other) => other !== id), at: null });
      }, { class: "danger" }));
  }
}
