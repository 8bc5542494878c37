// Finds the value of a JSON Pointer (RFC 6901) in a JSON text, in order to show the line of a mistake, and to set a value
// without changing the rest of the text.

/** `{line, start, end}` of the value, or of the nearest existing one around it. */
export function placeIn(text, { pointer = "", detail = "" }) {
  const told = /line (\d+)(?:,? column (\d+))?/.exec(detail);
  if (!pointer && told) {
    const line = Number(told[1]);
    const rows = text.split("\n");
    const start = rows.slice(0, line - 1).reduce((sum, row) => sum + row.length + 1, 0);
    // The service counts characters, JavaScript UTF-16 code units.
    const characters = [...rows[line - 1] ?? ""];
    const column = Math.max(0, Number(told[2] ?? 1) - 1);
    const at = start + characters.slice(0, column).join("").length;
    return { line, start: at, end: at + (characters[column] ?? " ").length };
  }
  const steps = pointer.split("/").slice(1).map((step) => step.replaceAll("~1", "/").replaceAll("~0", "~"));
  let found = { start: 0, end: 1 };
  try {
    const reader = new Reader(text);
    reader.value(steps, (start, end) => { found = { start, end }; });
  } catch {
    // The text is no JSON: the best place found so far is used.
  }
  return { ...found, line: text.slice(0, found.start).split("\n").length };
}

/** The text with a member of its outermost object set; `undefined` removes the member. */
export function withMember(text, name, value) {
  const places = [];
  const reader = new Reader(text);
  reader.value([name], (start, end, isWhole) => places.push({ start, end, isWhole }));
  const written = value === undefined ? null : indented(value);
  const place = places.find(({ isWhole }) => isWhole);
  if (place) return `${text.slice(0, place.start)}${written ?? "{}"}${text.slice(place.end)}`;
  if (written === null) return text;
  const end = text.trimEnd().length - 1;
  const before = text.slice(0, end).trimEnd();
  return `${before}${before.endsWith("{") ? "" : ","}\n  ${JSON.stringify(name)}: ${written}\n${text.slice(end)}`;
}

/** The text without a member of its outermost object; the rest is unchanged. */
export function withoutMember(text, name) {
  let start = null;
  let end = null;
  new Reader(text).value([name], (from, to, isWhole) => {
    if (isWhole) end = to;
    else start ??= from;
  });
  if (start === null || end === null) return text;
  const before = text.slice(0, start).trimEnd();
  if (before.endsWith(",")) return `${before.slice(0, -1)}${text.slice(end)}`;
  return `${text.slice(0, start)}${text.slice(end).replace(/^\s*,\s*/, "")}`;
}

/** A member of the outermost object: its own members on a line each. */
function indented(value) {
  const members = Object.entries(value).map(([name, own]) => `    ${JSON.stringify(name)}: ${onOneLine(own)}`);
  return members.length ? `{\n${members.join(",\n")}\n  }` : "{}";
}

/** Line breaks within JSON's texts are escaped, so that those found are the layout's. */
const onOneLine = (value) => JSON.stringify(value, null, 1)
  .replace(/([{[])\n\s*/g, "$1").replace(/\n\s*([}\]])/g, "$1").replace(/\n\s*/g, " ");

class Reader {
  constructor(text) {
    this.text = text;
    this.at = 0;
  }

  space() {
    while (/\s/.test(this.text[this.at] ?? "")) this.at++;
  }

  expect(character) {
    this.space();
    if (this.text[this.at] !== character) throw new SyntaxError(`${character} at ${this.at}`);
    this.at++;
  }

  string() {
    this.space();
    const start = this.at;
    this.expect("\"");
    while (this.text[this.at] !== "\"") {
      if (this.at >= this.text.length) throw new SyntaxError("a text without end");
      this.at += this.text[this.at] === "\\" ? 2 : 1;
    }
    this.at++;
    return JSON.parse(this.text.slice(start, this.at));
  }

  /** Reads a value; tells the place of each one on the way of the steps, which are null where the way is elsewhere, and
   *  whether it is the whole of the one that the steps lead to. */
  value(steps, tell) {
    this.space();
    const start = this.at;
    const opening = this.text[this.at];
    if (opening === "{" || opening === "[") this.members(opening, steps, tell);
    else if (opening === "\"") this.string();
    else {
      const plain = /^[^\s,\]}]+/.exec(this.text.slice(this.at, this.at + 400));
      if (!plain) throw new SyntaxError(`a value at ${this.at}`);
      this.at += plain[0].length;
    }
    if (steps?.length === 0) tell(start, this.at, true);
  }

  members(opening, steps, tell) {
    const closing = opening === "{" ? "}" : "]";
    this.at++;
    this.space();
    if (this.text[this.at] === closing) {
      this.at++;
      return;
    }
    for (let place = 0; ; place++) {
      this.space();
      const start = this.at;
      let name = String(place);
      if (opening === "{") {
        name = this.string();
        this.expect(":");
      }
      const isOnTheWay = steps?.length > 0 && steps[0] === name;
      if (isOnTheWay) tell(start, start + Math.max(1, name.length + 2), false);
      this.value(isOnTheWay ? steps.slice(1) : null, tell);
      this.space();
      if (this.text[this.at] !== ",") break;
      this.at++;
    }
    this.expect(closing);
  }
}
