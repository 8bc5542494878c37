// The view of a study, a sweep or a curve: its heading, a picture of its findings and their table, up to date while it runs.

import { get, isGivenUp } from "./api.js";
import { atMostEvery, element, fill } from "./dom.js";
import { findingsActions } from "./job-actions.js";
import { CONFIGURATION, layout } from "./plot-style.js";
import { plotlyLoaded } from "./plotly-loaded.js";
import { follow } from "./stream.js";
import { isGoingOn, nameOf, statusWords } from "./words.js";

/**
 * A subclass defines how its record is read (`load`) and updated with new rows (`come`, `refresh`), whether there are findings
 * (`hasFindings`), and how they are shown (`progressWords`, `remark`, `drawFindings`).
 */
export class FindingsView {
  /**
   * `kind`: "study", "sweep" or "curve"; `place`: the address below which its records are; `title`: what the findings are; `pause`:
   * milliseconds between drawings while rows come in. Calls `told.changed()` when the lists have to be read again,
   * `told.shown(title)`, `told.connection()` and `told.failed(problem)`.
   */
  constructor(section, told, { kind, place, title, pause }) {
    this.section = section;
    this.told = told;
    this.kind = kind;
    this.address = place;
    this.summary = element("div", {});
    this.actions = element("div", {});
    this.heading = element("div", { id: `${kind}-heading` }, this.summary, this.actions);
    this.plotPlace = element("div", { class: "plot tall", id: `${kind}-plot` });
    this.words = element("p", { class: "quiet" });
    this.listing = element("div", {});
    this.panel = element("div", { class: "panel" }, element("h2", {}, title), this.words, this.plotPlace, this.listing);
    fill(section, this.heading, this.panel);
    this.given = new AbortController();
    this.again = atMostEvery(pause, () => this.refresh().catch((problem) => this.failed(problem)));
    this.stop = () => {};
    this.isConnected = true;
  }

  /** Shows the study, sweep or curve of that id; null for none. */
  show(id) {
    if (this.id === id) return;
    this.close();
    this.id = id;
    this.section.hidden = true;
    if (!id) return;
    this.given = new AbortController();
    this.start().catch((problem) => this.failed(problem));
  }

  /** The service can be reached again. */
  recover() {
    const { id } = this;
    if (!id || this.isLoaded) return;
    this.id = null;
    this.show(id);
  }

  failed(problem) {
    if (!isGivenUp(problem)) this.told.failed(problem);
  }

  async start() {
    const place = `${this.address}/${this.id}`;
    const { signal } = this.given;
    const after = await this.load(place, signal);
    if (signal.aborted) return;
    this.isLoaded = true;
    await this.draw();
    if (signal.aborted || !isGoingOn(this.record)) return;
    this.stop = follow(place, after, {
      come: (rows) => { this.come(rows); this.again(); },
      end: (record) => { this.record = record; this.draw(); this.told.changed(); },
      deleted: () => this.gone(),
      connected: (yes) => { this.isConnected = yes; this.told.connection(); },
    });
  }

  /** Reads the record; answers the index of the last row that is held, or null. */
  async load(place, signal) {
    const record = await get(place, signal);
    if (!signal.aborted) this.record = record;
    return null;
  }

  /** Takes rows that have come. */
  come() {}

  /** Brings what is shown up to date after rows have come. */
  async refresh() {
    await this.draw();
  }

  /** The record has been deleted: the view remains, with a notice. */
  async gone() {
    this.record = { ...this.record, status: "deleted" };
    this.isConnected = true;
    await this.draw();
    this.failed(new Error(`This ${this.kind} has been deleted.`));
    this.told.changed();
  }

  async draw() {
    const { record, kind } = this;
    if (!record) return;
    const hasFindings = this.hasFindings();
    this.section.hidden = false;
    this.told.shown(`${kind[0].toUpperCase()}${kind.slice(1)} ${nameOf(record)}`);
    fill(this.summary, element("div", { class: "bar" }, element("h2", {}, nameOf(record)),
      element("span", { class: `status ${record.status}`, id: `${kind}-status` }, record.status)),
    element("p", {}, `${this.progressWords()} The ${kind} ${this.statusWords()}.${this.remark()}`));
    const key = `${record.id} ${record.status} ${hasFindings}`;
    if (this.actions.dataset.of !== key) {
      this.actions.dataset.of = key;
      fill(this.actions, findingsActions(record, kind, this.address, hasFindings, this.told.changed, this.told.failed));
    }
    this.panel.hidden = !hasFindings;
    if (hasFindings) await this.drawFindings();
  }

  statusWords() {
    return statusWords(this.record.status);
  }

  /** The text after the status. */
  remark() {
    return "";
  }

  async plot(traces, own) {
    const { id } = this.record;
    await plotlyLoaded();
    await Plotly.react(this.plotPlace, traces, layout({
      showlegend: true, legend: { orientation: "h", y: 1.12 }, uirevision: id, ...own,
    }), CONFIGURATION);
  }

  close() {
    this.given.abort();
    this.stop();
    this.stop = () => {};
    this.record = null;
    this.isLoaded = false;
    this.isConnected = true;
  }
}
