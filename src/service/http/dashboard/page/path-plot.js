// Load, or an energy, against a displacement, of one job or several: lines that grow while they stream, named points, the
// chosen increment.

import { element, fill } from "./dom.js";
import { abscissaWords, axesControls, ofDisplacement, ordinateWords } from "./path-axes.js";
import { namedPoints, pathLegend } from "./path-legend.js";
import { PathLooks } from "./path-names.js";
import { axis, CONFIGURATION, fromSheet, layout } from "./plot-style.js";
import { named } from "./points.js";
import { pointWords, verbatim } from "./words.js";

/** Up to this number of increments each has a marker. */
const MARKED = 400;
/** The largest part of the time that is spent on drawing. */
const SHARE = 0.25;
/** Traces of a job: its line, its named points. */
const OF_A_JOB = 2;
const MARK = { plain: 13, pointedAt: 22 };

export class PathPlot {
  /** Tells `chosen(id, index)`, `hovered(id, index)`, `left()` and `axes({abscissa} or {ordinate})`. */
  constructor(panel, told) {
    this.told = told;
    this.choices = element("div", { class: "choices" });
    this.place = element("div", { class: "plot", id: "path-plot" });
    this.legend = element("ul", { class: "legend" });
    this.list = element("ol", { class: "named", "aria-label": "named points" });
    fill(panel, element("h2", {}, "Path"), this.choices, this.place, this.legend, this.list);
    this.paths = [];
    this.looks = new PathLooks();
    this.revision = 0;
    this.drawn = [];
    this.waits = false;
    this.listens = false;
  }

  /** Draws axes without a path while it is being loaded. */
  async prepare() {
    this.paths = [];
    fill(this.legend);
    fill(this.list);
    await Plotly.react(this.place, [], layout({ xaxis: axis(""), yaxis: axis("") }), CONFIGURATION);
  }

  /** Draws everything anew; `axes`: names of the abscissa and of the ordinate. */
  async draw(paths, axes, at) {
    this.follow(paths, axes);
    this.at = at;
    this.controls();
    const traces = paths.flatMap((path) => {
      const colour = this.looks.colour(path);
      return [
        {
          ...this.line(path, 0), type: "scatter", mode: mode(path),
          line: { color: colour, width: 2, dash: this.looks.dash(path) }, marker: { color: colour, size: 4 },
          hovertemplate: "%{x:.5g}, %{y:.5g}<br>increment %{customdata}<extra></extra>",
        },
        this.points(path, colour),
      ];
    });
    this.drawn = paths.map((path) => path.index.length);
    this.drawnPoints = paths.map((path) => named(path).length);
    traces.push({
      ...this.mark(), type: "scatter", mode: "markers", hoverinfo: "skip",
      marker: { size: MARK.plain, symbol: "circle-open", color: fromSheet("--text"), line: { width: 2 } },
    });
    const exact = this.exact();
    if (exact) traces.push(exact);
    await Plotly.react(this.place, traces, layout({
      xaxis: axis(abscissaWords(axes.abscissa, paths[0].request)),
      yaxis: axis(ordinateWords(axes.ordinate, paths[0].request)), uirevision: this.revision,
    }), CONFIGURATION);
    this.listen();
    namedPoints(this.list, paths[0], (index) => this.told.chosen(paths[0].id, index));
  }

  /** The zoom is kept as long as one of the drawn paths and the axes remain. */
  follow(paths, axes) {
    const stays = this.axes?.abscissa === axes.abscissa && this.axes?.ordinate === axes.ordinate
      && paths.some(({ id }) => this.paths.some((before) => before.id === id));
    if (!stays) this.revision++;
    this.paths = paths;
    this.axes = axes;
  }

  /** Sets the jobs that are drawn from now on; each keeps its style as long as it is among them. */
  keep(ids) {
    this.looks.keep(ids);
  }

  isDrawn() {
    return this.place.classList.contains("js-plotly-plot");
  }

  listen() {
    if (this.listens) return;
    this.listens = true;
    const where = ({ points }) => {
      const { curveNumber, customdata } = points[0] ?? {};
      const path = this.paths[Math.floor(curveNumber / OF_A_JOB)];
      return path && Number.isInteger(customdata) ? [path.id, customdata] : null;
    };
    this.place.on("plotly_click", (event) => { const found = where(event); if (found) this.told.chosen(...found); });
    this.place.on("plotly_hover", (event) => { const found = where(event); if (found) this.told.hovered(...found); });
    this.place.on("plotly_unhover", () => this.told.left());
  }

  abscissaOf(path) {
    return path.columns.get(this.axes.abscissa) ?? [];
  }

  ordinateOf(path) {
    return path.columns.get(this.axes.ordinate) ?? [];
  }

  /** The coordinates of a path in the plot; a point without an abscissa is left out and does not affect the range of the ordinate. */
  placesOf(path) {
    const [abscissa, ordinate] = [this.abscissaOf(path), this.ordinateOf(path)];
    return { x: (place) => abscissa[place], y: (place) => (abscissa[place] === null ? null : ordinate[place]) };
  }

  /** The points from an increment on. The load factor starts again with each stage, where the line is interrupted. */
  line(path, from) {
    const line = { x: [], y: [], customdata: [] };
    const { x, y } = this.placesOf(path);
    const stages = path.columns.get("stage");
    for (let place = from; place < path.index.length; place++) {
      if (place > 0 && stages[place] !== stages[place - 1]) for (const part of Object.values(line)) part.push(null);
      line.x.push(x(place));
      line.y.push(y(place));
      line.customdata.push(path.index[place]);
    }
    return line;
  }

  points(path, colour) {
    const found = named(path);
    const places = found.map(({ index }) => path.placeOf(index));
    const { x, y } = this.placesOf(path);
    return {
      x: places.map(x), y: places.map(y),
      text: found.map(({ name }) => name), customdata: found.map(({ index }) => index),
      meta: found.map(({ kind }) => kind), type: "scatter", mode: "markers+text", textposition: "top center",
      hovertext: found.map((point) => `${point.name}: ${pointWords(point)}${point.event ? `, ${verbatim(point.event)}` : ""}`),
      hovertemplate: "%{hovertext}<br>%{x:.5g}, %{y:.5g}<extra></extra>",
      marker: {
        size: 9, color: fromSheet("--panel"), line: { color: colour, width: 2 },
        symbol: found.map(({ kind, bifurcation }) =>
          bifurcation ? "diamond" : kind === "contact_change" ? "square" : "circle"),
      },
      textfont: { color: colour, size: 14 }, cliponaxis: false,
    };
  }

  /** The exact solution of the first path, drawn over all paths. */
  exact() {
    const [path] = this.paths;
    const of = ofDisplacement(this.axes.abscissa);
    const found = path?.exact?.path;
    if (!found || !of || this.axes.ordinate !== "load_factor") return null;
    const [x, y] = [[], []];
    for (const stage of found.stages) {
      x.push(...(stage.displacements[of.node]?.[of.component] ?? []), null);
      y.push(...stage.load_factor, null);
    }
    return {
      x, y, type: "scatter", mode: "lines", name: "exact", hoverinfo: "skip",
      line: { color: fromSheet("--text"), width: 1, dash: "dash" },
    };
  }

  mark() {
    const path = this.paths[0];
    const place = path ? path.placeOf(this.at ?? path.last()) : -1;
    return place < 0 ? { x: [], y: [] } : { x: [this.abscissaOf(path)[place]], y: [this.ordinateOf(path)[place]] };
  }

  restyleMark(more) {
    if (!this.isDrawn() || this.paths.length === 0) return;
    const { x, y } = this.mark();
    Plotly.restyle(this.place, { x: [x], y: [y], ...more }, [this.paths.length * OF_A_JOB]);
  }

  /** The chosen increment has changed. */
  choose(at) {
    this.at = at;
    this.restyleMark({});
  }

  /** Highlights the marker of the increment that the structure shows. */
  pointAt(isPointedAt) {
    this.restyleMark({ "marker.size": isPointedAt ? MARK.pointedAt : MARK.plain });
  }

  /** A path has grown: it is drawn in the next frame, but only in as many frames as leave time for the rest of the page. */
  grow() {
    if (this.waits) return;
    this.waits = true;
    requestAnimationFrame(async () => {
      const began = performance.now();
      await this.extend();
      const took = performance.now() - began;
      setTimeout(() => {
        this.waits = false;
        if (this.paths.some((path, place) => path.index.length > this.drawn[place])) this.grow();
      }, took * (1 / SHARE - 1));
    });
  }

  async extend() {
    const isOther = (path, place) => mode(path) !== this.place.data?.[place * OF_A_JOB]?.mode
      || named(path).length !== this.drawnPoints[place];
    if (this.paths.some(isOther)) {
      await this.draw(this.paths, this.axes, this.at);
      return;
    }
    const update = { x: [], y: [], customdata: [] };
    const traces = [];
    this.paths.forEach((path, place) => {
      const from = this.drawn[place];
      if (path.index.length <= from) return;
      const more = this.line(path, from);
      for (const member of Object.keys(update)) update[member].push(more[member]);
      traces.push(place * OF_A_JOB);
      this.drawn[place] = path.index.length;
    });
    if (traces.length === 0) return;
    if (this.at === null) Object.assign(this.place.data[this.paths.length * OF_A_JOB], this.mark());
    await Plotly.extendTraces(this.place, update, traces);
  }

  /** Replaces the choice of axes only if the choices change, so that it keeps the focus while a path grows. */
  controls() {
    const path = this.paths[0];
    if (!path) return;
    const { abscissa, ordinate } = this.axes;
    const key = `${path.id} ${abscissa} ${ordinate}`;
    if (this.choices.dataset.of !== key) {
      this.choices.dataset.of = key;
      axesControls(this.choices, path.request, this.axes, (axes) => this.told.axes(axes));
    }
    const lacks = (one) => (!one.has(abscissa) ? abscissaWords(abscissa) : !one.has(ordinate) ? ordinateWords(ordinate) : null);
    pathLegend(this.legend, this.paths, this.looks, lacks, this.exact() ? path.exact.path : null);
  }
}

const mode = (path) => (path.index.length <= MARKED ? "lines+markers" : "lines");
