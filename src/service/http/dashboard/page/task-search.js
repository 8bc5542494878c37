// Searches the loaded jobs, studies and sweeps. The service has no call for it, and so what is not loaded is not searched,
// which is said.

import { nameOf, statusOf } from "./words.js";

/** The tasks in whose name, id, status or stop reason all words of the text stand. */
export function found(tasks, text) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return tasks.filter((task) => {
    const of = `${nameOf(task)} ${task.id} ${task.status} ${statusOf(task)} ${task.stop_reason ?? ""}`.toLowerCase();
    return words.every((word) => of.includes(word));
  });
}

/** How many were found, and what was not searched. */
export function foundWords(many, tasks, hasOlder) {
  const of = hasOlder ? `the ${tasks} newest; older ones are not loaded and not searched` : `all ${tasks}`;
  return many === 0 ? `Nothing found among ${of}.` : `${many} found among ${of}.`;
}
