// The service's own description (OpenAPI): calls, settings, their words and defaults, so that nothing of it is written twice.

import { get } from "./api.js";

let described = null;

/** The document; asked for once. */
export async function description() {
  described ??= get("/openapi.json");
  try {
    return await described;
  } catch (problem) {
    described = null;
    throw problem;
  }
}

/** The defaults of a request's `analysis`. */
export async function analysisDefaults() {
  const { properties } = (await description()).components.schemas.Analysis;
  return Object.fromEntries(Object.entries(properties).map(([name, property]) => [name, property.default]));
}

/** A schema with what it refers to put in; of several, the one that is not null. Words and default nearest to it count. */
export function resolved(document, schema) {
  let found = schema;
  let words = {};
  while (found.$ref || found.oneOf) {
    const { $ref, oneOf, ...own } = found;
    words = { ...own, ...words };
    found = $ref ? document.components.schemas[$ref.split("/").at(-1)] : oneOf.find(({ type }) => type !== "null");
  }
  return { ...found, ...words };
}

/** Sentences of a description, without the line breaks and marks of the source. */
export const plain = (text = "") => text.replaceAll("\n", " ").replaceAll("`", "");
