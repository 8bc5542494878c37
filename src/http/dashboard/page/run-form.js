// A new run: a built-in scene or a model that is pasted or dropped, its plan before it is queued, mistakes at their place in
// the text.

import { analysisDefaults, call, get, post } from "./api.js";
import { choice, element, fill } from "./dom.js";
import { change, state } from "./state.js";
import { settingsSentences } from "./words.js";
import { placeIn } from "./json-places.js";

const PAUSE = 400;

export class RunForm {
  /** Tells `queued(job)`. */
  constructor(panel, told) {
    this.panel = panel;
    this.told = told;
    this.scene = null;
    this.asked = 0;
    this.text = element("textarea", {
      id: "request", spellcheck: "false", rows: 22, "aria-label": "job request (JSON)", oninput: () => this.edited(),
      ondragover: (event) => event.preventDefault(), ondrop: (event) => this.dropped(event),
    });
    this.lines = element("pre", { class: "line-numbers", "aria-hidden": "true" });
    this.text.addEventListener("scroll", () => { this.lines.scrollTop = this.text.scrollTop; });
    this.button = element("button", { type: "button", id: "queue", class: "main", disabled: true, onclick: () => this.queue() }, "Run");
    this.verdict = element("div", { id: "verdict", "aria-live": "polite" });
    this.scenes = element("label", {});
    this.shows = element("p", { class: "quiet" });
    fill(panel, element("h2", {}, "New run"), element("div", { class: "choices" }, this.scenes), this.shows,
      element("p", { class: "quiet" }, "Or paste a model here, or drop a file."),
      element("div", { class: "editor" }, this.lines, this.text),
      element("div", { class: "actions" }, this.button,
        element("button", { type: "button", onclick: () => change({ run: false }) }, "Close")), this.verdict);
  }

  async show() {
    this.panel.hidden = !state().run;
    if (this.panel.hidden) return;
    try {
      if (!this.known) {
        this.known = (await get("/v1/scenes")).scenes;
      }
      const wanted = state().scene || this.known[0].name;
      fill(this.scenes, "Scene ", choice({ id: "scene", onchange: (event) => change({ scene: event.target.value }) },
        [...(wanted.startsWith("job:") ? [[wanted, "the model of a job"]] : []),
          ...this.known.map(({ name }) => [name, name])], wanted));
      this.shows.textContent = this.known.find(({ name }) => name === wanted)?.shows ?? "";
      if (this.scene === wanted) return;
      this.scene = wanted;
      const place = wanted.startsWith("job:") ? `/v1/jobs/${wanted.slice(4)}/request` : `/v1/scenes/${wanted}`;
      // As it is written: who wrote it has put on one line what belongs together.
      this.text.value = await (await call(place)).text();
      this.edited();
    } catch (problem) {
      fill(this.verdict, element("p", { class: "bad" }, problem.message));
    }
  }

  async dropped(event) {
    const [file] = event.dataTransfer.files;
    if (!file) return;
    event.preventDefault();
    this.text.value = await file.text();
    this.edited();
  }

  edited() {
    this.button.disabled = true;
    this.number(new Map());
    clearTimeout(this.soon);
    this.soon = setTimeout(() => this.check(), PAUSE);
  }

  number(mistakes) {
    const many = this.text.value.split("\n").length;
    fill(this.lines, [...Array(many).keys()].map((line) => element("span",
      mistakes.has(line + 1) ? { class: "mistake" } : {}, `${line + 1}\n`)));
    this.lines.scrollTop = this.text.scrollTop;
  }

  async check() {
    const asked = ++this.asked;
    const text = this.text.value;
    try {
      const [plan, defaults] = await Promise.all([post("/v1/jobs?validate=true", text), analysisDefaults()]);
      if (asked !== this.asked) return;
      const request = JSON.parse(text);
      fill(this.verdict, element("h3", {}, "Plan"), element("ul", { class: "plan" },
        settingsSentences(request, plan, defaults).map((words) => element("li", {}, words)),
        plan.left_out.map(({ what, why }) => element("li", {}, element("b", {}, `Left out: ${what}. `), `${why}.`))));
      this.button.disabled = false;
    } catch (problem) {
      if (asked === this.asked) this.refused(problem, text);
    }
  }

  refused(problem, text) {
    const found = (problem.errors ?? []).map((mistake) => ({ ...mistake, ...placeIn(text, mistake) }));
    this.number(new Map(found.map(({ line }) => [line, true])));
    fill(this.verdict, element("h3", { class: "bad" }, problem.title || "Not accepted"),
      found.length === 0 ? element("p", { class: "bad" }, problem.message) : element("ul", { class: "mistakes" },
        found.map(({ line, start, end, pointer, detail }) => element("li", {}, element("button", {
          type: "button", class: "plain",
          onclick: () => {
            this.text.focus();
            this.text.setSelectionRange(start, end);
            this.text.scrollTop = (line - 4) * (this.text.scrollHeight / text.split("\n").length);
          },
        }, element("b", {}, `Line ${line}`), pointer ? ` (${pointer})` : "", `: ${detail}`)))));
  }

  async queue() {
    this.button.disabled = true;
    try {
      this.told.queued(await post("/v1/jobs", this.text.value));
    } catch (problem) {
      this.refused(problem, this.text.value);
    }
    this.button.disabled = false;
  }
}
