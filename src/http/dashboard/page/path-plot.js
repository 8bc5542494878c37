// Load, or an energy, against a displacement, of one job or several: lines that grow while they stream, named points, the
// chosen increment.

import { choice, element, fill } from "./dom.js";
import { ORDINATES } from "./path-data.js";
import { axis, colourOf, CONFIGURATION, fromSheet, layout } from "./plot-style.js";
import { named } from "./points.js";
import { differences, pointWords, short, verbatim } from "./words.js";

/** Markers at every increment up to so many. */
const MARKED = 400;
/** A frame's drawing may take this part of the time. */
const SHARE = 0.25;
/** Traces of a job: its line, its named points. */
const OF_A_JOB = 2;
/** Named points in the list below the plot. */
const LISTED = 60;
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
    this.drawn = [];
    this.waits = false;
    this.listens = false;
  }

  /** Axes without a path, as long as that is on its way. */
  async prepare() {
    this.paths = [];
    fill(this.legend);
    fill(this.list);
    await Plotly.react(this.place, [], layout({ xaxis: axis(""), yaxis: axis("") }), CONFIGURATION);
  }

  /** Draws everything anew; `axes`: names of the abscissa and of the ordinate. */
  async draw(paths, axes, at) {
    this.paths = paths;
    this.axes = axes;
    this.at = at;
    this.controls();
    const traces = paths.flatMap((path, place) => {
      const colour = colourOf(place);
      return [
        {
          ...this.line(path, 0), type: "scatter", mode: mode(path), line: { color: colour, width: 2 },
          marker: { color: colour, size: 4 }, hovertemplate: "%{x:.5g}, %{y:.5g}<br>increment %{customdata}<extra></extra>",
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
    const words = (known, name) => known.find(([one]) => one === name)?.[1] ?? name;
    const kind = axes.abscissa.startsWith("/displacements/") ? "displacement " : "";
    await Plotly.react(this.place, traces, layout({
      xaxis: axis(`${kind}${words(paths[0].abscissae(), axes.abscissa)}`), yaxis: axis(words(ORDINATES, axes.ordinate)),
      uirevision: `${paths.map(({ id }) => id)} ${axes.abscissa} ${axes.ordinate}`,
    }), CONFIGURATION);
    this.listen();
    this.names();
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

  /** From this increment on; where a stage begins the load factor does so, too, and the line is broken. */
  line(path, from) {
    const line = { x: [], y: [], customdata: [] };
    const [abscissa, ordinate] = [this.abscissaOf(path), this.ordinateOf(path)];
    const stages = path.columns.get("stage");
    for (let place = from; place < path.index.length; place++) {
      if (place > 0 && stages[place] !== stages[place - 1]) for (const part of Object.values(line)) part.push(null);
      line.x.push(abscissa[place]);
      line.y.push(ordinate[place]);
      line.customdata.push(path.index[place]);
    }
    return line;
  }

  points(path, colour) {
    const found = named(path);
    const places = found.map(({ index }) => path.placeOf(index));
    const [abscissa, ordinate] = [this.abscissaOf(path), this.ordinateOf(path)];
    return {
      x: places.map((place) => abscissa[place]), y: places.map((place) => ordinate[place]),
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

  /** The first path in closed form, laid over all. */
  exact() {
    const [path] = this.paths;
    const steps = this.axes.abscissa.split("/");
    const found = path?.exact?.path;
    if (!found || steps[1] !== "displacements" || this.axes.ordinate !== "load_factor") return null;
    const node = steps[2].replaceAll("~2", ",").replaceAll("~1", "/").replaceAll("~0", "~");
    const [x, y] = [[], []];
    for (const stage of found.stages) {
      x.push(...(stage.displacements[node]?.[Number(steps[3])] ?? []), null);
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

  /** The structure that is looked at belongs to the marked increment. */
  pointAt(isPointedAt) {
    this.restyleMark({ "marker.size": isPointedAt ? MARK.pointedAt : MARK.plain });
  }

  /** More has come of a path: drawn in the next frame, and in no more frames than leave time for the rest of the page. */
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

  /** The choice of axes is made anew only where others can be chosen, so that focus stays on it while a path grows. */
  controls() {
    const path = this.paths[0];
    if (!path) return;
    const { abscissa, ordinate } = this.axes;
    const key = `${path.id} ${abscissa} ${ordinate}`;
    if (this.choices.dataset.of !== key) {
      this.choices.dataset.of = key;
      fill(this.choices,
        element("label", {}, "Plot ", choice({
          id: "ordinate", "data-key": "ordinate", onchange: (event) => this.told.axes({ ordinate: event.target.value }),
        }, ORDINATES, ordinate)),
        element("label", {}, "against ", choice({
          id: "abscissa", "data-key": "abscissa", onchange: (event) => this.told.axes({ abscissa: event.target.value }),
        }, path.abscissae(), abscissa)));
    }
    const several = this.paths.length > 1;
    const apart = differences(this.paths.map(({ request }) => request));
    fill(this.legend, several ? this.paths.map(({ job }, place) =>
      element("li", {}, element("span", { class: "swatch", style: `background:${colourOf(place)}` }), job.name,
        apart[place] ? `, ${apart[place]}` : "",
        job.parent ? ` from increment ${job.parent.increment}, direction ${job.parent.direction}` : "")) : [],
    path.exact?.path && this.exact() ? element("li", { title: path.exact.path.formula },
      element("span", { class: "swatch dashed" }), `exact (${path.exact.path.name})`) : null);
  }

  names() {
    const [path] = this.paths;
    if (!path) return;
    const found = named(path);
    const loads = path.columns.get("load_factor");
    fill(this.list, found.slice(0, LISTED).map((point) => element("li", {},
      element("button", {
        type: "button", class: "plain", "data-key": point.name, onclick: () => this.told.chosen(path.id, point.index),
      }, element("b", {}, point.name), ` ${pointWords(point)} at load ${short(loads[path.placeOf(point.index)])}`,
      point.event ? `: ${point.event}` : ""))),
    found.length > LISTED ? element("li", {}, `and ${found.length - LISTED} more`) : null);
  }
}

const mode = (path) => (path.index.length <= MARKED ? "lines+markers" : "lines");
