// The Plotly traces of the picture of a structure, one for all parts with the same style.

import { fromSheet } from "./plot-style.js";
import { short, verbatim } from "./words.js";

/** From this number on nodes are drawn small. */
const MANY = 200;

export class StructureTraces {
  /** `flat` projects a position onto the picture. */
  constructor(flat) {
    this.flat = flat;
    this.all = [];
    this.byName = new Map();
  }

  trace(name, make) {
    if (!this.byName.has(name)) {
      const made = { x: [], y: [], text: [], name, type: "scatter", hoverinfo: "text", ...make() };
      this.byName.set(name, made);
      this.all.push(made);
    }
    return this.byName.get(name);
  }

  add(trace, places, words = "") {
    const said = verbatim(words);
    for (const place of places) {
      const [x, y] = this.flat(place);
      trace.x.push(x);
      trace.y.push(y);
      trace.text.push(said);
    }
  }

  interrupt(trace) {
    trace.x.push(null);
    trace.y.push(null);
    trace.text.push("");
  }

  lines(name, pieces, line, words) {
    const trace = this.trace(name, () => ({ mode: "lines", line, ...(words ? {} : { hoverinfo: "skip" }) }));
    for (const piece of pieces) {
      this.add(trace, piece, words);
      this.interrupt(trace);
    }
  }

  area(outline) {
    const trace = this.trace(`area ${this.all.length}`, () => ({
      mode: "lines", line: { width: 0 }, fill: "toself", fillcolor: fromSheet("--ground"), hoverinfo: "skip",
    }));
    this.add(trace, outline);
  }

  arrow(name, from, to, color) {
    const trace = this.trace(name, () => ({
      mode: "lines+markers", line: { color, width: 2 }, hoverinfo: "skip",
      marker: { symbol: "arrow", angleref: "previous", size: [], color },
    }));
    this.add(trace, [from, to]);
    this.interrupt(trace);
    trace.marker.size.push(0, 12, 0);
  }

  marker(name, place, marker, words) {
    const trace = this.trace(name, () => ({
      mode: "markers", marker: { size: 11, line: { width: 2, color: marker.color }, ...marker },
    }));
    this.add(trace, [place], words);
  }

  nodes(now, supports) {
    const node = this.trace("node", () => ({
      mode: "markers", marker: { color: fromSheet("--text"), size: now.size > MANY ? 3 : 5 },
    }));
    for (const [name, place] of now) this.add(node, [place], `${name} (${place.map(short).join(", ")})`);
    const held = this.trace("support", () => ({
      mode: "markers", hoverinfo: "skip",
      marker: { symbol: "triangle-up-open", size: 13, color: fromSheet("--text"), line: { width: 1.5 } },
    }));
    for (const name of Object.keys(supports)) if (now.has(name)) this.add(held, [now.get(name)]);
  }
}
