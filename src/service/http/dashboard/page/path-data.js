// The loaded data of a job: the job, its request, columns of its increments, the points that are not regular, and complete
// increments that a view has requested.

import { get } from "./api.js";
import { displacement, isRecorded, unescaped } from "./quantities.js";
import { follow } from "./stream.js";
import { isGoingOn } from "./words.js";

/** The most increments that are fetched together with a requested one. */
const WHOLE = 64;
/** The number of complete increments that are kept, times the nodes and contacts of the model; others are fetched again when
 *  they are needed. */
const HELD = 500000;
/** The least number of complete increments that are kept. */
const FEWEST_HELD = 256;
const ALWAYS = ["stage", "load_factor", "arc_length"];

/** Whether a model has a mesh, or names of sets and surfaces where nodes are drawn. */
const namesParts = (model) => Boolean(model.mesh)
  || Object.keys(model.supports ?? {}).some((name) => name.startsWith("@"))
  || (model.contacts ?? []).some(({ node, surface }) => (surface && !node) || node?.startsWith("@"));

export class PathData {
  constructor(id) {
    this.id = id;
    /** The listeners to `(event, path)`, with the events "loaded", "grown", "ended" and "connection". */
    this.told = () => {};
    /** Resolves when all stored increments have been read. */
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

  /** Reads the stored increments, with the given columns if the job has them, then follows the stream. */
  async load(abscissa, ordinates) {
    const place = `/v1/jobs/${this.id}`;
    const { signal } = this.given;
    const [job, request] = await Promise.all([get(place, signal), get(`${place}/request`, signal)]);
    this.job = job;
    this.request = request;
    if (namesParts(request.model)) {
      const { model } = await get(`${place}/request?expanded=true`, signal);
      this.request = { ...request, model };
    }
    const isKnown = abscissa !== null && this.knows(abscissa);
    const known = ordinates.filter((name) => this.knows(name));
    for (const name of [...ALWAYS, ...known, isKnown ? abscissa : this.ownAbscissa()]) this.columns.set(name, []);
    let after = null;
    for (let pages = 1; ; pages++) {
      const page = await this.inTurn(() => this.readOn(after));
      after = page.next_after;
      const isLast = page.index.length === 0 || after === this.job.progress.last_index;
      // Shows what has been read, as a path may grow as fast as it is read.
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

  /** The job has been deleted: the loaded data are kept. */
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

  /** Reads columns one request after another, as every page extends all loaded columns. */
  inTurn(read) {
    const done = this.turn.then(read);
    this.turn = done.catch(() => {});
    return done;
  }

  /** Reads the next page. */
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

  /** Reads columns that are not loaded yet, up to the last increment of the others. */
  need(names) {
    return names.every((name) => this.columns.has(name)) ? null : this.inTurn(() => this.readMissing(names));
  }

  async readMissing(names) {
    const missing = [...new Set(names)].filter((name) => !this.columns.has(name));
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

  /** Keeps a complete increment, and removes the oldest ones if there are too many. */
  hold(increment) {
    const { nodes, contacts } = this.request.model;
    const size = Object.keys(nodes).length + (contacts?.length ?? 0);
    this.whole.set(increment.index, increment);
    while (this.whole.size > Math.max(FEWEST_HELD, HELD / Math.max(1, size))) {
      this.whole.delete(this.whole.keys().next().value);
    }
  }

  /** A complete increment; null if there is none. Its neighbours are fetched, too. */
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

  /** Whether any loaded increment has a value in this column. */
  has(name) {
    return this.index.length === 0 || (this.columns.get(name) ?? []).some((value) => value !== null);
  }

  /** The position of an increment in the columns; -1 if it is not among them (not every increment need be recorded). */
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

  /** The exact path over the range of the computed one; null if none is known. */
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

  /** The index of the last bifurcation point so far; null before the first. */
  lastBifurcation() {
    return this.points.findLast(({ point }) => point.bifurcation)?.index ?? null;
  }

  /** The characteristic displacement of the last stage: that which ends it, or else that of the load. */
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
    for (const { forces, displacements, obstacle_motion: motion, obstacle_rotation: rotation } of stages) {
      // A moving obstacle displaces the nodes on it, and so does one that turns.
      const taken = (model.contacts ?? []).filter(({ obstacle }) => motion?.[obstacle] ?? rotation?.[obstacle])
        .map(({ node, obstacle }) => [node, motion?.[obstacle] ?? model.nodes[node].map((_, axis) => (axis === 0 ? 1 : 0))]);
      const found = loaded({ ...forces, ...displacements }) ?? loaded(Object.fromEntries(taken));
      if (found) return found;
    }
    return "arc_length";
  }

  /** Whether the increments of the job have such a column. */
  knows(name) {
    return isRecorded(name, this.request);
  }

  close() {
    this.given.abort();
    this.stop();
  }
}

/** The index of the largest component; -1 if all are zero. */
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
