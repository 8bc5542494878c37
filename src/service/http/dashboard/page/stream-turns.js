// Shares connections between streams. A browser opens six connections to a host, for all of its tabs together, which other calls
// need, too. A page therefore uses two for its streams, in turns if there are more streams, and none while it is hidden; a stream
// that continues later resumes after the last index received.

const HELD_AT_ONCE = 2;
/** Milliseconds that a stream keeps its connection while others wait for one. */
const SLICE = 2000;

const waiting = [];
const holders = new Set();
let timer = null;

/** Resolves when a connection may be used, to a function that releases it; `giveBack()` is called when another stream needs the
 *  connection. */
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
