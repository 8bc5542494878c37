// What a sweep varies, in words, and the values of one of its runs.

/** A pointer as a reader would write it: `contacts[0].friction`. */
export function placeWords(pointer) {
  const steps = stepsOf(pointer);
  const written = steps.map((step) => (/^(\d+|\*)$/.test(step) ? `[${step}]` : `.${step}`)).join("").slice(1);
  return written.replace(/^model\./, "");
}

export const valueWords = (value) => (typeof value === "string" ? value : JSON.stringify(value));

/** A short name for each parameter: the last step of its pointer, or all of it where others end in the same. */
export function parameterNames(parameters) {
  const last = parameters.map(({ pointer }) => stepsOf(pointer).at(-1));
  return parameters.map(({ pointer }, place) => {
    const isOwn = last.indexOf(last[place]) === last.lastIndexOf(last[place]) && !/^\d+$/.test(last[place]);
    return isOwn ? last[place].replaceAll("_", " ") : placeWords(pointer);
  });
}

/** The values of a run, in the order of the parameters; null where the list of values is shortened. */
export function valuesOf({ parameters, combine, parameter_count: all }, run) {
  const counts = parameters.map(({ values, value_count: count }) => count ?? values.length);
  const isShort = parameters.some(({ values }, place) => values.length < counts[place]);
  if (isShort || (all ?? parameters.length) > parameters.length) return null;
  if (combine === "list") return parameters.map(({ values }) => values[run]);
  // In a grid the last parameter changes fastest.
  let left = run;
  const found = [];
  for (let place = parameters.length - 1; place >= 0; place--) {
    found.unshift(parameters[place].values[left % counts[place]]);
    left = Math.floor(left / counts[place]);
  }
  return found;
}

/** The values of a run in words: `friction 0.4`; null where they are not known. */
export function runWords(sweep, run) {
  const values = sweep ? valuesOf(sweep, run) : null;
  if (!values) return null;
  const names = parameterNames(sweep.parameters);
  return values.map((value, place) => `${names[place]} ${valueWords(value)}`).join(", ");
}

const stepsOf = (pointer) => pointer.split("/").slice(1).map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));
