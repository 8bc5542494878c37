// Recorded quantities of one job or several against one another: lines that grow while they stream, points at which something
// happens, the chosen increment.

import { choice, element, fill } from "./dom.js";
import { plotButtons } from "./downloads.js";
import { placeLetters } from "./letter-places.js";
import { axesControls, axisWords, isOnFirstAxis } from "./path-axes.js";
import { Curve } from "./path-curve.js";
import { curveNames, lineKey, namedPoints, pathLegend } from "./path-legend.js";
import { PathLooks } from "./path-names.js";
import { exactTrace, pathWords } from "./path-words.js";
import { axis, CONFIGURATION, fromSheet, layout } from "./plot-style.js";
import { named } from "./points.js";
import { SweepColours } from "./sweep-colours.js";

/** Up to this number of increments each has a marker. */
export const MARKED = 400;
/** Up to this number of curves the points of each have letters. */
const LETTERED = 4;
/** The largest part of the time that is spent on drawing. */
const SHARE = 0.25;
/** Traces of a curve that come first: its points for the pointer, those at which something happens. */
const OF_A_CURVE = 2;
const MARK = { plain: 13, pointedAt: 22 };

export class PathPlot {
  /** Tells `chosen(id, index)`, `hovered(id, index)`, `left()`, `axes({abscissa} or {ordinate})` and `failed(words)`. */
  constructor(panel, told) {
    this.told = told;
    this.choices = element("div", { class: "choices", id: "path-choices" });
    this.colouring = element("div", { class: "choices" });
    this.place = element("div", { class: "plot", id: "path-plot" });
    this.legend = element("ul", { class: "legend" });
    this.key = element("ul", { class: "key", id: "path-key", "aria-label": "lines and marks" });
    this.words = element("p", { class: "quiet", id: "path-words" });
    this.list = element("ol", { class: "named", "aria-label": "named points" });
    const drawn = () => (this.curves.length ? { place: this.place, curves: this.curves, runs: this.runs } : null);
    fill(panel, element("h2", {}, "Path"), this.choices, this.colouring, this.place, this.legend, this.key, this.words,
      plotButtons(drawn, told.failed), this.list);
    this.paths = [];
    this.curves = [];
    /** The sweep of which all paths are runs, or null. */
    this.sweep = null;
    this.looks = new PathLooks();
    this.revision = 0;
    this.drawn = [];
    this.waits = false;
    this.listens = false;
  }

  /** Draws axes without a path while it is being loaded. */
  async prepare() {
    this.paths = [];
    this.curves = [];
    for (const place of [this.legend, this.key, this.list, this.words]) fill(place);
    await Plotly.react(this.place, [], layout({ xaxis: axis(""), yaxis: axis("") }), CONFIGURATION);
  }

  /** Draws everything anew; `axes`: names of the abscissa and of the ordinates. */
  async draw(paths, axes, at) {
    this.follow(paths, axes);
    this.at = at;
    this.curves = this.made();
    const traces = this.curves.flatMap((curve) => [curve.base(), curve.points(this.curves.length <= LETTERED)]);
    if (this.curves.length <= LETTERED) {
      placeLetters(traces.filter((_, place) => place % OF_A_CURVE === 0), traces.filter((_, place) => place % OF_A_CURVE === 1), this.place);
    }
    this.drawn = this.curves.map(({ path }) => path.index.length);
    this.drawnPoints = this.curves.map(({ path }) => named(path).length);
    this.isMarked = this.curves.map((curve) => this.hasMarkers(curve));
    traces.push({
      ...this.mark(), type: "scatter", mode: "markers", hoverinfo: "skip", name: "chosen increment", zorder: 5, showlegend: false,
      yaxis: this.curves[0].yaxis,
      marker: { size: MARK.plain, symbol: "circle-open", color: fromSheet("--text"), line: { width: 2 } },
    });
    const exact = exactTrace(this.curves);
    if (exact) traces.push(exact);
    this.strandPlaces = this.curves.map((curve, which) => {
      const places = new Map();
      for (const [key, piece] of curve.strands.grow(0)) {
        places.set(key, traces.push(curve.strands.trace(key, piece, this.isMarked[which])) - 1);
      }
      return places;
    });
    if (this.runs?.isScale) traces.push(this.runs.bar());
    this.controls(exact);
    await Plotly.react(this.place, traces, this.layout(), CONFIGURATION);
    this.listen();
    const names = curveNames(this.curves, this.runs);
    // Of the paths whose points have letters, or of the first one.
    const listed = this.curves.length <= LETTERED ? paths : paths.slice(0, 1);
    namedPoints(this.list, listed.map((path) => {
      const whose = paths.length > 1 ? names[this.curves.findIndex((curve) => curve.path === path)] : null;
      return { path, whose, choose: (index) => this.told.chosen(path.id, index) };
    }));
  }

  /** The curves: each ordinate of each path. */
  made() {
    const { paths, axes } = this;
    this.runs = this.sweep && !this.sweep.problem && axes.ordinates.length === 1 ? new SweepColours(this.sweep, paths) : null;
    this.runs?.by(this.colouredBy);
    const isAlone = paths.length * axes.ordinates.length === 1;
    this.keep(paths.map(({ id }) => id));
    return paths.flatMap((path) => axes.ordinates.map((ordinate, place) => new Curve(path, axes.abscissa, ordinate, {
      look: this.runs?.isScale ? this.runs.look(path) : this.looks.of(keyOf(path.id, ordinate, place)),
      isFirstAxis: isOnFirstAxis(ordinate, axes.ordinates), isAlone,
    })));
  }

  layout() {
    const { abscissa, ordinates } = this.axes;
    const { request } = this.paths[0];
    const right = ordinates.filter((name) => !isOnFirstAxis(name, ordinates));
    return layout({
      xaxis: axis(axisWords([abscissa], request)),
      yaxis: axis(axisWords(ordinates.filter((name) => isOnFirstAxis(name, ordinates)), request)), uirevision: this.revision,
      ...(right.length ? { yaxis2: { ...axis(axisWords(right, request)), overlaying: "y", side: "right", showgrid: false } } : {}),
      ...(this.runs?.isScale ? { margin: { l: 56, r: 12, t: 84, b: 44 } } : {}),
    });
  }

  hasMarkers({ path }) {
    return path.index.length <= MARKED && this.curves.length <= LETTERED;
  }

  /** The zoom is kept as long as one of the drawn paths and the axes remain. */
  follow(paths, axes) {
    const stays = this.axes?.abscissa === axes.abscissa && this.axes?.ordinates.join() === axes.ordinates.join()
      && paths.some(({ id }) => this.paths.some((before) => before.id === id));
    if (!stays) this.revision++;
    this.paths = paths;
    this.axes = axes;
  }

  /** Sets the jobs that are drawn from now on; each keeps its style as long as it is among them. */
  keep(ids) {
    const ordinates = this.axes?.ordinates ?? [""];
    this.looks.keep(ids.flatMap((id) => ordinates.map((ordinate, place) => keyOf(id, ordinate, place))));
  }

  isDrawn() {
    return this.place.classList.contains("js-plotly-plot");
  }

  listen() {
    if (this.listens) return;
    this.listens = true;
    const where = ({ points }) => {
      const { curveNumber, customdata } = points[0] ?? {};
      const path = this.curves[Math.floor(curveNumber / OF_A_CURVE)]?.path;
      return path && Number.isInteger(customdata) ? [path.id, customdata] : null;
    };
    this.place.on("plotly_click", (event) => { const found = where(event); if (found) this.told.chosen(...found); });
    this.place.on("plotly_hover", (event) => { const found = where(event); if (found) this.told.hovered(...found); });
    this.place.on("plotly_unhover", () => this.told.left());
  }

  /** The chosen increment, on the first curve. */
  mark() {
    const [curve] = this.curves;
    const place = curve ? curve.path.placeOf(this.at ?? curve.path.last()) : -1;
    return place < 0 ? { x: [], y: [] } : { x: [curve.x(place)], y: [curve.y(place)] };
  }

  restyleMark(more) {
    if (!this.isDrawn() || this.curves.length === 0) return;
    const { x, y } = this.mark();
    Plotly.restyle(this.place, { x: [x], y: [y], ...more }, [this.curves.length * OF_A_CURVE]);
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
        if (this.curves.some(({ path }, place) => path.index.length > this.drawn[place])) this.grow();
      }, took * (1 / SHARE - 1));
    });
  }

  async extend() {
    const isOther = (curve, place) => this.hasMarkers(curve) !== this.isMarked[place]
      || named(curve.path).length !== this.drawnPoints[place];
    const update = { x: [], y: [], customdata: [] };
    const traces = [];
    const extend = (piece, trace) => {
      for (const member of Object.keys(update)) update[member].push(piece[member]);
      traces.push(trace);
    };
    let isNew = this.curves.some(isOther);
    if (!isNew) {
      this.curves.forEach((curve, which) => {
        const from = this.drawn[which];
        if (curve.path.index.length <= from) return;
        extend(curve.line(from), which * OF_A_CURVE);
        for (const [key, piece] of curve.strands.grow(from)) {
          const trace = this.strandPlaces[which].get(key);
          if (trace === undefined) isNew = true;
          else extend(piece, trace);
        }
        this.drawn[which] = curve.path.index.length;
      });
    }
    if (isNew) {
      await this.draw(this.paths, this.axes, this.at);
      return;
    }
    if (traces.length === 0) return;
    if (this.at === null) Object.assign(this.place.data[this.curves.length * OF_A_CURVE], this.mark());
    await Plotly.extendTraces(this.place, update, traces);
  }

  /** Replaces the choice of axes only if the choices change, so that it keeps the focus while a path grows. */
  controls(exact) {
    const [path] = this.paths;
    const { abscissa, ordinates } = this.axes;
    const key = `${path.id} ${abscissa} ${ordinates}`;
    if (this.choices.dataset.of !== key) {
      this.choices.dataset.of = key;
      axesControls(this.choices, path.request, this.axes, (axes) => this.told.axes(axes));
    }
    pathLegend(this.legend, this.curves, this.runs, exact ? path.exact.path : null);
    lineKey(this.key, this.curves);
    this.words.textContent = pathWords({ curves: this.curves, sweep: this.sweep, runs: this.runs, marked: MARKED, lettered: LETTERED });
    const many = this.runs?.choices.length ?? 0;
    fill(this.colouring, many < 2 ? null : element("label", {}, "Colour by ", choice({
      id: "colour-by", "data-key": "colour-by",
      onchange: (event) => { this.colouredBy = Number(event.target.value); this.draw(this.paths, this.axes, this.at); },
    }, this.runs.choices.map((place) => [String(place), this.runs.names[place]]), String(this.runs.place))));
  }
}

/** What a style is kept for: the first quantity of a path, whichever it is, or another. */
const keyOf = (id, ordinate, place) => (place === 0 ? id : `${id} ${ordinate}`);
