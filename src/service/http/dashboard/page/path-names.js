// Distinguishes paths that are drawn together: each keeps a colour and a dash as long as it is drawn, and has a unique name.

import { colourOf, dashOf } from "./plot-style.js";
import { named } from "./points.js";
import { differences, nameOf } from "./words.js";

/** Characters at the end of a job's id, where ids of jobs queued together differ. */
const SHORT = 6;

/** The styles of curves: a new one gets the first free style, and the others keep theirs. */
export class PathLooks {
  constructor() {
    this.places = new Map();
  }

  /** Sets the keys of the curves that are drawn from now on. */
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

  of(key) {
    const place = this.places.get(key) ?? 0;
    return { colour: colourOf(place), dash: dashOf(place) };
  }
}

/** A name for each path, with the settings in which they differ, and the end of the id if these are not enough; of the runs of
 *  a sweep their values. */
export function pathNames(paths, runs) {
  const values = runs ? paths.map((path) => runs.nameOf(path)) : [];
  if (values.length > 0 && values.every(Boolean)) return values;
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
  const place = point?.name ? `${point.name} (increment ${parent.increment})` : `increment ${parent.increment}`;
  return `branch at ${place}, direction ${parent.direction}`;
}
