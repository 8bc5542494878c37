// Asks for the paths that the address names before the rest of the page has come: their numbers take longest.

import { PathData } from "./path-data.js";
import { state } from "./state.js";

/** Id to path, of those that nobody has taken over yet. */
const begun = new Map();

/** The path of a job, on its way: begun before, or now. */
export function pathOnItsWay(id) {
  const path = begun.get(id) ?? new PathData(id);
  begun.delete(id);
  const { abscissa, ordinate } = state();
  path.loading ??= path.load([abscissa, ordinate].filter(Boolean));
  return path;
}

const { jobs, run, study, sweep } = state();
if (!run && !study && !sweep) {
  for (const id of jobs) {
    const path = pathOnItsWay(id);
    // Whoever takes it over hears of it.
    path.loading.catch(() => {});
    begun.set(id, path);
  }
}
