// The labels of a model's units, behind numbers and in headings.

import { short } from "./words.js";

/** The labels of lengths and of forces; "" where the model has none. */
export const unitsOf = (model) => ({ length: model.units?.length ?? "", force: model.units?.force ?? "" });

/** A number with the label of its unit. */
export const measured = (value, unit) => (unit && typeof value === "number" ? `${short(value)} ${unit}` : short(value));

/** The components of a vector with the label of their unit. */
export const components = (values, unit) => `(${values.map(short).join(", ")})${unit ? ` ${unit}` : ""}`;

/** A heading with the unit of what it heads. */
export const headed = (words, unit) => (unit ? `${words} (${unit})` : words);

/** A moment with the labels of its unit; both are needed for that. */
export const moment = (value, { length, force }) => measured(value ?? null, length && force ? `${force} ${length}` : "");
