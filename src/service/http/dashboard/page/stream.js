// Follows a job, a study or a sweep over server-sent events, read with fetch (an EventSource sends no token). After a lost
// connection the stream resumes after the last index received, without gap or repeat.

import { call, Problem } from "./api.js";
import { turn } from "./stream-turns.js";

const SOON = 500;
const LATEST = 8000;
/** The service sends a keep-alive every 15 s. */
const SILENCE = 40000;

/**
 * `place`: the address of the job, study or sweep. `after`: the last index received, or null. Calls `come(list)` with increments
 * or rows, `end(job)`, `deleted()` and `connected(yes)`. Returns a function that ends the stream.
 */
export function follow(place, after, { come, end, deleted, connected }) {
  let given = new AbortController();
  let isOver = false;
  let last = after;
  let wait = SOON;
  /** The connection was released for other streams, and not lost. */
  let hasPassedOn = false;

  async function once() {
    const done = await turn(() => { hasPassedOn = true; given.abort(); });
    try {
      if (!isOver) await hold();
    } finally {
      done();
    }
  }

  async function hold() {
    given = new AbortController();
    hasPassedOn = false;
    let silence = setTimeout(() => given.abort(), SILENCE);
    try {
      const headers = { Accept: "text/event-stream" };
      if (last !== null) headers["Last-Event-ID"] = String(last);
      const answer = await call(`${place}/stream`, { headers, signal: given.signal });
      connected(true);
      wait = SOON;
      const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
      let text = "";
      for (;;) {
        const { value, done } = await reader.read();
        if (done || isOver) return;
        clearTimeout(silence);
        silence = setTimeout(() => given.abort(), SILENCE);
        const whole = (text + value).split("\n\n");
        text = whole.pop();
        take(whole.map(read));
        if (isOver) return;
      }
    } finally {
      clearTimeout(silence);
    }
  }

  function take(events) {
    const found = events.filter(({ event }) => event === "increment" || event === "row")
      .filter(({ id }) => last === null || Number(id) > last);
    if (found.length) {
      last = Number(found.at(-1).id);
      come(found.map(({ data }) => JSON.parse(data)));
    }
    const closing = events.find(({ event }) => event === "end" || event === "deleted");
    if (!closing) return;
    isOver = true;
    if (closing.event === "end") end(JSON.parse(closing.data));
    else deleted();
  }

  (async () => {
    while (!isOver) {
      try {
        await once();
      } catch (problem) {
        if (problem instanceof Problem && problem.status === 404) {
          isOver = true;
          connected(true);
          deleted();
        }
      }
      if (isOver) return;
      if (hasPassedOn) continue;
      connected(false);
      await new Promise((resume) => setTimeout(resume, wait));
      wait = Math.min(2 * wait, LATEST);
    }
  })();

  return () => { isOver = true; given.abort(); };
}

function read(text) {
  const found = { event: "", id: "", data: "" };
  for (const line of text.split("\n")) {
    const colon = line.indexOf(":");
    const name = line.slice(0, colon);
    if (name in found) found[name] += line.slice(colon + 1).trimStart();
  }
  return found;
}
