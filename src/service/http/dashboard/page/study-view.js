// A study: its work-precision picture, error against run time with a line for each method, and its table.

import { element, fill, table } from "./dom.js";
import { FindingsView } from "./findings-view.js";
import { axis, colourOf } from "./plot-style.js";
import { counted, plainWords, short } from "./words.js";

/** Milliseconds between readings of a report that grows. */
const AGAIN = 700;
/** A logarithm has no place for zero; errors below this are drawn as it. */
const LEAST_ERROR = 1e-17;

export class StudyView extends FindingsView {
  constructor(section, told) {
    super(section, told, { kind: "study", place: "/v1/studies", title: "Work and precision", pause: AGAIN });
  }

  /** The rows of a study change while it is timed: the whole report is read again. */
  async refresh() {
    if (!this.id) return;
    await this.load(`${this.address}/${this.id}`, this.given.signal);
    await this.draw();
  }

  hasFindings() {
    return Boolean(this.record.report);
  }

  progressWords() {
    const { progress } = this.record;
    return `${progress.runs} of ${progress.of} paths.`;
  }

  remark() {
    const { error, plan } = this.record;
    return ` ${error ?? ""} Errors are measured against the ${plan.reference_is}.`;
  }

  async drawFindings() {
    const { report } = this.record;
    const isTimed = report.rows.every(({ time }) => time);
    const varied = plainWords(report.parameter);
    this.words.textContent = isTimed ? `Each line is a method, each point a value of the ${varied}.`
      : `Until every path has been timed, the ${varied} stands in the place of the time.`;
    const traces = report.orders.map(({ method, order }, place) => {
      const rows = report.rows.filter((row) => row.method === method && row.path_error !== null);
      return {
        type: "scatter", mode: "lines+markers", name: order === null ? method : `${method}, order ${order.toFixed(2)}`,
        x: rows.map(({ time, value }) => (isTimed ? time.median_s : value)),
        y: rows.map(({ path_error: error }) => Math.max(error, LEAST_ERROR)),
        text: rows.map(({ value, increments }) => `${varied} ${short(value)}, ${counted(increments, "increment")}`),
        hovertemplate: `${method}: %{text}<br>error %{y:.2e}, %{x:.3g}${isTimed ? " s" : ""}<extra></extra>`,
        line: { color: colourOf(place) },
        marker: { size: 8, symbol: rows.map(({ resolved }) => (resolved ? "circle" : "circle-open")) },
      };
    });
    const logarithmic = (title) => ({ ...axis(title), type: "log", nticks: 10 });
    await this.plot(traces, {
      xaxis: logarithmic(isTimed ? "run time, s" : varied), yaxis: logarithmic("largest distance from the reference"),
    });
    fill(this.listing, element("p", { class: "quiet" }, "Open circles: errors as small as what the reference itself leaves open."),
      table(["method", varied, "error", "order", "time, s", "increments", "events found", "ends"], report.rows.map((row) => [
        row.method, row.value, row.path_error === null ? null : Number(row.path_error.toExponential(2)),
        row.order === null ? null : Number(row.order.toFixed(2)), row.time ? Number(row.time.median_s.toPrecision(3)) : null,
        row.increments, `${row.events.found} of ${row.events.expected}`, plainWords(row.stop_reason)])));
  }
}
