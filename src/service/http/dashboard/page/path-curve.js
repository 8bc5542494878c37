// One curve in the plot of paths: a quantity of one path against another.

import { Strands } from "./path-strands.js";
import { fromSheet } from "./plot-style.js";
import { named } from "./points.js";
import { pointWords, verbatim } from "./words.js";

/** Colour, symbol and filling of the kinds of points, as in the picture of `arcslip solve --plot`; a colour is a name in the style
 *  sheet. */
export const MARKS = {
  smooth_limit: ["--limit", "circle", "--limit"], nonsmooth_limit: ["--nonsmooth", "diamond", "--nonsmooth"],
  contact_change: ["--text", "circle", "--panel"], end: ["--text", "square", "--text"],
  jump: ["--text", "triangle-up", "--text"], bifurcation: ["--bifurcation", "diamond", "--panel"],
};

export class Curve {
  /** `look`: its `{colour, dash}`; `isFirstAxis`: the ordinate is on the axis on the left. */
  constructor(path, abscissa, ordinate, { look, isFirstAxis, isAlone }) {
    this.path = path;
    this.abscissa = abscissa;
    this.ordinate = ordinate;
    this.colour = look.colour;
    this.dash = look.dash;
    this.yaxis = isFirstAxis ? "y" : "y2";
    this.xs = path.columns.get(abscissa) ?? [];
    this.ys = path.columns.get(ordinate) ?? [];
    this.strands = new Strands(this, isAlone);
  }

  x(place) {
    return this.xs[place] ?? null;
  }

  /** A point without an abscissa is left out and does not affect the range of the ordinate. */
  y(place) {
    return this.x(place) === null ? null : this.ys[place] ?? null;
  }

  /** The column of which the path has no values, or null. */
  lacks() {
    return [this.abscissa, this.ordinate].find((name) => !this.path.has(name)) ?? null;
  }

  /** The points from an increment on. The load factor starts again with each stage, where the line is interrupted. */
  line(from) {
    const { path } = this;
    const line = { x: [], y: [], customdata: [] };
    const stages = path.columns.get("stage");
    for (let place = from; place < path.index.length; place++) {
      if (place > 0 && stages[place] !== stages[place - 1]) for (const part of Object.values(line)) part.push(null);
      line.x.push(this.x(place));
      line.y.push(this.y(place));
      line.customdata.push(path.index[place]);
    }
    return line;
  }

  /** All points, for the pointer: what is seen of them are the strands. */
  base() {
    return {
      ...this.line(0), type: "scatter", mode: "none", yaxis: this.yaxis, showlegend: false,
      line: { color: this.colour, width: 2, dash: this.dash }, marker: { color: this.colour, size: 4 },
      hovertemplate: "%{x:.5g}, %{y:.5g}<br>increment %{customdata}<extra></extra>",
    };
  }

  /** The points at which something happens, with their letters where these have room. */
  points(hasLetters) {
    const found = named(this.path);
    const places = found.map(({ index }) => this.path.placeOf(index));
    const colours = (of) => found.map(({ kind }) => fromSheet(MARKS[kind][of]));
    return {
      x: places.map((place) => this.x(place)), y: places.map((place) => this.y(place)), yaxis: this.yaxis,
      text: found.map(({ name }) => name), customdata: found.map(({ index }) => index),
      meta: found.map(({ kind }) => kind), type: "scatter", mode: hasLetters ? "markers+text" : "markers",
      textposition: "top center", showlegend: false, zorder: 4,
      hovertext: found.map((point) =>
        `${point.name ? `${point.name}: ` : ""}${pointWords(point)}${point.event ? `, ${verbatim(point.event)}` : ""}`),
      hovertemplate: "%{hovertext}<br>%{x:.5g}, %{y:.5g}<extra></extra>",
      marker: {
        size: 9, color: colours(2), line: { color: colours(0), width: 1.5 },
        symbol: found.map(({ kind }) => MARKS[kind][1]),
      },
      // Each path has letters of its own.
      textfont: { color: this.strands.isAlone ? fromSheet("--text") : this.colour, size: 14 }, cliponaxis: false,
    };
  }
}
