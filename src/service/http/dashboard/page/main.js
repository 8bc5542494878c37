// Starts the page, and shows the form, study, sweep, curve or jobs of the state.

import { callsList } from "./calls-list.js";
import { CurveView } from "./curve-view.js";
import { button, byId, element, fill } from "./dom.js";
import { JobView } from "./job-view.js";
import { listsDrawer } from "./lists-drawer.js";
import { onThemeChange } from "./plot-style.js";
import { plotlyLoaded, warmPlotlyUp } from "./plotly-loaded.js";
import { isReached, onReach } from "./reach.js";
import { RunForm } from "./run-form.js";
import { change, isSameView, onChange, openCurve, openJob, openStudy, openSweep, state } from "./state.js";
import { StudyView } from "./study-view.js";
import { SweepView } from "./sweep-view.js";
import { TaskLists } from "./task-lists.js";
import { tokenPrompt } from "./token-prompt.js";

/** Shows a notice; `again`, if given, is called by its button to try again. */
function say(words, again) {
  const place = byId("notice");
  place.hidden = !words;
  fill(place, element("p", {}, words), again ? button("Try again", () => { say("Loading …"); again(); }) : null);
  if (words) place.scrollIntoView({ block: "nearest" });
}

function connection() {
  const isLost = !isReached() || [jobView, ...findings].some((one) => !one.isConnected);
  const place = byId("connection");
  place.textContent = isLost ? "Disconnected; trying again …" : "";
  place.classList.toggle("bad", isLost);
}

function titled(words) {
  document.title = words ? `${words} – arcslip` : "arcslip";
}

tokenPrompt(byId("token"));
const lists = new TaskLists(byId("lists"));
const changed = () => lists.load();
const jobView = new JobView({
  // What the address has wrong stays told while its paths are shown.
  said: (words, again) => say(words || (unreadable() ?? ""), again), titled, changed, connection, continued: (curve) => { changed(); openCurve(curve.id); },
});
const told = { failed: (problem) => say(problem.message), shown: (words) => { say(""); titled(words); }, changed, connection };
const studyView = new StudyView(byId("study"), told);
const sweepView = new SweepView(byId("sweep"), told);
const curveView = new CurveView(byId("curve"), told);
const findings = [studyView, sweepView, curveView];
const runForm = new RunForm(byId("run"), {
  queued: (job) => { changed(); openJob(job.id); },
  queuedStudy: (study) => { changed(); openStudy(study.id); },
  queuedSweep: (sweep) => { changed(); openSweep(sweep.id); },
});
callsList(byId("calls"));

/** Says of an address that names what cannot be the id of anything. */
function unreadable() {
  const now = state();
  const given = new URLSearchParams(location.search);
  for (const name of ["jobs", "study", "sweep", "curve"]) {
    const known = (name === "jobs" ? now.jobs : [now[name]]).map((id) => id?.toLowerCase());
    const wrong = (given.get(name) ?? "").toLowerCase().split(",").find((id) => id && !known.includes(id));
    if (wrong) return `The address has “${wrong}” where the id of a ${name.replace("jobs", "job")} is expected. Choose one from the list.`;
  }
  return null;
}

function view(before) {
  const now = state();
  const isOther = !before || !isSameView(before, now);
  if (before) lists.changed(before);
  if (!before || before.run !== now.run || before.scene !== now.scene || before.as !== now.as
    || before.again !== now.again) runForm.show();
  if (isOther) {
    // What is shown now begins at the top.
    if (before) scrollTo({ top: 0 });
    titled(now.run ? "New run" : "");
    say(now.run ? "" : unreadable() ?? (now.jobs.length ? "" : now.study || now.sweep || now.curve ? "Loading …" : "Choose a job, or start one with New run."));
    studyView.show(now.run ? null : now.study);
    sweepView.show(now.run ? null : now.sweep);
    curveView.show(now.run ? null : now.curve);
    jobView.view();
    connection();
  } else if (before.abscissa !== now.abscissa || before.ordinate !== now.ordinate) {
    jobView.draw();
  } else if (before.at !== now.at) {
    jobView.choose();
  }
}

onChange(view);
onReach((isBack) => {
  connection();
  if (!isBack) return;
  lists.load();
  // Fetches what could not be fetched meanwhile.
  for (const one of [runForm, ...findings, jobView]) one.recover();
});
onThemeChange(() => { for (const one of findings) one.draw(); jobView.repaint(); });
byId("skip").addEventListener("click", (event) => {
  event.preventDefault();
  byId("view").focus();
});
listsDrawer(byId("open-lists"), byId("lists"));
byId("open-run").addEventListener("click", () => change({ run: true }));
addEventListener("keydown", (event) => {
  if (event.target.matches("input, textarea, select") || event.ctrlKey || event.metaKey || event.altKey) return;
  const step = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity }[event.key];
  if (step && !state().run) jobView.step(step);
  // Where something has the focus, the key is its own.
  if (event.key === " " && !event.target.matches("button, summary, a") && !state().run) jobView.structure.play(event);
});
view(null);
// If there is something to draw, it is drawn first.
const ready = state().jobs.length || state().study || state().sweep || state().curve ? plotlyLoaded : warmPlotlyUp;
ready().catch((problem) => say(problem.message));
