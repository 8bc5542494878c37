// Colours of the runs of a sweep when their paths are drawn together: a sequential scale over a value that is swept, and dashes
// for the sets of the other values.

import { get } from "./api.js";
import { dashAt, isDark } from "./plot-style.js";
import { parameterNames, runWords, valuesOf } from "./sweep-values.js";

/** Viridis, without the end that the background is like. */
const LIGHT = ["#440154", "#414487", "#2a788e", "#22a884", "#7ad151"];
const DARK = ["#5a62b8", "#2f87a0", "#22a884", "#7ad151", "#fde725"];
/** At most this many values have a tick each, this part of the scale apart. */
const [TICKS, APART] = [12, 0.09];

const read = new Map();

/** The sweep whose runs all of these paths are; null where they are not of one, or it cannot be read. */
export async function sweepOf(paths) {
  const ids = new Set(paths.map(({ job }) => job.sweep?.sweep ?? null));
  const [id] = ids;
  return paths.length < 2 || ids.size > 1 || id === null ? null : sweepWith(id);
}

/** The values of a run, in words; null of another job, and where they cannot be read. */
export async function runNameOf({ sweep }) {
  const found = sweep ? await sweepWith(sweep.sweep) : null;
  return found && !found.problem ? runWords(found, sweep.run) : null;
}

async function sweepWith(id) {
  if (!read.has(id)) read.set(id, get(`/v1/sweeps/${id}`));
  try {
    return await read.get(id);
  } catch (problem) {
    read.delete(id);
    return { problem: problem.message };
  }
}

/** The values that differ among the runs of these paths. */
export class SweepColours {
  constructor(sweep, paths) {
    this.sweep = sweep;
    this.names = parameterNames(sweep.parameters);
    this.valuesOf = new Map(paths.map(({ id, job }) => [id, valuesOf(sweep, job.sweep.run)]));
    const all = [...this.valuesOf.values()];
    const differs = (place) => new Set(all.map((values) => JSON.stringify(values[place]))).size > 1;
    const isNumber = (place) => all.every((values) => typeof values[place] === "number");
    /** The parameters that can be the scale. */
    this.choices = this.names.map((_, place) => place).filter((place) => differs(place) && isNumber(place));
  }

  /** Colours by that parameter, or by the first that can be the scale. */
  by(place) {
    this.place = this.choices.includes(place) ? place : this.choices[0] ?? null;
    const all = [...this.valuesOf.values()];
    this.values = this.place === null ? [] : [...new Set(all.map((values) => values[this.place]))].sort((a, b) => a - b);
    this.others = [...new Set(all.map((values) => this.othersOf(values)))];
  }

  get isScale() {
    return this.place !== null;
  }

  othersOf(values) {
    return JSON.stringify(values.filter((_, place) => place !== this.place));
  }

  look({ id }) {
    const values = this.valuesOf.get(id);
    const [low, high] = [this.values[0], this.values.at(-1)];
    return {
      colour: mixed(stops(), (values[this.place] - low) / (high - low)), dash: dashAt(this.others.indexOf(this.othersOf(values))),
    };
  }

  nameOf({ job }) {
    return runWords(this.sweep, job.sweep.run);
  }

  /** Values that have a tick: all of them that leave room for the text of one before. */
  ticks() {
    const least = APART * (this.values.at(-1) - this.values[0]);
    const kept = [];
    for (const value of this.values) if (kept.length === 0 || value - kept.at(-1) >= least) kept.push(value);
    return kept;
  }

  /** A trace without points that has the colour bar. */
  bar() {
    const [low, high] = [this.values[0], this.values.at(-1)];
    return {
      x: [null], y: [null], type: "scatter", mode: "markers", hoverinfo: "skip", showlegend: false, name: "colour bar",
      marker: {
        color: [low], cmin: low, cmax: high, showscale: true,
        colorscale: stops().map((colour, place, all) => [place / (all.length - 1), colour]),
        colorbar: {
          title: { text: this.names[this.place], side: "top" }, orientation: "h", thickness: 10, y: 1.02, yanchor: "bottom",
          len: 0.7, x: 0, xanchor: "left", outlinewidth: 0,
          ...(this.values.length <= TICKS ? { tickvals: this.ticks() } : {}),
        },
      },
    };
  }
}

const stops = () => (isDark() ? DARK : LIGHT);

/** The colour at a part from 0 to 1 of the way along some colours. */
function mixed(colours, part) {
  const at = Math.min(Math.max(part, 0), 1) * (colours.length - 1);
  const from = Math.min(Math.floor(at), colours.length - 2);
  const channels = (colour) => [1, 3, 5].map((start) => Number.parseInt(colour.slice(start, start + 2), 16));
  const [a, b] = [channels(colours[from]), channels(colours[from + 1])];
  return `rgb(${a.map((value, place) => Math.round(value + (b[place] - value) * (at - from))).join(", ")})`;
}
