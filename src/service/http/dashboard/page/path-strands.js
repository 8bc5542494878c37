// A path as lines of several styles: stretches along which the load rises, falls, or at whose points there is more than one way
// on, of each stage. The points of a style are one trace, interrupted where another style is between.

import { fromSheet, stageColour, stageDash } from "./plot-style.js";
import { branchingPlaces, movedPlaces } from "./points.js";

/** Stages from which on their styles repeat. */
const STYLES = 4;
const WIDTH = { bifurcation: 3.5, halo: 7, falls: 1.5, rises: 2.2, jump: 1 };

export class Strands {
  /** `isAlone`: no other curve is drawn, and so the stages have colours. */
  constructor(curve, isAlone) {
    this.curve = curve;
    this.isAlone = isAlone;
    /** Key of a style to the place up to which its line is drawn. */
    this.ends = new Map();
    this.stage = 0;
  }

  /** The pieces of each style from a place on, as `Map` of key to `{x, y, customdata}`; places come in order. */
  grow(from) {
    const { path } = this.curve;
    const [stages, loads] = [path.columns.get("stage"), path.columns.get("load_factor")];
    const [branches, moved] = [branchingPlaces(path), movedPlaces(path)];
    const pieces = new Map();
    for (let place = from; place < path.index.length; place++) {
      const begins = place === 0 || stages[place] !== stages[place - 1];
      if (begins && place > 0) this.stage++;
      if (begins) {
        this.push(pieces, this.key("rises"), null, place);
        continue;
      }
      if (moved.has(place)) {
        // No states of the path are between.
        this.push(pieces, "jump", place - 1, place);
        continue;
      }
      const kind = loads[place] < loads[place - 1] ? "falls" : "rises";
      // The flag of a point is about its continuation, and so about the line to the next one.
      const isBranching = branches.has(place - 1);
      if (isBranching) this.push(pieces, this.isAlone ? `bifurcation ${kind}` : "halo", place - 1, place);
      if (!isBranching || !this.isAlone) this.push(pieces, this.key(kind), place - 1, place);
    }
    return pieces;
  }

  key(kind) {
    return this.isAlone ? `${kind} ${this.stage % STYLES}` : kind;
  }

  push(pieces, key, before, place) {
    if (!pieces.has(key)) pieces.set(key, { x: [], y: [], customdata: [] });
    const piece = pieces.get(key);
    const add = (at) => {
      piece.x.push(at === null ? null : this.curve.x(at));
      piece.y.push(at === null ? null : this.curve.y(at));
      piece.customdata.push(at === null ? null : this.curve.path.index[at]);
    };
    const end = this.ends.get(key);
    if (before === null || end !== before) {
      if (end !== undefined) add(null);
      if (before !== null) add(before);
    }
    add(place);
    this.ends.set(key, place);
  }

  /** The trace of a style: `rises` or `falls` with the stage's number where it has a colour, `bifurcation` with either, `halo`, `jump`. */
  trace(key, piece, isMarked) {
    const [kind, more] = key.split(" ");
    const falls = kind === "falls" || more === "falls";
    const stage = Number(more) || 0;
    const colour = kind === "bifurcation" || kind === "halo" ? fromSheet("--bifurcation") : kind === "jump" ? fromSheet("--quiet")
      : stage > 0 ? stageColour(stage) : this.curve.colour;
    return {
      ...piece, type: "scatter", mode: isMarked && kind !== "halo" && kind !== "jump" ? "lines+markers" : "lines", hoverinfo: "skip", name: key,
      showlegend: false, zorder: kind === "halo" ? 1 : 2, opacity: kind === "halo" ? 0.3 : 1, yaxis: this.curve.yaxis,
      line: { color: colour, width: this.width(kind), dash: this.dash(kind, stage, falls) },
      marker: { color: colour, size: 4, symbol: falls ? "circle-open" : "circle" },
    };
  }

  dash(kind, stage, falls) {
    if (kind === "halo") return "solid";
    if (kind === "jump") return "dash";
    const own = !this.isAlone ? this.curve.dash : kind === "bifurcation" ? "solid" : stageDash(stage);
    return falls && (this.isAlone || own === "solid") ? "dot" : own;
  }

  width(kind) {
    return kind === "falls" && !this.isAlone && this.curve.dash !== "solid" ? 1 : WIDTH[kind];
  }
}
