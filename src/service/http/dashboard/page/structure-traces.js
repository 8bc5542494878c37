// The Plotly traces of the picture of a structure, one for all parts with the same style.

import { verbatim } from "./words.js";

/** Places of an element, between its ends, at which its values are shown by hovering; fewer where there are very many. */
const ALONG = { few: [0.25, 0.5, 0.75], many: [0.5] };

/** Lines of text, each escaped. */
const said = (words) => [words].flat().filter(Boolean).map(verbatim).join("<br>");

export class StructureTraces {
  /** `flat` projects a position onto the picture; `isLarge`: there are very many of them. */
  constructor(flat, isLarge) {
    this.flat = flat;
    this.along = isLarge ? ALONG.many : ALONG.few;
    this.all = [];
    this.byName = new Map();
    /** The positions of all that has been drawn. */
    this.reach = [];
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
    const text = said(words);
    for (const place of places) {
      const [x, y] = this.flat(place);
      trace.x.push(x);
      trace.y.push(y);
      trace.text.push(text);
      this.reach.push(place);
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

  /** The line of an element, whose values are shown between its ends, as nodes have theirs at them. */
  element(name, line, style, words) {
    const trace = this.trace(name, () => ({ mode: "lines", line: style, hoverinfo: "skip" }));
    this.add(trace, line, words);
    this.interrupt(trace);
    for (const part of this.along) {
      const at = part * (line.length - 1);
      const [from, to] = [line[Math.floor(at)], line[Math.ceil(at)]];
      const rest = at - Math.floor(at);
      this.unmarked("element values", from.map((value, axis) => value + rest * (to[axis] - value)), words);
    }
  }

  /** An outline, filled; all of one name are one trace. */
  filled(name, outline, color) {
    const trace = this.trace(name, () => ({
      mode: "lines", line: { color, width: 1 }, fill: "toself", fillcolor: `${color}33`, hoverinfo: "skip",
    }));
    this.add(trace, outline);
    this.interrupt(trace);
  }

  /** A body in the plane, filled, its edge darker; all of one name are one trace. */
  body(name, outline, color, edge) {
    const trace = this.trace(name, () => ({
      mode: "lines", line: { color: edge, width: 0.7 }, fill: "toself", fillcolor: color, hoverinfo: "skip",
    }));
    this.add(trace, outline);
    this.interrupt(trace);
  }

  /** A position with values but without a mark. */
  unmarked(name, place, words) {
    const trace = this.trace(name, () => ({ mode: "lines", line: { width: 0 } }));
    this.add(trace, [place], words);
    this.interrupt(trace);
  }

  area(outline, fillcolor) {
    const trace = this.trace(`area ${this.all.length}`, () => ({
      mode: "lines", line: { width: 0 }, fill: "toself", fillcolor, hoverinfo: "skip",
    }));
    this.add(trace, outline);
  }

  /** An arrow; its values, if there are any, are shown at that end which is not at a node. */
  arrow(name, from, to, color, { words = "", isAtHead = false } = {}) {
    const trace = this.trace(name, () => ({
      mode: "lines+markers", line: { color, width: 2 }, hoverinfo: "skip",
      marker: { symbol: "arrow", angleref: "previous", size: [], color },
    }));
    this.add(trace, [from, to], words);
    this.interrupt(trace);
    if (words) this.unmarked("arrow values", isAtHead ? to : from, words);
    trace.marker.size.push(0, 12, 0);
  }

  marker(name, place, marker, words) {
    const trace = this.trace(name, () => ({
      mode: "markers", marker: { size: 11, line: { width: 2, color: marker.color }, ...marker },
      ...(words ? {} : { hoverinfo: "skip" }),
    }));
    this.add(trace, [place], words);
  }

  names(places, color) {
    this.labels("node name", places, color);
  }

  /** Words beside places. */
  labels(name, places, color) {
    const trace = this.trace(name, () => ({
      mode: "text", textposition: "top right", textfont: { size: 12, color }, hoverinfo: "skip", cliponaxis: false,
    }));
    for (const [words, place] of places) this.add(trace, [place], words);
  }
}
