// Diagnostics of a path: errors, run time, work, events and settings.

import { isGivenUp } from "./api.js";
import { element, fill, table } from "./dom.js";
import { analysisDefaults } from "./schema.js";
import { axis, colourOf, CONFIGURATION, layout } from "./plot-style.js";
import { leftOutSentence, settingsSentences, short, warningSentences } from "./words.js";

const ERRORS = [
  ["residual", "residual"], ["complementarity", "complementarity"], ["energy_error", "energy balance"],
  ["error_estimate", "error estimate"],
];
const WORK = [
  ["factorisations", "factorisations"], ["newton_iterations", "Newton iterations"], ["qp_solves", "quadratic programs"],
  ["sqp_iterations", "SQP iterations"], ["mpec_solves", "MPECs solved"], ["certificates", "certificates"],
  ["mpec_fallbacks", "increments that the MPEC did not find"],
  ["bifurcation_factorisations", "factorisations for bifurcations"],
];
const RELAXATION = "last_relaxation";
const of = (name) => `/diagnostics/${name}`;
/** Values below this count as zero, which a logarithmic axis cannot show. */
const NOTHING = 1e-20;
const ROWS = 500;

export class Diagnostics {
  /** Tells `opened(yes)`. */
  constructor(panel, told, isOpen) {
    this.path = null;
    this.place = element("div", { class: "plot", id: "diagnostics-plot" });
    this.work = element("div", {});
    this.events = element("div", {});
    this.settings = element("div", {});
    this.whole = element("details", { open: isOpen, ontoggle: () => { told.opened(this.whole.open); this.draw(); } },
      element("summary", {}, element("h2", {}, "Diagnostics")), this.place,
      element("p", { class: "quiet" }, "Errors that are exactly zero have no place on this axis."), this.work,
      this.settings, this.events);
    fill(panel, this.whole);
  }

  /** Opens or closes the panel as the address says. */
  open(yes) {
    this.whole.open = yes;
  }

  show(path) {
    this.path = path;
    return this.draw();
  }

  async draw() {
    const { path } = this;
    if (!this.whole.open || !path) return;
    let defaults;
    try {
      defaults = await analysisDefaults();
      await path.need([of("elapsed_s"), ...ERRORS.concat(WORK).map(([name]) => of(name)), of(RELAXATION)]);
    } catch (problem) {
      if (!isGivenUp(problem)) fill(this.work, element("p", { class: "bad" }, problem.message));
      return;
    }
    if (path !== this.path) return;
    const seconds = path.columns.get(of("elapsed_s"));
    const traces = ERRORS.map(([name, words], place) => ({
      type: "scatter", mode: seconds.length > 300 ? "lines" : "lines+markers", name: words, x: seconds,
      y: path.columns.get(of(name)).map((value) => (Math.abs(value) > NOTHING ? Math.abs(value) : null)),
      customdata: path.index, line: { color: colourOf(place), width: 1.5 }, marker: { size: 4 },
      hovertemplate: `${words} %{y:.2e}<br>increment %{customdata}<extra></extra>`,
    }));
    await Plotly.react(this.place, traces, layout({
      xaxis: axis("run time, s"), yaxis: { ...axis("error"), type: "log", dtick: 1 }, showlegend: true,
      legend: { orientation: "h", y: 1.12 }, uirevision: path.id,
    }), CONFIGURATION);
    this.tables(defaults);
  }

  /** The bound on products at which the last program of an increment ended. */
  lastRelaxation() {
    const last = (this.path.columns.get(of(RELAXATION)) ?? []).findLast((value) => value !== null && value !== undefined);
    return last === undefined ? null : element("p", { class: "quiet" }, `The last MPEC was solved down to ε = ${short(last)}.`);
  }

  tables(defaults) {
    const { path } = this;
    const many = path.index.length || 1;
    fill(this.work, element("h3", {}, "Work"), table(["", "total", "per increment"], WORK.map(([name, words]) => {
      // Counted from the start of the job.
      const sum = path.job.report?.[name] ?? path.columns.get(of(name)).at(-1) ?? 0;
      return [words, sum, Number(short(sum / many))];
    })), this.lastRelaxation());
    const told = path.points.filter(({ point }) => point.event);
    fill(this.events, element("h3", {}, "Events"), told.length === 0 ? element("p", { class: "quiet" }, "None so far.")
      : table([], told.slice(0, ROWS).map(({ index, point }) => [index, point.event])),
    told.length > ROWS ? element("p", { class: "quiet" }, `and ${told.length - ROWS} more`) : null);
    const { left_out: leftOut = [] } = path.job.plan ?? {};
    fill(this.settings, element("h3", {}, "Settings"), element("ul", {},
      warningSentences(path.job.plan).map((words) => element("li", {}, element("b", {}, "Warning: "), words)),
      settingsSentences(path.request, path.job.plan, defaults).map((words) => element("li", {}, words)),
      leftOut.map((one) => element("li", {}, `Left out: ${leftOutSentence(one)}`))));
  }
}
