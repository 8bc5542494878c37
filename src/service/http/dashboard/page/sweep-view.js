// A sweep: the first limit load against what is varied, with a line for each set of the other values, and its runs, whose
// paths can be drawn over one another.

import { get, isGivenUp } from "./api.js";
import { atMostEvery, button, element, fill, table } from "./dom.js";
import { sweepActions } from "./job-actions.js";
import { axis, colourOf, CONFIGURATION, layout } from "./plot-style.js";
import { plotlyLoaded } from "./plotly-loaded.js";
import { addressOfJob, openJobs } from "./state.js";
import { follow } from "./stream.js";
import { isGoingOn, nameOf, plainWords, short, statusWords, verbatim } from "./words.js";

/** Milliseconds between drawings while rows come in. */
const AGAIN = 500;
/** Paths that are drawn over one another at the most. */
const OVERLAID = 12;
/** Runs that stand in the table; the others are in the files. */
const LISTED = 500;

export class SweepView {
  /** Tells `changed()` where the lists are to be read again, and `failed(problem)`. */
  constructor(section, told) {
    this.section = section;
    this.told = told;
    this.summary = element("div", {});
    this.actions = element("div", {});
    this.heading = element("div", { id: "sweep-heading" }, this.summary, this.actions);
    this.place = element("div", { class: "plot tall", id: "sweep-plot" });
    this.words = element("p", { class: "quiet" });
    this.runs = element("div", {});
    this.panel = element("div", { class: "panel" }, element("h2", {}, "Limit loads"), this.words, this.place, this.runs);
    fill(section, this.heading, this.panel);
    this.given = new AbortController();
    this.again = atMostEvery(AGAIN, () => this.draw());
    this.stop = () => {};
    this.isConnected = true;
  }

  /** Shows the sweep of that id; null for none. */
  show(id) {
    if (this.id === id) return;
    this.close();
    this.id = id;
    this.section.hidden = true;
    if (!id) return;
    this.given = new AbortController();
    this.load().catch((problem) => { if (!isGivenUp(problem)) this.told.failed(problem); });
  }

  /** The service is back. */
  recover() {
    const { id } = this;
    if (!id || this.isLoaded) return;
    this.id = null;
    this.show(id);
  }

  async load() {
    const { id } = this;
    const { signal } = this.given;
    this.rows = [];
    this.sweep = await get(`/v1/sweeps/${id}`, signal);
    let after = null;
    for (;;) {
      const page = await get(`/v1/sweeps/${id}/rows${after === null ? "" : `?after=${after}`}`, signal);
      this.rows.push(...page.rows);
      after = page.next_after;
      if (page.rows.length === 0) break;
    }
    this.isLoaded = true;
    await this.draw();
    if (signal.aborted || !isGoingOn(this.sweep)) return;
    this.stop = follow(`/v1/sweeps/${id}`, after, {
      come: (rows) => { this.rows.push(...rows); this.sweep.progress.ended = this.rows.length; this.again(); },
      end: (sweep) => { this.sweep = sweep; this.draw(); this.told.changed(); },
      deleted: () => this.gone(),
      connected: (yes) => { this.isConnected = yes; this.told.connection(); },
    });
  }

  /** Somebody has deleted it: what is shown stays, and says so. */
  async gone() {
    this.sweep = { ...this.sweep, status: "deleted" };
    this.isConnected = true;
    await this.draw();
    this.told.failed(new Error("This sweep has been deleted."));
    this.told.changed();
  }

  async draw() {
    const { sweep } = this;
    if (!sweep) return;
    this.section.hidden = false;
    this.told.shown(`Sweep ${nameOf(sweep)}`);
    const { progress, parameters } = sweep;
    fill(this.summary, element("div", { class: "bar" }, element("h2", {}, nameOf(sweep)),
      element("span", { class: `status ${sweep.status}`, id: "sweep-status" }, sweep.status)),
    element("p", {}, `${progress.ended} of ${progress.of} runs have ended. The sweep ${statusWords(sweep.status)}.`));
    const key = `${sweep.id} ${sweep.status} ${this.rows.length > 0}`;
    if (this.actions.dataset.of !== key) {
      this.actions.dataset.of = key;
      fill(this.actions, sweepActions(sweep, this.rows.length > 0, this.told.changed, this.told.failed));
    }
    const rows = this.rows.toSorted((a, b) => a.run - b.run);
    this.panel.hidden = rows.length === 0;
    if (this.panel.hidden) return;
    const names = parameters.map(({ pointer }) => placeWords(pointer));
    const without = rows.filter(({ first_limit: limit }) => !limit).length;
    this.words.textContent = `The load at the first limit point of each path.${without ? ` ${without} have none.` : ""}`;
    await plotlyLoaded();
    const isNumbers = rows.every(({ values }) => typeof values[0] === "number");
    const inOrder = isNumbers ? rows.toSorted((a, b) => a.values[0] - b.values[0]) : rows;
    const lines = Object.groupBy(inOrder, ({ values }) => JSON.stringify(values.slice(1)));
    const traces = Object.values(lines).map((line, place) => ({
      type: "scatter", mode: "lines+markers",
      name: line[0].values.slice(1).map((value, other) => `${verbatim(names[other + 1])} ${verbatim(shown(value))}`).join(", ") || "first limit load",
      x: line.map(({ values }) => (isNumbers ? values[0] : verbatim(shown(values[0])))),
      y: line.map(({ first_limit: limit }) => limit?.load_factor ?? null),
      text: line.map(({ run, first_limit: limit }) => `run ${run}${limit ? `, ${plainWords(limit.kind)}` : ""}`),
      hovertemplate: "%{text}<br>%{x}: %{y:.6g}<extra></extra>",
      line: { color: colourOf(place) }, marker: { size: 7 },
    }));
    await Plotly.react(this.place, traces, layout({
      xaxis: { ...axis(names[0]), ...(isNumbers ? {} : { type: "category" }) }, yaxis: { ...axis("first limit load factor"), rangemode: "tozero" },
      showlegend: traces.length > 1, legend: { orientation: "h", y: 1.12 }, uirevision: sweep.id,
    }), CONFIGURATION);
    const drawn = rows.filter(({ last_index: last }) => last !== null).slice(0, OVERLAID);
    fill(this.runs,
      element("div", { class: "actions" }, button(`Draw the paths of ${drawn.length === rows.length ? "all" : `the first ${drawn.length}`} runs`,
        () => openJobs(drawn.map(({ job }) => job)), { "data-key": "overlay", id: "overlay" })),
      table(["run", ...names, "limit load", "kind", "at increment", "ends", ""], rows.slice(0, LISTED).map((row) => [
        row.run, ...row.values.map((value) => (typeof value === "number" ? value : shown(value))),
        row.first_limit ? Number(short(row.first_limit.load_factor)) : null, row.first_limit ? plainWords(row.first_limit.kind) : null,
        row.first_limit?.increment ?? null, row.error ?? plainWords(row.stop_reason ?? row.status),
        element("a", { href: addressOfJob(row.job) }, "path")])),
      rows.length > LISTED ? element("p", { class: "quiet" }, `The first ${LISTED} of ${rows.length}; the files have all of them.`) : null);
  }

  close() {
    this.given.abort();
    this.stop();
    this.stop = () => {};
    this.sweep = null;
    this.isLoaded = false;
    this.isConnected = true;
  }
}

const shown = (value) => (typeof value === "string" ? value : JSON.stringify(value));

/** A pointer as a reader would write it: `contacts[0].friction`. */
function placeWords(pointer) {
  const steps = pointer.split("/").slice(1).map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));
  const written = steps.map((step) => (/^\d+$/.test(step) ? `[${step}]` : `.${step}`)).join("").slice(1);
  return written.replace(/^model\./, "");
}
