// Saves answers of the service, and the plot of paths, as files.

import { call, get } from "./api.js";
import { button, element } from "./dom.js";

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

/** The buttons that save the plot; `plot()` answers `{place, curves, runs}`, or null before something is drawn. Calls
 *  `failed(words)`. */
export function plotButtons(plot, failed) {
  const saving = (make) => async () => {
    const found = plot();
    if (!found) return;
    try {
      // Few readers need it, and nobody at first.
      save(...await make(await import("./path-export.js"), found));
    } catch (problem) {
      failed(`The file cannot be made: ${problem.message}`);
    }
  };
  const picture = (format) => saving(({ pictureFile }, found) => pictureFile(found, format));
  return element("div", { class: "actions", role: "group", "aria-label": "save the plot" },
    button("Save as PNG", picture("png"), { id: "path-png" }), button("Save as SVG", picture("svg"), { id: "path-svg" }),
    button("Save the points (CSV)", saving(({ pointsFile }, found) => pointsFile(found)), { id: "path-points" }));
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
