// The level of detail of a picture of a structure: what is left out of a large one, so that it can be read and is drawn quickly.

import { isSolid } from "./structure-solids.js";

/** With more nodes than this the picture is a large one: thin lines, marks only at nodes at which something acts. */
const LARGE = 300;
/** With at most this many nodes their names are in the picture. */
const NAMED = 12;
/** With at most this many nodes their names can be asked for. */
const NAMEABLE = 150;
/** The most friction cones, and the most arrows of one kind. */
const CONES = 60;
const ARROWS = 120;
/** The same in a large picture. */
const FEW_ARROWS = 40;
/** Arrows whose lengths differ by less, relatively, are alike. */
const ALIKE = 0.01;

export class Detail {
  constructor(model) {
    this.dimension = model.dimension;
    this.hasBeams = model.dimension === 2 && (model.elements ?? []).some(({ kind }) => kind === "beam");
    this.nodes = Object.keys(model.nodes).length;
    this.isLarge = this.nodes > LARGE;
    /** Nodes of solids are where their edges meet. */
    this.marksNodes = !this.isLarge && !(model.elements ?? []).some(isSolid);
    this.hasNames = this.nodes <= NAMED;
    this.canHaveNames = this.nodes <= NAMEABLE;
    /** Sentences on what has been left out of the picture. */
    this.leftOut = [];
    if (this.isLarge) {
      this.leave(`With ${this.nodes} nodes, lines are thin, and no marks are drawn at nodes at which nothing acts, nor the `
        + "undeformed structure");
    }
  }

  leave(words) {
    this.leftOut.push(words);
  }

  get lineWidth() {
    return this.isLarge ? 1.5 : 4;
  }

  hasCones(contacts) {
    if (contacts <= CONES) return true;
    this.leave(`Friction cones are not drawn for more than ${CONES} contacts`);
    return false;
  }

  /** The largest of so many `[key, force]` that their arrows can be told apart. */
  arrows(forces, what) {
    const most = this.isLarge ? FEW_ARROWS : ARROWS;
    if (forces.length <= most) return forces;
    this.leave(`Of ${forces.length} ${what} the ${most} largest have arrows, of equal ones some everywhere`);
    const sizes = forces.map(([, force]) => Math.hypot(...force));
    const least = sizes.toSorted((a, b) => b - a)[most - 1];
    const isAlike = (_, place) => Math.abs(sizes[place] - least) <= ALIKE * least;
    const larger = forces.filter((_, place) => sizes[place] > (1 + ALIKE) * least);
    const alike = forces.filter(isAlike);
    const part = (most - larger.length) / alike.length;
    return [...larger, ...alike.filter((_, place) => part >= 1 || Math.floor((place + 1) * part) > Math.floor(place * part))];
  }
}
