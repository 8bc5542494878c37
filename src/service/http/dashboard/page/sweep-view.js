// A sweep: a response, or the first limit load, against what is varied, with a line for each set of the other values, and its
// runs, whose paths can be drawn over one another.

import { button, choice, element, fill, table } from "./dom.js";
import { axis, colourOf, constantRange } from "./plot-style.js";
import { RowsView } from "./rows-view.js";
import { addressOfJob, openJobs } from "./state.js";
import { placeWords, valueWords } from "./sweep-values.js";
import { headed } from "./units.js";
import { plainWords, verbatim } from "./words.js";

/** Milliseconds between drawings while rows come in. */
const AGAIN = 500;
/** Paths that are drawn over one another at the most. */
const OVERLAID = 40;
/** Runs that stand in the table; the others are in the files. */
const LISTED = 500;

/** Digits that tell runs from one another whose values are close. */
const precise = (value) => Number(value.toPrecision(9));
const shown = (value) => (typeof value === "number" ? precise(value) : value ?? null);

/** The order of two runs by their values, the first one first. */
function compared(own, other) {
  const place = own.findIndex((value, at) => value !== other[at]);
  if (place < 0) return 0;
  return typeof own[place] === "number" && typeof other[place] === "number" ? own[place] - other[place] : 0;
}

export class SweepView extends RowsView {
  constructor(section, told) {
    super(section, told, { kind: "sweep", place: "/v1/sweeps", title: "What the runs have", pause: AGAIN });
    this.choices = element("div", { class: "choices" });
    this.plotPlace.before(this.choices);
    /** The drawn response, by its name; null for the first. */
    this.response = null;
  }

  progressWords() {
    const { progress } = this.record;
    return `${this.rows.length} of ${progress.of} runs have ended.`;
  }

  async drawFindings() {
    const rows = this.rows.toSorted((a, b) => a.run - b.run);
    const names = this.record.parameters.map(({ pointer }) => placeWords(pointer));
    const responses = Object.keys(this.record.responses ?? {});
    // As in the picture of the command line: the first response, or the first limit load; another one on request.
    const response = responses.includes(this.response) ? this.response : responses[0];
    fill(this.choices, responses.length < 2 ? null : element("label", {}, "Draw ", choice({
      id: "sweep-response", "data-key": "sweep-response",
      onchange: (event) => { this.response = event.target.value; this.draw().catch((problem) => this.failed(problem)); },
    }, responses.map((name) => [name, name]), response)));
    const drawnOf = (row) => (response === undefined ? row.first_limit?.load_factor ?? null : row.responses?.[response] ?? null);
    const isNumber = (row) => typeof drawnOf(row) === "number";
    const unitOf = (name) => this.record.response_units?.[name];
    const told = response === undefined ? "first limit load factor" : headed(response, unitOf(response));
    const without = rows.filter((row) => !isNumber(row)).length;
    this.words.textContent = `${response === undefined ? "The load at the first limit point" : `“${response}”`} of each path.`
      + (without ? ` ${without} have ${response === undefined ? "none" : "no number of it"}.` : "");
    const isNumbers = rows.every(({ values }) => typeof values[0] === "number");
    const inOrder = isNumbers ? rows.toSorted((a, b) => a.values[0] - b.values[0]) : rows;
    const lines = Object.groupBy(inOrder, ({ values }) => JSON.stringify(values.slice(1)));
    const traces = Object.values(lines).map((line, place) => ({
      type: "scatter", mode: "lines+markers",
      name: line[0].values.slice(1).map((value, other) => `${verbatim(names[other + 1])} ${verbatim(valueWords(value))}`).join(", ") || verbatim(told),
      x: line.map(({ values }) => (isNumbers ? values[0] : verbatim(valueWords(values[0])))),
      y: line.map((row) => (isNumber(row) ? drawnOf(row) : null)),
      text: line.map(({ run, first_limit: limit }) => `run ${run}${limit ? `, ${plainWords(limit.kind)}` : ""}`),
      hovertemplate: "%{text}<br>%{x}: %{y:.6g}<extra></extra>",
      line: { color: colourOf(place) }, marker: { size: 7 },
    }));
    await this.plot(traces, {
      xaxis: { ...axis(names[0]), ...(isNumbers ? {} : { type: "category" }) }, yaxis: { ...axis(verbatim(told)), ...constantRange(traces.flatMap(({ y }) => y)) },
      showlegend: traces.length > 1,
    });
    // By their values, since runs that refine a sweep come last.
    const listed = isNumbers ? rows.toSorted((a, b) => compared(a.values, b.values)) : rows;
    const drawn = rows.filter(({ last_index: last }) => last !== null).slice(0, OVERLAID);
    fill(this.listing,
      element("div", { class: "actions" }, button(`Draw the paths of ${drawn.length === rows.length ? "all" : `the first ${drawn.length}`} runs`,
        () => openJobs(drawn.map(({ job }) => job)), { "data-key": "overlay", id: "overlay" })),
      table(["run", ...names, ...responses.map((name) => headed(name, unitOf(name))), "first limit point: load factor", "kind", "at increment", "ends", ""], listed.slice(0, LISTED).map((row) => [
        row.run, ...row.values.map((value) => (typeof value === "number" ? value : valueWords(value))),
        ...responses.map((name) => shown(row.responses?.[name])),
        row.first_limit ? precise(row.first_limit.load_factor) : null, row.first_limit ? plainWords(row.first_limit.kind) : null,
        row.first_limit?.increment ?? null, row.error ?? plainWords(row.stop_reason ?? row.status),
        element("a", { href: addressOfJob(row.job) }, "path")])),
      rows.length > LISTED ? element("p", { class: "quiet" }, `The first ${LISTED} of ${rows.length}; the files have all of them.`) : null);
  }
}
