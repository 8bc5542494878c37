// The text field of a request with line numbers and marks at mistakes.

import { element, fill } from "./dom.js";

/** Lines above a mistake that remain visible. */
const ABOVE = 4;

export class RequestText {
  /** Calls `edited()` after a change, and before it `pasted()` if the whole text is replaced by pasting. */
  constructor({ edited, pasted }) {
    this.area = element("textarea", {
      id: "request", spellcheck: "false", rows: 22, "aria-label": "job request (JSON)", oninput: () => edited(),
      onscroll: () => { this.lines.scrollTop = this.area.scrollTop; },
      onpaste: () => {
        const { selectionStart, selectionEnd, value } = this.area;
        if (selectionStart === 0 && selectionEnd === value.length) pasted();
      },
    });
    this.lines = element("pre", { class: "line-numbers", "aria-hidden": "true" });
    this.place = element("div", { class: "editor" }, this.lines, this.area);
  }

  get value() {
    return this.area.value;
  }

  set value(text) {
    this.area.value = text;
  }

  /** Numbers the lines; `mistakes` is the set of marked lines. */
  number(mistakes) {
    const many = this.value.split("\n").length;
    // One text node between marked lines, as an element for each of many lines would take seconds.
    const marked = [...mistakes].filter((line) => line <= many).sort((a, b) => a - b);
    const pieces = [];
    let next = 1;
    const plain = (until) => {
      if (next < until) pieces.push(Array.from({ length: until - next }, (_, place) => `${next + place}\n`).join(""));
      next = until;
    };
    for (const line of marked) {
      plain(line);
      pieces.push(element("span", { class: "mistake" }, `${line}\n`));
      next = line + 1;
    }
    plain(many + 1);
    fill(this.lines, pieces);
    this.lines.scrollTop = this.area.scrollTop;
  }

  /** Goes to a place in the text. */
  select({ line, start, end }) {
    this.area.focus();
    this.area.setSelectionRange(start, end);
    this.area.scrollTop = (line - ABOVE) * (this.area.scrollHeight / this.value.split("\n").length);
  }
}
