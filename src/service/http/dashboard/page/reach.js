// Whether the service answers: told by every call, and looked after by a light one of its own as long as it does not.

const SOON = 500;
const LATEST = 8000;

const listeners = new Set();
let isThere = true;
let wait = SOON;

export const isReached = () => isThere;

/** Who is told that the service has gone (false) or is back (true). */
export function onReach(listener) {
  listeners.add(listener);
}

/** A call has been answered, or has not. */
export function reached(yes) {
  if (yes === isThere) return;
  isThere = yes;
  wait = SOON;
  if (!yes) later();
  for (const listener of listeners) listener(yes);
}

function later() {
  setTimeout(async () => {
    if (isThere) return;
    try {
      await fetch("/healthz", { cache: "no-store" });
      reached(true);
    } catch {
      wait = Math.min(2 * wait, LATEST);
      later();
    }
  }, wait);
}
