// A curve: the load at limit points, bifurcation points or contact changes against a number of the model, each kind apart, with
// the points where the curve changes, and how it ends.

import { element, fill, table } from "./dom.js";
import { axis, colourOf } from "./plot-style.js";
import { RowsView } from "./rows-view.js";
import { placeWords } from "./sweep-values.js";
import { kindWords, short, verbatim } from "./words.js";

/** The kinds of points, each with a line of its own. */
const KINDS = ["smooth_limit", "nonsmooth_limit", "smooth_bifurcation", "contact_change"];
/** Milliseconds between drawings while points come in. */
const AGAIN = 300;
/** Points that stand in the table; the others are in the files. */
const LISTED = 500;

export class CurveView extends RowsView {
  constructor(section, told) {
    super(section, told, { kind: "curve", place: "/v1/curves", title: "Points of the curve", pause: AGAIN });
  }

  progressWords() {
    return `${this.rows.length} ${this.rows.length === 1 ? "point" : "points"}.`;
  }

  statusWords() {
    // It has no path of its own that could end.
    return this.record.status === "stopped" ? "has ended" : super.statusWords();
  }

  remark() {
    const { error, report } = this.record;
    const ends = report?.complete ? ` From the start towards smaller values: ${report.ends_below}. Towards larger values: ${report.ends_above}.` : "";
    return ` ${error ? `The reason: ${error}` : ""}${ends}`;
  }

  async drawFindings() {
    const all = this.rows.toSorted((a, b) => a.place - b.place);
    const { off_path_from: from, off_path_to: to } = this.record.report ?? {};
    const isOff = ({ place }) => (place >= (from ?? Infinity)) || (place <= (to ?? -Infinity));
    const rows = all.filter((row) => !isOff(row));
    const parameter = placeWords(this.record.plan.curve.parameter);
    const changes = rows.filter((row) => row.codimension_two);
    this.words.textContent = `The load factor at each point. ${changes.length
      ? "Rings: the points change their kind, or the path comes to them by other contact changes." : ""}${rows.length < all.length
      ? ` Not drawn are ${all.length - rows.length} points that are on no path, as far as is known.` : ""}`;
    const traces = KINDS.map((kind, place) => ({
      type: "scatter", mode: "lines+markers", name: kindWords(kind), connectgaps: false,
      x: rows.map(({ value }) => value),
      // A point where the kind changes belongs to both lines.
      y: rows.map((row, at) => (row.kind === kind || (row.codimension_two && rows[at + 1]?.kind === kind) ? row.load_factor : null)),
      hovertemplate: `${kindWords(kind)}<br>%{x}: %{y:.8g}<extra></extra>`,
      line: { color: colourOf(place) }, marker: { size: 6 },
    })).filter(({ y }) => y.some((load) => load !== null));
    if (changes.length) {
      traces.push({
        type: "scatter", mode: "markers", name: "change", x: changes.map(({ value }) => value),
        y: changes.map((row) => row.load_factor), text: changes.map(({ event }) => verbatim(event ?? "")),
        hovertemplate: "%{text}<br>%{x:.9g}: %{y:.8g}<extra></extra>",
        marker: { size: 12, symbol: "circle-open", line: { width: 2 }, color: colourOf(2) },
      });
    }
    await this.plot(traces, { xaxis: axis(parameter), yaxis: axis("load factor"), showlegend: traces.length > 1 });
    fill(this.listing, table([parameter, "load factor", "kind", "event"], all.slice(0, LISTED).map((row) => [
      Number(row.value.toPrecision(10)), Number(row.load_factor.toPrecision(10)), kindWords(row.kind),
      isOff(row) ? "on no path, as far as is known" : row.event ?? (row.from_path ? "on a path traced for it" : ""),
    ])), all.length > LISTED ? element("p", { class: "quiet" }, `The first ${short(LISTED)} of ${all.length}; the files have all of them.`) : null);
  }
}
