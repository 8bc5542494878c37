// Load against a displacement, of one job or several: lines that grow while they stream, named points, the chosen increment.

import { choice, element, fill } from "./dom.js";
import { axis, colourOf, CONFIGURATION, fromSheet, layout } from "./plot-style.js";
import { named } from "./points.js";
import { pointWords, short } from "./words.js";

/** Markers at every increment up to so many. */
const MARKED = 400;
/** A frame's drawing may take this part of the time. */
const SHARE = 0.25;
/** Traces of a job: its line, its named points. */
const OF_A_JOB = 2;

export class PathPlot {
  /** Tells `chosen(id, index)`, `hovered(id, index)`, `left()` and `abscissa(name)`. */
  constructor(panel, told) {
    this.told = told;
    this.choices = element("div", { class: "choices" });
    this.place = element("div", { class: "plot", id: "path-plot" });
    this.legend = element("ul", { class: "legend" });
    this.list = element("ol", { class: "named" });
    fill(panel, element("h2", {}, "Path"), this.choices, this.place, this.legend, this.list);
    this.paths = [];
    this.drawn = [];
    this.waits = false;
  }

  /** Draws everything anew. */
  async draw(paths, abscissa, at) {
    this.paths = paths;
    this.abscissa = abscissa;
    this.at = at;
    this.controls();
    const traces = paths.flatMap((path, place) => {
      const line = this.line(path, 0);
      const colour = colourOf(place);
      return [
        {
          ...line, type: "scatter", mode: path.index.length <= MARKED ? "lines+markers" : "lines",
          line: { color: colour, width: 2 }, marker: { color: colour, size: 4 },
          hovertemplate: `%{x:.5g}, %{y:.5g}<br>increment %{customdata}<extra></extra>`,
        },
        this.points(path, colour),
      ];
    });
    this.drawn = paths.map((path) => path.index.length);
    const exact = this.exact();
    traces.push({
      ...this.mark(), type: "scatter", mode: "markers", hoverinfo: "skip",
      marker: { size: 13, symbol: "circle-open", color: fromSheet("--text"), line: { width: 2 } },
    });
    if (exact) traces.push(exact);
    const words = paths[0]?.abscissae().find(([name]) => name === abscissa)?.[1] ?? abscissa;
    const isNew = !this.place.classList.contains("js-plotly-plot");
    await Plotly.react(this.place, traces, layout({
      xaxis: axis(words), yaxis: axis("load factor"), uirevision: `${paths.map(({ id }) => id)} ${abscissa}`,
    }), CONFIGURATION);
    if (isNew) this.listen();
    this.names();
  }

  listen() {
    const where = ({ points }) => {
      const { curveNumber, customdata } = points[0] ?? {};
      const path = this.paths[Math.floor(curveNumber / OF_A_JOB)];
      return path && Number.isInteger(customdata) ? [path.id, customdata] : null;
    };
    this.place.on("plotly_click", (event) => { const found = where(event); if (found) this.told.chosen(...found); });
    this.place.on("plotly_hover", (event) => { const found = where(event); if (found) this.told.hovered(...found); });
    this.place.on("plotly_unhover", () => this.told.left());
  }

  /** From this increment on; where a stage begins the load factor does so, too, and the line is broken. */
  line(path, from) {
    const x = [];
    const y = [];
    const customdata = [];
    const abscissa = path.columns.get(this.abscissa) ?? [];
    const loads = path.columns.get("load_factor");
    const stages = path.columns.get("stage");
    for (let place = from; place < path.index.length; place++) {
      if (place > 0 && stages[place] !== stages[place - 1]) {
        x.push(null);
        y.push(null);
        customdata.push(null);
      }
      x.push(abscissa[place]);
      y.push(loads[place]);
      customdata.push(path.index[place]);
    }
    return { x, y, customdata };
  }

  points(path, colour) {
    const found = named(path);
    const abscissa = path.columns.get(this.abscissa) ?? [];
    const loads = path.columns.get("load_factor");
    return {
      x: found.map(({ index }) => abscissa[path.placeOf(index)]), y: found.map(({ index }) => loads[path.placeOf(index)]),
      text: found.map(({ name }) => name), customdata: found.map(({ index }) => index),
      meta: found.map(({ kind }) => kind), type: "scatter", mode: "markers+text", textposition: "top center",
      hovertext: found.map((point) => `${point.name}: ${pointWords(point)}${point.event ? `, ${point.event}` : ""}`),
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
    const steps = this.abscissa.split("/");
    const found = path?.exact?.path;
    if (!found || steps[1] !== "displacements") return null;
    const node = steps[2].replaceAll("~2", ",").replaceAll("~1", "/").replaceAll("~0", "~");
    const x = [];
    const y = [];
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
    if (place < 0) return { x: [], y: [] };
    return { x: [path.columns.get(this.abscissa)?.[place]], y: [path.columns.get("load_factor")[place]] };
  }

  /** The chosen increment has changed. */
  choose(at) {
    this.at = at;
    if (!this.place.classList.contains("js-plotly-plot")) return;
    const { x, y } = this.mark();
    Plotly.restyle(this.place, { x: [x], y: [y] }, [this.paths.length * OF_A_JOB]);
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
    const update = { x: [], y: [], customdata: [] };
    const traces = [];
    let hasNewPoints = false;
    this.paths.forEach((path, place) => {
      const from = this.drawn[place];
      if (path.index.length <= from) return;
      const more = this.line(path, from);
      for (const member of Object.keys(update)) update[member].push(more[member]);
      traces.push(place * OF_A_JOB);
      if ((path.points.at(-1)?.index ?? -1) >= path.index[from]) hasNewPoints = true;
      this.drawn[place] = path.index.length;
    });
    if (traces.length === 0) return;
    if (hasNewPoints || this.paths.some((path) => path.index.length > MARKED)) {
      await this.draw(this.paths, this.abscissa, this.at);
      return;
    }
    await Plotly.extendTraces(this.place, update, traces);
    if (this.at === null) this.choose(null);
  }

  controls() {
    const path = this.paths[0];
    if (!path) return;
    const shown = path.abscissae();
    fill(this.choices, element("label", {}, "Load against ",
      choice({ id: "abscissa", onchange: (event) => this.told.abscissa(event.target.value) }, shown, this.abscissa)));
    const several = this.paths.length > 1;
    fill(this.legend, several ? this.paths.map(({ job }, place) =>
      element("li", {}, element("span", { class: "swatch", style: `background:${colourOf(place)}` }), job.name,
        job.parent ? ` from increment ${job.parent.increment}, direction ${job.parent.direction}` : "")) : [],
    path.exact?.path ? element("li", { title: path.exact.path.formula },
      element("span", { class: "swatch dashed" }), `exact (${path.exact.path.name})`) : null);
  }

  names() {
    const [path] = this.paths;
    if (!path) return;
    const found = named(path);
    const loads = path.columns.get("load_factor");
    fill(this.list, found.slice(0, 60).map((point) => element("li", {},
      element("button", { type: "button", class: "plain", onclick: () => this.told.chosen(path.id, point.index) },
        element("b", {}, point.name), ` ${pointWords(point)} at load ${short(loads[path.placeOf(point.index)])}`,
        point.event ? `: ${point.event}` : ""))),
    found.length > 60 ? element("li", {}, `and ${found.length - 60} more`) : null);
  }
}
