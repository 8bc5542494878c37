// The OpenAPI description of the service: calls, settings, their descriptions and defaults, so that they are not repeated here.

import { get } from "./api.js";

let described = null;

/** The document, requested once. */
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

/** A schema with its references resolved; of several alternatives the one that is not null. The outermost description and default
 *  count. */
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
