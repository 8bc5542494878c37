// Makes elements of the page without markup in strings, so that texts of models and servers are never parsed as HTML.

const isThere = (child) => child !== null && child !== undefined && child !== false;

/** An element with attributes (`on…` are listeners) and children, which may be elements, texts, or null for none. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  for (const child of children.flat().filter(isThere)) made.append(child);
  return made;
}

export const byId = (id) => document.getElementById(id);

/** Replaces the children of an element. If the focused one has a `data-key`, the new child with the same key gets the focus;
 *  otherwise the first control gets it. */
export function fill(parent, ...children) {
  const hadFocus = parent !== document.activeElement && parent.contains(document.activeElement);
  const focused = hadFocus ? document.activeElement.dataset.key : undefined;
  const fresh = document.createDocumentFragment();
  for (const child of children.flat().filter(isThere)) fresh.append(child);
  parent.replaceChildren(fresh);
  if (!hadFocus) return;
  const same = focused === undefined ? null : parent.querySelector(`[data-key="${CSS.escape(focused)}"]`);
  (same ?? parent.querySelector("button, a[href], input, select, summary"))?.focus({ preventScroll: same === null });
}

/** A select with options `[value, text]`. */
export function choice(attributes, options, chosen) {
  return element("select", attributes,
    options.map(([value, text]) => element("option", { value, selected: value === chosen }, text)));
}

/** A button; `act` gets the event. */
export function button(words, act, attributes = {}) {
  return element("button", { type: "button", ...attributes, onclick: act }, words);
}

/** A button that asks for confirmation in its place. */
export function askingButton(words, question, act, attributes = {}) {
  const place = element("span", { class: "asking" });
  const rest = (hasFocus) => {
    fill(place, button(words, ask, attributes));
    if (hasFocus) place.firstChild.focus();
  };
  const ask = () => {
    const no = button("No", () => rest(true));
    const yes = button("Yes", () => { rest(true); act(); }, { class: "danger" });
    fill(place, element("span", { role: "alert" }, question), yes, no);
    no.focus();
  };
  place.addEventListener("keydown", (event) => { if (event.key === "Escape") rest(true); });
  rest(false);
  return place;
}

/** A table with a head and rows; numbers are aligned to the right. A row may be an element or a list of cells. */
export function table(head, rows) {
  const cell = (value) => (value instanceof Node ? element("td", {}, value)
    : element("td", typeof value === "number" ? { class: "number" } : {}, String(value ?? "–")));
  return element("div", { class: "wide" }, element("table", {},
    head.length ? element("thead", {}, element("tr", {}, head.map((words) => element("th", { scope: "col" }, words)))) : null,
    element("tbody", {}, rows.map((row) => (row instanceof Node ? row : element("tr", {}, row.map(cell)))))));
}

/** Resolves when the next frame has been drawn. */
export const frame = () => new Promise((resume) => requestAnimationFrame(() => setTimeout(resume)));

/** Calls a function once in the next frame, however often it is requested. */
export function onceAFrame(work) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; work(); });
  };
}

/** Pauses are at least this many times as long as the work between them. */
const REST = 3;

/** Calls a function at most once in the given number of milliseconds, less often if it takes long, and once more after the last
 *  request. */
export function atMostEvery(milliseconds, work) {
  let waits = false;
  let pause = milliseconds;
  return () => {
    if (waits) return;
    waits = true;
    setTimeout(async () => {
      waits = false;
      const began = performance.now();
      await work();
      pause = Math.max(milliseconds, REST * (performance.now() - began));
    }, pause);
  };
}
