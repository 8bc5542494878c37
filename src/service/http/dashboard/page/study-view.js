// A study: its work-precision picture, error against run time with a line for each method, and its table.

import { get, isGivenUp } from "./api.js";
import { atMostEvery, element, fill, table } from "./dom.js";
import { studyActions } from "./job-actions.js";
import { axis, colourOf, CONFIGURATION, layout } from "./plot-style.js";
import { plotlyLoaded } from "./plotly-loaded.js";
import { follow } from "./stream.js";
import { isGoingOn, nameOf, plainWords, short, statusWords } from "./words.js";

/** Milliseconds between readings of a report that grows. */
const AGAIN = 700;
/** A logarithm has no place for zero; errors below this are drawn as it. */
const LEAST_ERROR = 1e-17;

export class StudyView {
  /** Tells `changed()` where the lists are to be read again, and `failed(problem)`. */
  constructor(section, told) {
    this.section = section;
    this.told = told;
    this.summary = element("div", {});
    this.actions = element("div", {});
    this.heading = element("div", { id: "study-heading" }, this.summary, this.actions);
    this.place = element("div", { class: "plot tall", id: "study-plot" });
    this.words = element("p", { class: "quiet" });
    this.rows = element("div", {});
    this.panel = element("div", { class: "panel" }, element("h2", {}, "Work and precision"), this.words, this.place, this.rows);
    fill(section, this.heading, this.panel);
    this.given = new AbortController();
    this.again = atMostEvery(AGAIN, () => this.load().catch((problem) => this.failed(problem)));
    this.stop = () => {};
    this.isConnected = true;
  }

  /** Shows the study of that id; null for none. */
  show(id) {
    if (this.id === id) return;
    this.close();
    this.id = id;
    this.section.hidden = true;
    if (!id) return;
    this.given = new AbortController();
    this.load().then(() => {
      if (this.id !== id || !isGoingOn(this.study)) return;
      this.stop = follow(`/v1/studies/${id}`, null, {
        come: () => this.again(),
        end: (study) => { this.study = study; this.draw(); this.told.changed(); },
        deleted: () => this.gone(),
        connected: (yes) => { this.isConnected = yes; this.told.connection(); },
      });
    }).catch((problem) => this.failed(problem));
  }

  /** The service is back. */
  recover() {
    const { id } = this;
    if (!id || this.study) return;
    this.id = null;
    this.show(id);
  }

  failed(problem) {
    if (!isGivenUp(problem)) this.told.failed(problem);
  }

  async load() {
    if (!this.id) return;
    const study = await get(`/v1/studies/${this.id}`, this.given.signal);
    if (study.id !== this.id) return;
    this.study = study;
    await this.draw();
  }

  /** Somebody has deleted it: what is shown stays, and says so. */
  async gone() {
    this.study = { ...this.study, status: "deleted" };
    this.isConnected = true;
    await this.draw();
    this.failed(new Error("This study has been deleted."));
    this.told.changed();
  }

  async draw() {
    const { study } = this;
    if (!study) return;
    const { report, plan, progress } = study;
    this.section.hidden = false;
    this.told.shown(`Study ${nameOf(study)}`);
    fill(this.summary, element("div", { class: "bar" }, element("h2", {}, nameOf(study)),
      element("span", { class: `status ${study.status}`, id: "study-status" }, study.status)),
    element("p", {}, `${progress.runs} of ${progress.of} paths. The study ${statusWords(study.status)}. `, study.error ?? "",
      ` Errors are measured against the ${plan.reference_is}.`));
    const key = `${study.id} ${study.status} ${report !== null}`;
    if (this.actions.dataset.of !== key) {
      this.actions.dataset.of = key;
      fill(this.actions, studyActions(study, this.told.changed, this.told.failed));
    }
    this.panel.hidden = !report;
    if (!report) return;
    const isTimed = report.rows.every(({ time }) => time);
    const varied = plainWords(report.parameter);
    this.words.textContent = isTimed ? `Each line is a method, each point a value of the ${varied}.`
      : `Until every path has been timed, the ${varied} stands in the place of the time.`;
    await plotlyLoaded();
    const traces = report.orders.map(({ method, order }, place) => {
      const rows = report.rows.filter((row) => row.method === method && row.path_error !== null);
      return {
        type: "scatter", mode: "lines+markers", name: order === null ? method : `${method}, order ${order.toFixed(2)}`,
        x: rows.map(({ time, value }) => (isTimed ? time.median_s : value)),
        y: rows.map(({ path_error: error }) => Math.max(error, LEAST_ERROR)),
        text: rows.map(({ value, increments }) => `${varied} ${short(value)}, ${increments} increments`),
        hovertemplate: `${method}: %{text}<br>error %{y:.2e}, %{x:.3g}${isTimed ? " s" : ""}<extra></extra>`,
        line: { color: colourOf(place) },
        marker: { size: 8, symbol: rows.map(({ resolved }) => (resolved ? "circle" : "circle-open")) },
      };
    });
    const logarithmic = (title) => ({ ...axis(title), type: "log", nticks: 10 });
    await Plotly.react(this.place, traces, layout({
      xaxis: logarithmic(isTimed ? "run time, s" : varied), yaxis: logarithmic("largest distance from the reference"),
      showlegend: true, legend: { orientation: "h", y: 1.12 }, uirevision: study.id,
    }), CONFIGURATION);
    fill(this.rows, element("p", { class: "quiet" }, "Open circles: errors as small as what the reference itself leaves open."),
      table(["method", varied, "error", "order", "time, s", "increments", "events found", "ends"], report.rows.map((row) => [
        row.method, row.value, row.path_error === null ? null : Number(row.path_error.toExponential(2)),
        row.order === null ? null : Number(row.order.toFixed(2)), row.time ? Number(row.time.median_s.toPrecision(3)) : null,
        row.increments, `${row.events.found} of ${row.events.expected}`, plainWords(row.stop_reason)])));
  }

  close() {
    this.given.abort();
    this.stop();
    this.stop = () => {};
    this.study = null;
    this.isConnected = true;
  }
}
