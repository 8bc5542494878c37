// Saves answers of the service as files.

import { call, get } from "./api.js";

export async function download(place, name) {
  save(await (await call(place)).blob(), name);
}

export async function downloadIncrements(id) {
  save(await everyIncrement(id), `increments-${id}.json`);
}

/** All stored increments as JSON, fetched page by page. */
async function everyIncrement(id) {
  const parts = [];
  let after = "";
  for (;;) {
    const page = await get(`/v1/jobs/${id}/increments?limit=10000${after}`);
    if (page.increments.length === 0) break;
    parts.push(...page.increments.map((increment) => JSON.stringify(increment)));
    after = `&after=${page.next_after}`;
  }
  return new Blob([`{"increments": [\n${parts.join(",\n")}\n]}\n`], { type: "application/json" });
}

/** Saves bytes as a file of that name. */
export function save(blob, name) {
  const address = URL.createObjectURL(blob);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
