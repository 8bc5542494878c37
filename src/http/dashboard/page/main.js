// Starts the page, and carries what happens in one part to the others.

import { keepToken, onTokenAsked } from "./api.js";
import { Diagnostics } from "./diagnostics.js";
import { Directions } from "./directions.js";
import { byId, element, fill, onceAFrame } from "./dom.js";
import { JobsList } from "./jobs-list.js";
import { PathData } from "./path-data.js";
import { PathPlot } from "./path-plot.js";
import { onThemeChange } from "./plot-style.js";
import { plotlyLoaded } from "./plotly-loaded.js";
import { RunForm } from "./run-form.js";
import { change, onChange, state } from "./state.js";
import { StructurePlot } from "./structure-plot.js";
import { isGoingOn, statusWords, stopSentence } from "./words.js";

/** Milliseconds between pictures of the structure of a path that grows: the path itself is drawn first. */
const STRUCTURE = 300;
let structureWaits = null;
/** The same for the figures. */
const FIGURES = 2000;
let diagnosticsWait = null;
/** Paths that are held, drawn or not: id to path. */
const held = new Map();

const jobsList = new JobsList(byId("jobs"), (problem) => say(problem.message));
const pathPlot = new PathPlot(byId("path"), {
  chosen: (id, index) => chooseAt(id, index),
  hovered: (id, index) => { if (id === state().jobs[0]) structurePlot.choose(index); },
  left: () => structurePlot.choose(state().at),
  abscissa: (abscissa) => change({ abscissa }),
});
const structurePlot = new StructurePlot(byId("structure"), { chosen: (index) => change({ at: index }) });
const directions = new Directions(byId("directions"), {
  followed: (job) => { jobsList.load(); change({ jobs: [...state().jobs, job.id] }); },
});
const diagnostics = new Diagnostics(byId("diagnostics"));
const runForm = new RunForm(byId("run"), {
  queued: (job) => { jobsList.load(); change({ jobs: [job.id], at: null, abscissa: null, run: false }); },
});
const grown = onceAFrame(() => {
  pathPlot.grow();
  heading();
  diagnosticsWait ??= setTimeout(() => {
    diagnosticsWait = null;
    diagnostics.draw();
  }, FIGURES);
  if (state().at !== null || structureWaits) return;
  structureWaits = setTimeout(() => {
    structureWaits = null;
    if (state().at === null) structurePlot.choose(null);
  }, STRUCTURE);
});

function told(what, path) {
  if (!isShown(path)) return;
  if (what === "connection") connection();
  else if (what === "grown") grown();
  else if (what === "loaded") drawAll();
  else {
    connection();
    drawAll();
    jobsList.load();
  }
}

const isShown = (path) => state().jobs.includes(path.id);

function chooseAt(id, index) {
  const { jobs } = state();
  // A point of another path makes that one the first.
  change(id === jobs[0] ? { at: index } : { jobs: [id, ...jobs.filter((other) => other !== id)], at: index });
}

function connection() {
  const isLost = state().jobs.some((id) => held.get(id)?.isConnected === false);
  const place = byId("connection");
  place.textContent = isLost ? "Disconnected; trying again …" : "";
  place.classList.toggle("bad", isLost);
}

function say(words) {
  const place = byId("nothing");
  place.hidden = !words;
  place.textContent = words;
}

function paths() {
  return state().jobs.map((id) => held.get(id)).filter((path) => path?.request && path.columns.size > 0);
}

function heading() {
  const path = held.get(state().jobs[0]);
  if (!path?.job) return;
  const { job } = path;
  const many = path.index.length;
  fill(byId("heading"), element("div", { class: "bar" }, element("h2", {}, job.name),
    element("span", { class: `status ${job.status}`, id: "status" }, job.status)),
  element("p", { id: "stop" }, `${many} increments. `, isGoingOn(job) ? `The job ${statusWords(job.status)}.` : stopSentence(job),
    job.parent ? element("span", {}, " It follows ", element("a", {
      href: `/?jobs=${job.parent.job},${job.id}`,
    }, "another job"), ` from increment ${job.parent.increment} in direction ${job.parent.direction}.`) : null),
  path.problem ? element("p", { class: "bad" }, path.problem) : null, isStill(path));
}

/** The buttons are made anew only where they change, so that focus stays on them while a path grows. */
let actions = { key: "", made: null };
function isStill({ job }) {
  const key = `${job.id} ${job.status}`;
  if (actions.key !== key) actions = { key, made: jobsList.actions(job) };
  return actions.made;
}

async function drawAll() {
  const shown = paths();
  const [first] = shown;
  byId("job").hidden = state().run || !first || first.id !== state().jobs[0];
  if (byId("job").hidden) return;
  const abscissa = state().abscissa ?? first.ownAbscissa();
  heading();
  try {
    await Promise.all([plotlyLoaded(), ...shown.map((path) => path.need([abscissa]))]);
  } catch (problem) {
    if (problem.name !== "AbortError") say(problem.message);
    return;
  }
  if (paths()[0] !== first) return;
  say("");
  performance.mark("data");
  await pathPlot.draw(shown, abscissa, state().at);
  performance.mark("painted");
  await structurePlot.show(first, state().at);
  layExact(first);
  directions.choose(first, state().at);
  diagnostics.show(first);
}

/** Lays the exact path over the computed one once that is whole; the picture does not wait for it. */
async function layExact(path) {
  if (isGoingOn(path.job)) return;
  const before = path.exact;
  try {
    await path.exactPath();
  } catch (problem) {
    if (problem.name !== "AbortError") say(problem.message);
    return;
  }
  if (path.exact !== before && path.exact.path && paths()[0] === path) {
    await pathPlot.draw(paths(), state().abscissa ?? path.ownAbscissa(), state().at);
  }
}

function hold() {
  const wanted = state().jobs;
  for (const [id, path] of held) {
    if (!wanted.includes(id)) {
      path.close();
      held.delete(id);
    }
  }
  for (const id of wanted.filter((one) => !held.has(one))) {
    const path = new PathData(id, told);
    held.set(id, path);
    path.load(state().abscissa).catch((problem) => {
      if (problem.name === "AbortError") return;
      path.problem = problem.message;
      say(`The job cannot be shown: ${problem.message}`);
    });
  }
}

function view(before) {
  const now = state();
  const isOther = !before || before.jobs.join() !== now.jobs.join() || before.run !== now.run;
  if (!before || before.status !== now.status) { if (before) jobsList.load(); } else jobsList.draw();
  if (!before || before.run !== now.run || before.scene !== now.scene) runForm.show();
  if (isOther) {
    say(now.run ? "" : now.jobs.length ? "Loading the path …" : "Choose a job, or start one with New run.");
    hold();
    connection();
  }
  if (isOther || before.abscissa !== now.abscissa) {
    drawAll();
  } else if (before.at !== now.at) {
    const [first] = paths();
    if (!first) return;
    pathPlot.choose(now.at);
    structurePlot.choose(now.at);
    directions.choose(first, now.at);
  }
}

function askToken(words) {
  const place = byId("token");
  if (!place.hidden) return;
  place.hidden = false;
  const given = element("input", { type: "password", autocomplete: "off", "aria-label": "token", size: 40 });
  const take = () => { keepToken(given.value.trim()); location.reload(); };
  given.addEventListener("keydown", (event) => { if (event.key === "Enter") take(); });
  fill(place, element("p", {}, `This service asks for a token: ${words}`), given,
    element("button", { type: "button", onclick: take }, "Use it"));
}

onTokenAsked(askToken);
onChange(view);
onThemeChange(drawAll);
byId("open-run").addEventListener("click", () => change({ run: true }));
addEventListener("keydown", (event) => {
  if (event.target.matches("input, textarea, select") || event.ctrlKey || event.metaKey || event.altKey) return;
  const path = held.get(state().jobs[0]);
  const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (!step || !path?.index.length || event.target.closest(".js-plotly-plot")) return;
  const place = Math.max(0, path.placeOf(state().at ?? path.last()));
  change({ at: path.index[Math.min(path.index.length - 1, Math.max(0, place + step))] });
});
view(null);
plotlyLoaded().catch((problem) => say(problem.message));
