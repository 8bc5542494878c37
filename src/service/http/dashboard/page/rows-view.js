// The view of findings whose rows are read page by page, and come one by one: of a sweep or a curve.

import { get } from "./api.js";
import { FindingsView } from "./findings-view.js";

export class RowsView extends FindingsView {
  constructor(section, told, kind) {
    super(section, told, kind);
    this.rows = [];
  }

  /** Reads the record, and all rows that are there; answers the place of the last one. */
  async load(place, signal) {
    this.rows = [];
    await super.load(place, signal);
    let after = null;
    for (;;) {
      const page = await get(`${place}/rows${after === null ? "" : `?after=${after}`}`, signal);
      if (signal.aborted) return null;
      this.rows.push(...page.rows);
      after = page.next_after;
      if (page.rows.length === 0) return after;
    }
  }

  come(rows) {
    this.rows.push(...rows);
  }

  hasFindings() {
    return this.rows.length > 0;
  }
}
