// How paths that are drawn together are told apart: a colour and a dash that stay with each as long as it is drawn, and a name
// that no other has.

import { colourOf, dashOf } from "./plot-style.js";
import { named } from "./points.js";
import { differences, nameOf } from "./words.js";

/** Characters at the end of a job's id, where ids of jobs queued together differ. */
const SHORT = 6;

/** Looks of paths: the first free one for each that is new, and its own for each that stays. */
export class PathLooks {
  constructor() {
    this.places = new Map();
  }

  /** Ids of the paths that are drawn from now on. */
  keep(ids) {
    for (const id of this.places.keys()) if (!ids.includes(id)) this.places.delete(id);
    const taken = new Set(this.places.values());
    for (const id of ids) {
      if (this.places.has(id)) continue;
      let free = 0;
      while (taken.has(free)) free++;
      taken.add(free);
      this.places.set(id, free);
    }
  }

  colour({ id }) {
    return colourOf(this.places.get(id) ?? 0);
  }

  dash({ id }) {
    return dashOf(this.places.get(id) ?? 0);
  }
}

/** A name for each of the paths, with what is not the same in all of them, and the end of the id where that is not enough. */
export function pathNames(paths) {
  const apart = differences(paths.map(({ request }) => request));
  const names = paths.map((path, place) => [nameOf(path.job), apart[place], branchWords(path, paths)].filter(Boolean).join(", "));
  return names.map((name, place) => (names.indexOf(name) === names.lastIndexOf(name) ? name
    : `${name}, job …${paths[place].id.slice(-SHORT)}`));
}

/** Where a branch leaves another path: at the point as it is named there, where that path is drawn, too. */
function branchWords({ job: { parent } }, paths) {
  if (!parent) return "";
  const origin = paths.find(({ id }) => id === parent.job);
  const point = origin ? named(origin).find(({ index }) => index === parent.increment) : null;
  const place = point ? `${point.name} (increment ${parent.increment})` : `increment ${parent.increment}`;
  return `branch at ${place}, direction ${parent.direction}`;
}
