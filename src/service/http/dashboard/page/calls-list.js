// The list of all calls of the service, made from its OpenAPI description when the list is opened.

import { element, table } from "./dom.js";
import { description, plain } from "./schema.js";

const OTHERS = [["/docs/", "every call, to read and to try"], ["/openapi.json", "the same for programs"]];

export function callsList(place) {
  place.addEventListener("toggle", async () => {
    if (!place.open || place.dataset.filled) return;
    place.dataset.filled = "yes";
    const said = element("p", { class: "quiet" }, "Loading …");
    place.append(said);
    try {
      said.replaceWith(list(await description()));
    } catch (problem) {
      said.replaceWith(element("p", { class: "bad" }, problem.message));
    }
  });
}

function list({ paths }) {
  const rows = OTHERS.map(([path, words]) => ["GET", link(path, false), words]);
  for (const [path, calls] of Object.entries(paths)) {
    for (const [method, { summary, description: told }] of Object.entries(calls)) {
      const words = plain(summary ?? told ?? "");
      rows.push([method.toUpperCase(), link(path, method !== "get" || path.includes("{")), words]);
    }
  }
  return table([], rows);
}

const link = (path, isPattern) => (isPattern ? element("code", {}, path) : element("a", { href: path }, path));
