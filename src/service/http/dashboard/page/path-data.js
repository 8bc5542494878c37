// What is held of a job: the job, its request, columns of its increments, the points that are not regular, and whole
// increments where a view has asked for them.

import { get } from "./api.js";
import { displacement, isAbscissa, isOrdinate, unescaped } from "./path-axes.js";
import { follow } from "./stream.js";
import { isGoingOn } from "./words.js";

/** Increments that are fetched together when one of them is looked at, at most. */
const WHOLE = 64;
/** Increments that are held whole, times the nodes and contacts of the model; the others are fetched again where they are
 *  looked at. */
const HELD = 500000;
/** So many are held in any case. */
const FEWEST_HELD = 256;
const ALWAYS = ["stage", "load_factor", "arc_length"];

export class PathData {
  constructor(id) {
    this.id = id;
    /** Who is told `(what, path)`: "loaded", "grown", "ended", "connection". */
    this.told = () => {};
    /** Resolves when what is stored has been read. */
    this.loading = null;
    this.job = null;
    this.request = null;
    this.index = [];
    this.columns = new Map();
    this.points = [];
    this.whole = new Map();
    /** Increments that are fetched together: as many as one page was seen to have room for. */
    this.together = WHOLE;
    this.problem = null;
    this.isLoaded = false;
    this.isConnected = true;
    this.stop = () => {};
    this.turn = Promise.resolve();
    this.given = new AbortController();
  }

  /** Reads what is stored, with those of these columns that it has, and goes on with what comes. */
  async load(columns) {
    const place = `/v1/jobs/${this.id}`;
    const { signal } = this.given;
    [this.job, this.request] = await Promise.all([get(place, signal), get(`${place}/request`, signal)]);
    const known = columns.filter((name) => isOrdinate(name) || this.knows(name));
    const own = columns.some((name) => this.knows(name)) ? [] : [this.ownAbscissa()];
    for (const name of [...ALWAYS, ...known, ...own]) this.columns.set(name, []);
    let after = null;
    for (let pages = 1; ; pages++) {
      const page = await this.inTurn(() => this.readOn(after));
      after = page.next_after;
      const isLast = page.index.length === 0 || after === this.job.progress.last_index;
      // What has been read is shown; a path may grow as fast as it is read.
      this.isLoaded = true;
      if (pages === 1 || isLast) this.told("loaded", this);
      else this.told("grown", this);
      if (isLast) break;
    }
    if (signal.aborted || !isGoingOn(this.job)) return;
    this.stop = follow(place, this.index.at(-1) ?? null, {
      come: (increments) => this.take(increments),
      end: (job) => { this.job = job; this.told("ended", this); },
      deleted: () => this.gone(),
      connected: (yes) => { this.isConnected = yes; this.told("connection", this); },
    });
  }

  /** Somebody has deleted the job: what is held stays. */
  gone() {
    if (this.job.status === "deleted") return;
    this.problem = "This job has been deleted.";
    this.job = { ...this.job, status: "deleted" };
    this.isConnected = true;
    this.told("ended", this);
  }

  page(names, after) {
    const of = encodeURIComponent(names.join(","));
    return get(`/v1/jobs/${this.id}/columns?of=${of}${after === null ? "" : `&after=${after}`}`, this.given.signal);
  }

  /** Readings of columns go one after the other: each page belongs to all of those that are held. */
  inTurn(read) {
    const done = this.turn.then(read);
    this.turn = done.catch(() => {});
    return done;
  }

  /** Another page. */
  async readOn(after) {
    const names = [...this.columns.keys()];
    const page = await this.page(names, after);
    for (const number of page.index) this.index.push(number);
    for (const name of names) {
      const column = this.columns.get(name);
      for (const value of page.columns[name]) column.push(value);
    }
    for (const point of page.points) this.points.push(point);
    return page;
  }

  take(increments) {
    for (const increment of increments) {
      this.index.push(increment.index);
      for (const [name, column] of this.columns) column.push(pick(increment, name));
      const { point } = increment;
      if (point.kind !== "regular" || point.bifurcation) this.points.push({ index: increment.index, point });
      this.hold(increment);
    }
    this.told("grown", this);
  }

  /** Columns that are not held yet, up to what is held of the others. */
  need(names) {
    return names.every((name) => this.columns.has(name)) ? null : this.inTurn(() => this.readMissing(names));
  }

  async readMissing(names) {
    const missing = names.filter((name) => !this.columns.has(name));
    if (missing.length === 0) return;
    const found = missing.map(() => []);
    let after = null;
    while (found[0].length < this.index.length) {
      const page = await this.page(missing, after);
      if (page.index.length === 0) break;
      missing.forEach((name, place) => { for (const value of page.columns[name]) found[place].push(value); });
      after = page.next_after;
    }
    missing.forEach((name, place) => {
      found[place].length = this.index.length;
      this.columns.set(name, found[place]);
    });
  }

  /** Keeps an increment whole; the first that were kept give way. */
  hold(increment) {
    const { nodes, contacts } = this.request.model;
    const size = Object.keys(nodes).length + (contacts?.length ?? 0);
    this.whole.set(increment.index, increment);
    while (this.whole.size > Math.max(FEWEST_HELD, HELD / Math.max(1, size))) {
      this.whole.delete(this.whole.keys().next().value);
    }
  }

  /** An increment as it is stored; null where there is none. Those around it come along. */
  async increment(index) {
    if (this.whole.has(index)) return this.whole.get(index);
    // A page of large increments ends before it has as many as were asked for: the next one begins nearer to the wanted
    // one, and at last with it.
    for (let rows = this.together; ; ) {
      const from = index - Math.floor(rows / 2) - 1;
      const increments = await this.wholeAfter(from, rows);
      for (const found of increments) this.hold(found);
      const wanted = this.whole.get(index);
      if (wanted) this.together = rows;
      if (wanted || rows === 1 || increments.at(-1)?.index > index) return wanted ?? null;
      rows = Math.max(1, Math.min(increments.length, Math.floor(rows / 2)));
    }
  }

  async wholeAfter(from, rows) {
    const after = from < 0 ? "" : `&after=${from}`;
    const place = `/v1/jobs/${this.id}/increments?limit=${rows}${after}`;
    const { increments } = await get(place, this.given.signal).catch((problem) => {
      if (problem.status === 404) this.gone();
      throw problem;
    });
    return increments;
  }

  /** Whether any increment that is held has a value of this column. */
  has(name) {
    return this.index.length === 0 || (this.columns.get(name) ?? []).some((value) => value !== null);
  }

  /** Where an increment stands in the columns; -1 where it is not among them (not every increment need be kept). */
  placeOf(index) {
    let [low, high] = [0, this.index.length - 1];
    while (low <= high) {
      const middle = (low + high) >> 1;
      if (this.index[middle] === index) return middle;
      if (this.index[middle] < index) low = middle + 1;
      else high = middle - 1;
    }
    return -1;
  }

  /** The path in closed form, as far as the computed one goes; null where none is known. */
  async exactPath() {
    const span = (name) => {
      const most = (this.columns.get(name) ?? []).reduce((sum, value) => Math.max(sum, Math.abs(value ?? 0)), 0);
      return most > 0 ? most : 1;
    };
    const own = [...this.columns.keys()].filter((name) => name.startsWith("/displacements/"));
    const reach = `load=${span("load_factor")}&displacement=${Math.max(...own.map(span), 1e-300)}`;
    const key = `${this.index.length} ${reach}`;
    if (this.exact?.key !== key) {
      const found = await get(`/v1/jobs/${this.id}/exact?${reach}`, this.given.signal);
      this.exact = { key, path: found.stages.length > 0 ? found : null };
    }
    return this.exact.path;
  }

  last() {
    return this.index.at(-1) ?? null;
  }

  /** Index of the last bifurcation point that has been found; null before the first. */
  lastBifurcation() {
    return this.points.findLast(({ point }) => point.bifurcation)?.index ?? null;
  }

  /** The displacement that the last stage is about: what ends it, or else what is loaded. */
  ownAbscissa() {
    const { model } = this.request;
    const recorded = this.request.analysis?.record?.nodes;
    const isRecorded = (node) => !Array.isArray(recorded) || recorded.includes(node);
    const stages = [...model.stages].reverse();
    for (const { until } of stages) {
      const watched = until?.displacement;
      if (watched && isRecorded(watched.node)) return displacement(watched.node, "xyz".indexOf(watched.component));
    }
    const loaded = (places) => {
      for (const [node, amount] of Object.entries(places)) {
        const component = Array.isArray(amount) ? largest(amount) : -1;
        if (component >= 0 && isRecorded(node)) return displacement(node, component);
      }
      return null;
    };
    for (const { forces, displacements, obstacle_motion: motion } of stages) {
      // An obstacle that moves takes along what is on it.
      const taken = (model.contacts ?? []).filter(({ obstacle }) => motion?.[obstacle])
        .map(({ node, obstacle }) => [node, motion[obstacle]]);
      const found = loaded({ ...forces, ...displacements }) ?? loaded(Object.fromEntries(taken));
      if (found) return found;
    }
    return "arc_length";
  }

  /** Whether there is such a column to be drawn against. */
  knows(abscissa) {
    return isAbscissa(abscissa, this.request);
  }

  close() {
    this.given.abort();
    this.stop();
  }
}

/** Place of the largest component; -1 where all are zero. */
function largest(components) {
  const most = Math.max(...components.map(Math.abs));
  return most > 0 ? components.findIndex((value) => Math.abs(value) === most) : -1;
}

/** A member of an increment by its name or JSON Pointer. */
export function pick(increment, name) {
  const steps = name.startsWith("/") ? name.slice(1).split("/") : [name];
  let value = increment;
  for (const step of steps) {
    value = value?.[unescaped(step)];
  }
  return value ?? null;
}
