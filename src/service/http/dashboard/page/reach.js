// Whether the service can be reached: reported by every call, and polled with a small call while it cannot.

const SOON = 500;
const LATEST = 8000;

const listeners = new Set();
let isThere = true;
let wait = SOON;

export const isReached = () => isThere;

/** The listeners that are told when the service is lost (false) or reached again (true). */
export function onReach(listener) {
  listeners.add(listener);
}

/** Reports that a call was answered or not. */
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
