// Requests the paths in the address before the rest of the page has loaded, as their data take longest.

import { PathData } from "./path-data.js";
import { ordinatesIn } from "./quantities.js";
import { state } from "./state.js";

/** Id to path, for the paths that have not been handed over yet. */
const begun = new Map();

/** The path of a job, whose loading began earlier or begins now. */
export function pathOnItsWay(id) {
  const path = begun.get(id) ?? new PathData(id);
  begun.delete(id);
  const { abscissa, ordinate } = state();
  path.loading ??= path.load(abscissa, ordinatesIn(ordinate));
  return path;
}

const { jobs, run, study, sweep } = state();
if (!run && !study && !sweep) {
  for (const id of jobs) {
    const path = pathOnItsWay(id);
    // The receiver of the path handles the error.
    path.loading.catch(() => {});
    begun.set(id, path);
  }
}
