// The view of one or several jobs: their paths, and the structure, directions and diagnostics of the first. It passes events
// between its parts.

import { isGivenUp } from "./api.js";
import { ContinueForm } from "./continue-form.js";
import { Diagnostics } from "./diagnostics.js";
import { Directions } from "./directions.js";
import { atMostEvery, byId, frame, onceAFrame } from "./dom.js";
import { pathOnItsWay } from "./early.js";
import { JobHeading } from "./job-heading.js";
import { axesOf } from "./path-axes.js";
import { PathPlot } from "./path-plot.js";
import { plotlyLoaded } from "./plotly-loaded.js";
import { change, state } from "./state.js";
import { StructurePlot } from "./structure-plot.js";
import { runNameOf, sweepOf } from "./sweep-colours.js";
import { isGoingOn } from "./words.js";

/** Milliseconds between pictures of the structure of a path that grows: the path itself is drawn first. */
const STRUCTURE = 300;
/** Milliseconds between updates of directions and diagnostics. */
const FIGURES = 2000;
/** A performance mark: the time from the start of loading to the first path on the screen. */
const FIRST_PATH = "first path";

export class JobView {
  /** Tells `said(words, again)`: what stands in the place of a job, and how to try again; `titled(words)`; `changed()`;
   *  `connection()`; `continued(curve)`. */
  constructor(told) {
    this.told = told;
    /** Id to path, for all loaded paths, drawn or not. */
    this.held = new Map();
    /** Id to the values of a run of a sweep, in words. */
    this.runNames = new Map();
    this.top = new JobHeading(byId("heading"), told);
    const chosen = (index) => change({ at: index });
    this.pathPlot = new PathPlot(byId("path"), {
      chosen: (id, index) => this.chooseAt(id, index),
      hovered: (id, index) => { if (id === state().jobs[0]) this.structure.choose(index); },
      left: () => this.structure.choose(state().at),
      axes: (axes) => change(axes),
      failed: (words) => told.said(words),
    });
    this.structure = new StructurePlot(byId("structure"), {
      chosen, pointedAt: (yes) => this.pathPlot.pointAt(yes), seen: change,
      shown: (...increment) => this.contacts(increment),
    }, state());
    this.directions = new Directions(byId("directions"), {
      chosen,
      followed: (job) => { told.changed(); change({ jobs: [...state().jobs, job.id] }); },
    });
    this.continuing = new ContinueForm(byId("continuing"), told);
    this.diagnostics = new Diagnostics(byId("diagnostics"), { opened: (figures) => change({ figures }) }, state().figures);
    this.structureLater = atMostEvery(STRUCTURE, () => {
      if (state().at === null && this.first) return this.structure.choose(null);
      return null;
    });
    this.figuresLater = atMostEvery(FIGURES, () => {
      if (state().at === null && this.first) {
        this.directions.choose(this.first, null);
        this.continuing.choose(this.first, null);
      }
      return this.diagnostics.draw();
    });
    this.grown = onceAFrame(() => {
      this.pathPlot.grow();
      this.heading();
      this.structureLater();
      this.figuresLater();
    });
  }

  /** The table of contacts, which is loaded when there is something to show: the service may have gone by then. */
  async contacts(increment) {
    const table = await import("./contacts-table.js").catch((problem) => {
      this.told.said(`The table of contacts cannot be loaded: ${problem.message}`, () => this.view());
    });
    table?.showContacts(byId("contacts"), ...increment);
  }

  /** The first of the shown paths, once it can be drawn. */
  get first() {
    const [path] = this.paths();
    return path && path.id === state().jobs[0] ? path : null;
  }

  paths() {
    return state().jobs.map((id) => this.held.get(id)).filter((path) => path?.isLoaded);
  }

  get isConnected() {
    return state().jobs.every((id) => this.held.get(id)?.isConnected !== false);
  }

  /** The view has changed in more than the chosen increment. */
  view() {
    this.structure.rest();
    this.look();
    this.hold();
    this.draw();
    if (this.isWanted && !this.first) this.prepare();
  }

  /** From where the structure is seen, and whether the figures are open, as the address says: one may have gone back. */
  look() {
    this.structure.lookAs(state());
    this.diagnostics.open(state().figures);
  }

  /** The colours of the page have changed. */
  repaint() {
    this.structure.repaint();
    return this.draw();
  }

  /** The service can be reached again. */
  async recover() {
    if (!this.isWanted) return;
    this.hold();
    await this.draw();
    this.choose();
  }

  get isWanted() {
    return state().jobs.length > 0 && !state().run && state().study === null && state().sweep === null
      && state().curve === null;
  }

  /** A placeholder while a path is being loaded. */
  async prepare() {
    byId("job").hidden = false;
    byId("job").classList.add("loading");
    this.top.prepare();
    try {
      await plotlyLoaded();
      if (!byId("job").hidden && !this.first) await this.pathPlot.prepare();
    } catch (problem) {
      this.told.said(problem.message, () => this.view());
    }
  }

  /** The chosen increment has changed. */
  choose() {
    const { at } = state();
    const { first } = this;
    if (!first) return;
    this.pathPlot.choose(at);
    this.structure.choose(at);
    this.directions.choose(first, at);
    this.continuing.choose(first, at);
  }

  /** Moves along the path by a number of increments. */
  step(by) {
    const { first } = this;
    if (!first?.index.length) return;
    const at = state().at ?? first.last();
    // If the increment is not recorded, starts from the previous one.
    const place = Math.max(0, first.index.findLastIndex((index) => index <= at));
    change({ at: first.index[Math.min(first.index.length - 1, Math.max(0, place + by))] });
  }

  chooseAt(id, index) {
    const { jobs } = state();
    // A point of another path makes that one the first; what is drawn, and against what, stays.
    change(id === jobs[0] ? { at: index }
      : { jobs: [id, ...jobs.filter((other) => other !== id)], at: index, abscissa: axesOf(this.paths(), state()).abscissa });
  }

  hold() {
    const wanted = state().jobs;
    this.pathPlot.keep(wanted);
    for (const [id, path] of this.held) {
      if (!wanted.includes(id)) {
        path.close();
        this.held.delete(id);
      }
    }
    for (const id of wanted.filter((one) => !this.held.has(one))) {
      const path = pathOnItsWay(id);
      path.told = (what, which) => this.hears(what, which);
      this.held.set(id, path);
      path.loading.catch((problem) => {
        if (isGivenUp(problem)) return;
        path.close();
        this.held.delete(id);
        const others = state().jobs.filter((other) => other !== id);
        if (problem.status === 404 && others.length > 0) {
          // The existing jobs are shown.
          this.missing = { words: `Not all jobs can be shown: ${problem.message}`, beside: others.join() };
          change({ jobs: others });
          return;
        }
        byId("job").hidden = true;
        this.told.said(`The job cannot be shown: ${problem.message}`, () => this.view());
      });
    }
  }

  hears(what, path) {
    if (!state().jobs.includes(path.id)) return;
    if (what === "connection") this.told.connection();
    else if (what === "grown") this.grown();
    else if (what === "loaded") this.draw();
    else {
      this.told.connection();
      this.draw();
      this.told.changed();
    }
  }

  async draw() {
    const { first } = this;
    const section = byId("job");
    if (!this.isWanted) section.hidden = true;
    if (!this.isWanted || !first) return;
    section.hidden = false;
    section.classList.remove("loading");
    const shown = this.paths();
    const axes = axesOf(shown, state());
    this.heading();
    this.nameRun(first);
    const read = shown.map((path) => path.need([axes.abscissa, ...axes.ordinates]));
    try {
      this.pathPlot.sweep = (await Promise.all([sweepOf(shown), plotlyLoaded(), ...read]))[0];
    } catch (problem) {
      if (!isGivenUp(problem)) this.told.said(problem.message, () => this.view());
      return;
    }
    if (this.first !== first) return;
    const missing = this.missing?.beside === state().jobs.join() ? this.missing.words : "";
    this.told.said([missing, axes.refused].filter(Boolean).join(" "));
    await this.pathPlot.draw(shown, axes, state().at);
    measureFirstPath();
    // Each in a frame of its own, so that the page stays responsive.
    await frame();
    await this.structure.show(first, state().at);
    await frame();
    this.layExact(first);
    this.directions.choose(first, state().at);
    this.continuing.choose(first, state().at);
    this.diagnostics.show(first);
  }

  /** Draws the exact path under the computed one once this is complete; drawing does not wait for it. */
  async layExact(path) {
    if (isGoingOn(path.job)) return;
    const before = path.exact;
    try {
      await path.exactPath();
    } catch (problem) {
      if (!isGivenUp(problem)) this.told.said(problem.message);
      return;
    }
    if (path.exact === before || !path.exact.path || this.first !== path) return;
    await this.pathPlot.draw(this.paths(), axesOf(this.paths(), state()), state().at);
  }

  heading() {
    if (this.first && this.isWanted) this.top.show(this.first, state().jobs.length - 1, this.runNames.get(this.first.id));
  }

  /** Tells in the heading which run of its sweep a path is; drawing does not wait for it. */
  async nameRun({ id, job }) {
    if (!job.sweep || this.runNames.has(id)) return;
    this.runNames.set(id, await runNameOf(job));
    if (this.first?.id === id) this.heading();
  }
}

function measureFirstPath() {
  if (performance.getEntriesByName(FIRST_PATH).length > 0) return;
  // Work after the callbacks of a frame runs after the frame has been painted.
  requestAnimationFrame(() => setTimeout(() => {
    if (performance.getEntriesByName(FIRST_PATH).length === 0) performance.measure(FIRST_PATH, { start: 0 });
  }));
}
