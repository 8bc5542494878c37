// Distinguishes paths that are drawn together: each keeps a colour and a dash as long as it is drawn, and has a unique name.

import { colourOf, dashOf } from "./plot-style.js";
import { named } from "./points.js";
import { differences, nameOf } from "./words.js";

/** Characters at the end of a job's id, where ids of jobs queued together differ. */
const SHORT = 6;

/** The styles of paths: a new path gets the first free one, and the others keep theirs. */
export class PathLooks {
  constructor() {
    this.places = new Map();
  }

  /** Sets the ids of the paths that are drawn from now on. */
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

/** A name for each path, with the settings in which they differ, and the end of the id if these are not enough. */
export function pathNames(paths) {
  const apart = differences(paths.map(({ request }) => request));
  const names = paths.map((path, place) => [nameOf(path.job), apart[place], branchWords(path, paths)].filter(Boolean).join(", "));
  return names.map((name, place) => (names.indexOf(name) === names.lastIndexOf(name) ? name
    : `${name}, job …${paths[place].id.slice(-SHORT)}`));
}

/** The point at which a branch leaves another path, by its name there if that path is drawn, too. */
function branchWords({ job: { parent } }, paths) {
  if (!parent) return "";
  const origin = paths.find(({ id }) => id === parent.job);
  const point = origin ? named(origin).find(({ index }) => index === parent.increment) : null;
  const place = point ? `${point.name} (increment ${parent.increment})` : `increment ${parent.increment}`;
  return `branch at ${place}, direction ${parent.direction}`;
}
