// Which streams hold a connection: a browser opens six to a host, for all of its tabs together, and every other call needs one of
// them. So a page holds two for its streams and passes them round while more are wanted, and none while nobody sees it; a stream
// that goes on later begins after the last index that came.

const HELD_AT_ONCE = 2;
/** Milliseconds that a stream keeps its connection while others wait for one. */
const SLICE = 2000;

const waiting = [];
const holders = new Set();
let timer = null;

/** Resolves when a connection may be held, to the function that says that it is not any more; `giveBack()` is called when others
 *  should have it. */
export function turn(giveBack) {
  return new Promise((resume) => {
    waiting.push(() => {
      const holder = { giveBack, since: performance.now() };
      holders.add(holder);
      resume(() => { if (holders.delete(holder)) next(); });
    });
    next();
  });
}

function next() {
  if (document.hidden) return;
  while (waiting.length > 0 && holders.size < HELD_AT_ONCE) waiting.shift()();
  if (waiting.length > 0) timer ??= setTimeout(passOn, SLICE);
}

function passOn() {
  timer = null;
  const now = performance.now();
  for (const holder of [...holders].slice(0, waiting.length)) {
    if (now - holder.since >= SLICE) holder.giveBack();
  }
  next();
}

document.addEventListener("visibilitychange", () => {
  if (document.hidden) for (const holder of holders) holder.giveBack();
  else next();
});
