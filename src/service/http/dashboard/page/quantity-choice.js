// A control that chooses one of the recorded quantities.

import { element, fill } from "./dom.js";
import { unescaped } from "./quantities.js";
import { columnOf } from "./quantity-groups.js";

/** A group with at most this many quantities is listed; of a larger one the node or element is typed. */
const LISTED = 100;
/** The number of names that are proposed for a typed text. */
const PROPOSED = 40;
/** Marks the value of an option that still needs a name. */
const NEEDS_NAME = "?";

const isListed = ({ keys, parts }) => !keys || keys.length * parts.length <= LISTED;

/** `id`: of the select; `value`: the chosen column, or null; `empty`: the option for none. Calls `chosen(column)`. */
export function quantityChoice({ id, label, groups, value, empty }, chosen) {
  const typed = value === null ? null : typedIn(groups, value);
  const select = element("select", { id, "data-key": id, "aria-label": label },
    empty ? element("option", { value: "" }, empty) : null,
    groups.map((group) => element("optgroup", { label: group.title }, options(group, value, typed))));
  const large = groups.filter((group) => !isListed(group));
  if (large.length === 0) {
    select.addEventListener("change", () => { if (select.value) chosen(select.value); });
    return [select];
  }
  return [select, ...nameField({ id, select, large, typed }, chosen)];
}

function options(group, value, typed) {
  const option = (column, words, isChosen) => element("option", { value: column, selected: isChosen }, words);
  if (!group.keys) return group.parts.map(([column, words]) => option(column, words, column === value));
  if (!isListed(group)) {
    return group.parts.map(([part, words]) => option(`${NEEDS_NAME}${group.of}/${part}`, `${words} of …`,
      typed?.group === group && typed.part === part));
  }
  return group.keys.flatMap((key, place) => group.parts.map(([part, words]) => {
    const column = columnOf(group, key, part);
    return option(column, `${words} of ${group.names[place]}`, column === value);
  }));
}

/** The large group, the part and the name of a column; null for a column that is listed. */
function typedIn(groups, column) {
  const [, of, key, ...steps] = column.split("/");
  const part = steps.join("/");
  const found = groups.find((group) => group.of === of && !isListed(group) && group.parts.some(([known]) => known === part)
    && group.keys.includes(unescaped(key)));
  return found ? { group: found, part, name: found.names[found.keys.indexOf(unescaped(key))] } : null;
}

/** A list of thousands of choices would be slow and of no use: the name is typed, with proposals. */
function nameField({ id, select, large, typed }, chosen) {
  const groupOf = () => large.find((group) => group.parts.some(([part]) => select.value === `${NEEDS_NAME}${group.of}/${part}`));
  const proposals = element("datalist", { id: `${id}-names` });
  const input = element("input", {
    type: "text", id: `${id}-node`, "data-key": `${id}-node`, list: `${id}-names`, size: 10, autocomplete: "off",
    value: typed?.name ?? large[0].names[0],
  });
  const propose = () => {
    const names = groupOf()?.names ?? [];
    const found = [];
    for (const name of names) {
      if (name.includes(input.value)) found.push(name);
      if (found.length === PROPOSED) break;
    }
    fill(proposals, found.map((value) => element("option", { value })));
  };
  const prepare = () => {
    const group = groupOf();
    input.disabled = !group;
    input.hidden = !group;
    input.setAttribute("aria-label", group ? `name, one of ${group.names.length}` : "name");
    propose();
  };
  const choose = () => {
    const group = groupOf();
    prepare();
    if (!group) {
      if (select.value) chosen(select.value);
      return;
    }
    const place = group.names.indexOf(input.value);
    if (place < 0) {
      input.setCustomValidity(`Nothing of that name is recorded; there are ${group.names.length}, such as ${group.names[0]}.`);
      input.reportValidity();
      return;
    }
    chosen(columnOf(group, group.keys[place], select.value.slice(NEEDS_NAME.length + group.of.length + 1)));
  };
  select.addEventListener("change", choose);
  input.addEventListener("change", choose);
  input.addEventListener("input", () => { input.setCustomValidity(""); propose(); });
  prepare();
  return [input, proposals];
}
