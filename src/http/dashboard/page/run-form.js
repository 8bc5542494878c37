// A new run: a built-in scene or a model that is pasted or dropped, settings, the plan before it is queued, mistakes at their
// place in the text.

import { call, get, post } from "./api.js";
import { button, choice, element, fill } from "./dom.js";
import { placeIn, withMember } from "./json-places.js";
import { analysisDefaults, description } from "./schema.js";
import { SettingsFields } from "./settings-fields.js";
import { change, state } from "./state.js";
import { plainWords, settingsSentences } from "./words.js";

/** Milliseconds without a key before the text is checked. */
const PAUSE = 400;
/** Settings that are shown at once. */
const FIRST = ["method", "selection", "events", "max_increments", "arc_length"];
const KINDS = [
  ["", "one path"], ["study", "a study: error against run time"], ["sweep", "a sweep: limit loads against what is varied"],
];
const PLACES = { "": "/v1/jobs", study: "/v1/studies", sweep: "/v1/sweeps" };
/** What is put into a text that is to be a sweep and says nothing of it yet. */
const FIRST_SWEEP = { replace: { "/model/contacts/0/friction": [0.1, 0.2, 0.3, 0.4, 0.5] } };
/** Lines above a mistake that stay in sight. */
const ABOVE = 4;

export class RunForm {
  /** Tells `queued(job)`, `queuedStudy(study)` and `queuedSweep(sweep)`. */
  constructor(panel, told) {
    this.panel = panel;
    this.told = told;
    this.scene = null;
    this.asked = 0;
    this.fields = new Map();
    this.text = element("textarea", {
      id: "request", spellcheck: "false", rows: 22, "aria-label": "job request (JSON)", oninput: () => this.edited(),
    });
    this.lines = element("pre", { class: "line-numbers", "aria-hidden": "true" });
    this.text.addEventListener("scroll", () => { this.lines.scrollTop = this.text.scrollTop; });
    this.button = button("Run", () => this.queue(), { id: "queue", class: "main", disabled: true });
    this.verdict = element("div", { id: "verdict", "aria-live": "polite" });
    this.scenes = element("label", {});
    this.kinds = element("label", {});
    this.shows = element("p", { class: "quiet" });
    this.settings = element("div", { id: "settings" });
    const file = element("input", {
      type: "file", accept: ".json,application/json", onchange: (event) => this.take(event.target.files),
    });
    const others = element("label", {}, "Or paste a model, drop a file here, or choose one: ", file);
    fill(panel, element("h2", {}, "New run"), element("div", { class: "choices" }, this.scenes, this.kinds), this.shows,
      element("div", { class: "sides" },
        element("div", {}, element("p", { class: "quiet" }, others),
          element("div", { class: "editor" }, this.lines, this.text),
          element("div", { class: "actions" }, this.button, button("Close", () => change({ run: false }))), this.verdict),
        element("div", {}, element("h3", {}, "Settings"), this.settings)));
    panel.addEventListener("dragover", (event) => event.preventDefault());
    panel.addEventListener("drop", (event) => {
      if (event.dataTransfer.files.length === 0) return;
      event.preventDefault();
      this.take(event.dataTransfer.files);
    });
  }

  get isStudy() {
    return state().as === "study";
  }

  get isSweep() {
    return state().as === "sweep";
  }

  /** The service is back. */
  recover() {
    if (!this.panel.hidden) this.show();
  }

  async show() {
    this.panel.hidden = !state().run;
    if (this.panel.hidden) return;
    try {
      this.known ??= (await get("/v1/scenes")).scenes;
      await this.drawSettings();
      const wanted = state().scene || this.known[0].name;
      fill(this.scenes, "Scene ", choice({
        id: "scene", "data-key": "scene", onchange: (event) => change({ scene: event.target.value }),
      }, [
        ...(wanted.startsWith("job:") ? [[wanted, "the model of a job"]] : []), ...this.known.map(({ name }) => [name, name]),
      ], wanted));
      fill(this.kinds, "Trace ", choice({
        id: "kind", "data-key": "kind", onchange: (event) => change({ as: event.target.value }),
      }, KINDS, state().as));
      this.shows.textContent = this.known.find(({ name }) => name === wanted)?.shows ?? "";
      if (this.scene !== wanted) {
        const place = wanted.startsWith("job:") ? `/v1/jobs/${wanted.slice(4)}/request`
          : `/v1/scenes/${encodeURIComponent(wanted)}`;
        // As it is written: who wrote it has put on one line what belongs together.
        this.text.value = await (await call(place)).text();
        this.scene = wanted;
      }
      this.sweepOrNot();
      this.edited();
    } catch (problem) {
      fill(this.verdict, element("p", { class: "bad", role: "alert" }, problem.message),
        button("Try again", () => this.show()));
    }
  }

  /** Fields for each part of the request that holds settings. */
  async drawSettings() {
    const wanted = this.isStudy ? ["study", "analysis"] : ["analysis"];
    if (this.settings.dataset.of === wanted.join()) return;
    const document = await description();
    this.fields = new Map(wanted.map((name) => {
      const schema = document.components.schemas.StudyRequest.properties[name];
      const first = name === "study" ? ["arc_lengths", "methods", "repeats", "reference"] : FIRST;
      return [name, new SettingsFields(document, schema, first, (value) => this.set(name, value))];
    }));
    fill(this.settings, [...this.fields.values()].map(({ place }) => place));
    this.settings.dataset.of = wanted.join();
  }

  /** A field has been changed. */
  set(name, value) {
    this.text.value = withMember(this.text.value, name, Object.keys(value).length ? value : undefined);
    this.edited();
  }

  /** A sweep has a member of its own, which nothing else takes. */
  sweepOrNot() {
    let request = null;
    try {
      request = JSON.parse(this.text.value);
    } catch {
      return;
    }
    if (request === null || typeof request !== "object" || this.isSweep === "sweep" in request) return;
    if (this.isSweep) {
      this.text.value = withMember(this.text.value, "sweep", FIRST_SWEEP);
    } else {
      delete request.sweep;
      this.text.value = JSON.stringify(request, null, 2);
    }
  }

  async take([file]) {
    if (!file) return;
    this.text.value = await file.text();
    this.edited();
  }

  edited() {
    this.button.disabled = true;
    this.button.textContent = this.isStudy ? "Run the study" : this.isSweep ? "Run the sweep" : "Run";
    this.number(new Map());
    let request = null;
    try {
      request = JSON.parse(this.text.value);
    } catch {
      // The service says what is wrong; until then no field can be put into the text.
    }
    const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
    for (const [name, fields] of this.fields) {
      const value = isObject(request) ? request[name] ?? {} : null;
      fields.show(isObject(value) ? value : null);
    }
    clearTimeout(this.soon);
    this.soon = setTimeout(() => this.check(), PAUSE);
  }

  number(mistakes) {
    const many = this.text.value.split("\n").length;
    // Texts between the marked ones: a line of its own for each of many lines takes the page seconds.
    const marked = [...mistakes.keys()].filter((line) => line <= many).sort((a, b) => a - b);
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
    this.lines.scrollTop = this.text.scrollTop;
  }

  get place() {
    return PLACES[state().as];
  }

  async check() {
    const asked = ++this.asked;
    const text = this.text.value;
    const { isStudy, isSweep } = this;
    try {
      const [plan, defaults] = await Promise.all([post(`${this.place}?validate=true`, text), analysisDefaults()]);
      if (asked !== this.asked) return;
      if (isSweep) {
        fill(this.verdict, element("h3", {}, "Plan"), element("p", {}, `${plan.runs} paths, each a job of its own.`));
        this.button.disabled = false;
        return;
      }
      const scene = isStudy ? plan.scene : plan;
      const sentences = settingsSentences(JSON.parse(text), scene, defaults);
      fill(this.verdict, element("h3", {}, "Plan"), element("ul", { class: "plan" },
        [...(isStudy ? [studySentence(plan)] : []), ...sentences].map((words) => element("li", {}, words)),
        scene.left_out.map(({ what, why }) => element("li", {}, element("b", {}, `Left out: ${what}. `), `${why}.`))));
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
        found.map(({ line, start, end, pointer, detail }) => element("li", {}, button([element("b", {}, `Line ${line}`),
          pointer ? ` (${pointer})` : "", `: ${detail}`], () => {
          this.text.focus();
          this.text.setSelectionRange(start, end);
          this.text.scrollTop = (line - ABOVE) * (this.text.scrollHeight / text.split("\n").length);
        }, { class: "plain" })))));
  }

  async queue() {
    this.button.disabled = true;
    const tell = this.isStudy ? this.told.queuedStudy : this.isSweep ? this.told.queuedSweep : this.told.queued;
    try {
      tell(await post(this.place, this.text.value));
    } catch (problem) {
      this.refused(problem, this.text.value);
    }
    this.button.disabled = false;
  }
}

function studySentence({ methods, values, parameter, repeats, runs, reference_is: reference }) {
  return `${runs} paths: ${methods.join(", ")}, each with ${plainWords(parameter)} ${values.join(", ")}, timed ${repeats} times; `
    + `errors against the ${reference}.`;
}
