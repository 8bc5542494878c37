// Reads all rows of a sweep or curve, page by page.

import { get } from "./api.js";

/** Hands each page to `take`; answers the place of the last row, or null where it was given up. */
export async function allRows(place, signal, take) {
  let after = null;
  for (;;) {
    const page = await get(`${place}/rows${after === null ? "" : `?after=${after}`}`, signal);
    if (signal.aborted) return null;
    take(page.rows);
    after = page.next_after;
    if (page.rows.length === 0) return after;
  }
}
