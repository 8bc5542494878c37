// The form of a new run: a built-in scene or a pasted or dropped model, settings, the plan before it is queued, and mistakes at
// their place in the text.

import { call, get, post } from "./api.js";
import { button, choice, element, fill } from "./dom.js";
import { ModelPreview } from "./model-preview.js";
import { placeIn, withMember, withoutMember } from "./json-places.js";
import { RequestText } from "./request-text.js";
import { SceneChoice } from "./scene-choice.js";
import { analysisDefaults, description } from "./schema.js";
import { SettingsFields } from "./settings-fields.js";
import { change, jobOf, state } from "./state.js";
import { SweepFields } from "./sweep-fields.js";
import { leftOutSentence, plainWords, settingsSentences, warningSentences } from "./words.js";

/** Milliseconds without input before the text is checked. */
const PAUSE = 400;
/** Settings that are always visible. */
const FIRST = ["method", "selection", "events", "max_increments", "arc_length"];
const KINDS = [
  ["", "one path"], ["study", "a study: error against run time"], ["sweep", "a sweep: limit loads against what is varied"],
];
const PLACES = { "": "/v1/jobs", study: "/v1/studies", sweep: "/v1/sweeps" };

export class RunForm {
  /** Tells `queued(job)`, `queuedStudy(study)` and `queuedSweep(sweep)`. */
  constructor(panel, told) {
    this.panel = panel;
    this.told = told;
    this.scene = null;
    this.asked = 0;
    this.fields = new Map();
    this.text = new RequestText({ edited: () => this.edited(), pasted: () => this.scenes.isOwn() });
    this.preview = new ModelPreview();
    this.scenes = new SceneChoice(this.text, { chosen: (scene) => this.choose(scene), edited: () => this.edited() });
    this.button = button("Run", () => this.queue(), { id: "queue", class: "main", disabled: true });
    this.verdict = element("div", { id: "verdict", "aria-live": "polite" });
    this.kinds = element("label", {});
    this.shows = element("p", { class: "quiet" });
    this.settings = element("div", { id: "settings" });
    const file = element("input", {
      type: "file", accept: ".json,application/json", onchange: (event) => {
        const files = [...event.target.files];
        // The same file once more, edited meanwhile, is a change too.
        event.target.value = "";
        this.take(files);
      },
    });
    const others = element("label", {}, "Or paste a model, drop a file here, or choose one: ", file);
    fill(panel, element("h2", {}, "New run"), element("div", { class: "choices" }, this.scenes.place, this.kinds), this.shows,
      this.scenes.note,
      element("div", { class: "sides" },
        element("div", {}, element("p", { class: "quiet" }, others),
          this.text.place,
          element("div", { class: "actions" }, this.button, button("Close", () => change({ run: false }))), this.verdict),
        element("div", {}, this.preview.place, element("h3", {}, "Settings"), this.settings)));
    // Beside the form, too: a browser leaves the page for a file that is dropped on it.
    addEventListener("dragover", (event) => { if (event.dataTransfer?.types.includes("Files")) event.preventDefault(); });
    addEventListener("drop", (event) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      if (!panel.hidden) this.take(event.dataTransfer.files);
    });
  }

  get isStudy() {
    return state().as === "study";
  }

  get isSweep() {
    return state().as === "sweep";
  }

  /** The scene whose request is asked for. */
  get wanted() {
    return state().scene || (this.known?.[0].name ?? "");
  }

  /** The service can be reached again. */
  recover() {
    if (!this.panel.hidden) this.show();
  }

  async show() {
    this.panel.hidden = !state().run;
    if (this.panel.hidden) return;
    try {
      this.known ??= (await get("/v1/scenes")).scenes;
      await this.drawSettings();
      const { wanted } = this;
      fill(this.kinds, "Trace ", choice({
        id: "kind", "data-key": "kind", onchange: (event) => change({ as: event.target.value }),
      }, KINDS, state().as));
      this.shows.textContent = this.known.find(({ name }) => name === wanted)?.shows ?? "";
      if (this.scene !== wanted || this.again !== state().again) await this.load(wanted);
      this.sweepOrNot();
      this.edited();
    } catch (problem) {
      fill(this.verdict, element("p", { class: "bad", role: "alert" }, problem.message),
        button("Try again", () => this.show()));
    }
  }

  /** Puts the request of a scene into the text, with its original layout. */
  async load(scene) {
    const { again } = state();
    const id = jobOf(scene);
    const text = await (await call(id ? `/v1/jobs/${id}/request` : `/v1/scenes/${encodeURIComponent(scene)}`)).text();
    Object.assign(this, { scene, again, sweep: null, switched: null });
    this.scenes.put(text, scene);
  }

  /** A scene has been chosen, or the current one again, which is then restored. */
  choose(scene) {
    if (!scene) return;
    this.scene = null;
    if (scene === state().scene) this.show();
    else change({ scene });
  }

  /** Fields for each part of the request that holds settings. */
  async drawSettings() {
    const wanted = [...(state().as ? [state().as] : []), "analysis"];
    if (this.settings.dataset.of === wanted.join()) return;
    const document = await description();
    this.fields = new Map(wanted.map((name) => {
      if (name === "sweep") return [name, new SweepFields((value) => this.set(name, value))];
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

  /** Only a sweep may have the member `sweep`. */
  sweepOrNot() {
    let request = null;
    try {
      request = JSON.parse(this.text.value);
    } catch {
      return;
    }
    if (!isObject(request) || this.isSweep === "sweep" in request) return;
    const before = this.text.value;
    if (!this.isSweep) this.sweep = request.sweep;
    // Restores the earlier text if nothing has been changed since.
    const now = this.switched?.now === before ? this.switched.before
      : this.isSweep ? withMember(before, "sweep", this.sweep ?? firstSweep(request)) : withoutMember(before, "sweep");
    this.switched = { before, now };
    this.scenes.adapt(now);
  }

  async take([file]) {
    if (!file) return;
    this.scenes.put(await file.text(), null);
    this.edited();
  }

  edited() {
    this.button.disabled = true;
    this.button.textContent = this.isStudy ? "Run the study" : this.isSweep ? "Run the sweep" : "Run";
    this.text.number([]);
    this.preview.later(this.text.value);
    this.scenes.draw(this.known ?? [], this.wanted);
    // A text that has been changed is not what the scene shows.
    this.shows.hidden = this.scenes.isChanged;
    let request = null;
    try {
      request = JSON.parse(this.text.value);
    } catch {
      // The service reports the mistake; until it is corrected no field can change the text.
    }
    for (const [name, fields] of this.fields) {
      const value = isObject(request) ? request[name] ?? {} : null;
      fields.show(isObject(value) ? value : null, request);
    }
    clearTimeout(this.soon);
    this.soon = setTimeout(() => this.check(), PAUSE);
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
        fill(this.verdict, element("h3", {}, "Plan"), element("p", {}, `${plan.runs} paths, each a job of its own${
          plan.refine ? `, and up to ${plan.refine} more where the response changes most` : ""}.`),
        element("ul", { class: "plan" }, warningSentences(plan).map((words) => element("li", {}, element("b", {}, "Warning: "), words))));
        this.button.disabled = false;
        return;
      }
      const scene = isStudy ? plan.scene : plan;
      const sentences = settingsSentences(JSON.parse(text), scene, defaults);
      fill(this.verdict, element("h3", {}, "Plan"), element("ul", { class: "plan" },
        warningSentences(scene).map((words) => element("li", {}, element("b", {}, "Warning: "), words)),
        [...(isStudy ? [studySentence(plan)] : []), ...sentences].map((words) => element("li", {}, words)),
        scene.left_out.map((one) => element("li", {}, element("b", {}, "Left out: "), leftOutSentence(one)))));
      this.button.disabled = false;
    } catch (problem) {
      if (asked === this.asked) this.refused(problem, text);
    }
  }

  refused(problem, text) {
    const found = (problem.errors ?? []).map((mistake) => ({ ...mistake, ...placeIn(text, mistake) }));
    this.text.number(new Set(found.map(({ line }) => line)));
    fill(this.verdict, element("h3", { class: "bad" }, problem.title || "Not accepted"),
      found.length === 0 ? element("p", { class: "bad" }, problem.message) : element("ul", { class: "mistakes" },
        found.map((mistake) => element("li", {}, button([element("b", {}, `Line ${mistake.line}`),
          mistake.pointer ? ` (${mistake.pointer})` : "", `: ${mistake.detail}`], () => this.text.select(mistake),
        { class: "plain" })))));
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

/** The default sweep of a text without one: over the friction, or else over the first stiffness. */
function firstSweep({ model }) {
  if (model?.contacts?.length) return { replace: { "/model/contacts/0/friction": [0.1, 0.2, 0.3, 0.4, 0.5] } };
  const [name, stiffness] = Object.entries(model?.elements?.[0] ?? {}).find(([key]) => key.endsWith("stiffness")) ?? [];
  if (typeof stiffness !== "number") return { replace: { "/analysis/arc_length/max": [0.1, 0.05, 0.025] } };
  return { replace: { [`/model/elements/0/${name}`]: [0.5, 1, 2].map((times) => times * stiffness) } };
}

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

function studySentence({ methods, values, parameter, repeats, runs, reference_is: reference }) {
  return `${runs} paths: ${methods.join(", ")}, each with ${plainWords(parameter)} ${values.join(", ")}, timed ${repeats} times; `
    + `errors against the ${reference}.`;
}
