// The rows of the lists: a job, the runs of a sweep under one heading, a study, a sweep, a curve.

import { element } from "./dom.js";
import {
  addressOfCurve, addressOfJob, addressOfStudy, addressOfSweep, change, openCurve, openJob, openStudy, openSweep, state,
} from "./state.js";
import { placeWords, runWords } from "./sweep-values.js";
import { ago, counted, isGoingOn, nameOf, statusOf } from "./words.js";

/** Sweep id to whether the reader has opened or closed the list of its runs. */
const openedByHand = new Map();
/** Loaded after all that a first view needs. */
const thumbnails = import("./thumbnails.js");

/** A link within the page; with a key held it opens as links do. */
function within(address, open, attributes, words) {
  return element("a", {
    href: address, ...attributes,
    onclick: (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey || event.altKey) return;
      event.preventDefault();
      open();
    },
  }, words);
}

function row(task, { isChosen, before, link, told, done, most, kind }) {
  return element("li", { class: [isChosen ? "chosen" : "", kind ?? ""].join(" ").trim() || null }, before, link,
    element("small", {}, element("span", { class: `status ${task.status}` }, statusOf(task)), `, ${told}`),
    isGoingOn(task) ? element("progress", { max: most, value: done, "aria-label": "progress" }) : null);
}

/** A job; `words`: what it is called under the heading of its sweep. */
function jobRow(job, words = null) {
  const { jobs: shown, study, sweep, curve } = state();
  const isOther = study || sweep || curve;
  const place = isOther ? -1 : shown.indexOf(job.id);
  const { increments, max_increments: most } = job.progress;
  const others = shown.filter((id) => id !== job.id);
  const draw = element("input", {
    type: "checkbox", checked: place >= 0, "data-key": `draw ${job.id}`, "aria-label": `draw ${words ?? nameOf(job)} with the others`,
    title: "draw with the others",
    onchange: (event) => change({
      jobs: event.target.checked ? [...others, job.id] : others, run: false, study: null, sweep: null, curve: null,
      ...(place === 0 ? { at: null } : {}), ...(isOther ? { abscissa: null, ordinate: null } : {}),
    }),
  });
  const link = within(addressOfJob(job.id), () => openJob(job.id),
    { "data-key": `open ${job.id}`, "aria-current": place === 0 ? "true" : null, title: `job ${job.id}` }, words ?? nameOf(job));
  const branch = job.parent ? `, branch at increment ${job.parent.increment}, direction ${job.parent.direction}` : "";
  const told = `${counted(increments, "increment")}, ${ago(job.created_at)}${branch}${words ? `, run ${job.sweep.run}` : ""}`;
  const picture = element("span", { class: "thumbnail-place" });
  // A row without its picture is still of use.
  thumbnails.then(({ thumbnail }) => picture.append(thumbnail(job)), () => {});
  return row(job, {
    isChosen: place === 0, before: [draw, picture], link, told, done: increments, most, kind: "pictured",
  });
}

/** Jobs newest first, with the runs of each sweep under one heading, in the order of the runs. `sweepOf(id)`: the listed sweep,
 *  or undefined; `isSearched`: only what was searched for is here, and is to be seen. */
export function jobRows(jobs, sweepOf, isSearched) {
  const groups = Object.groupBy(jobs.filter(({ sweep }) => sweep), ({ sweep }) => sweep.sweep);
  const rows = [];
  for (const job of jobs) {
    const id = job.sweep?.sweep;
    if (!id) rows.push(jobRow(job));
    else if (groups[id][0] === job) rows.push(runRows(id, groups[id], sweepOf(id), isSearched));
  }
  return rows;
}

function runRows(id, runs, sweep, isSearched) {
  const inOrder = runs.toSorted((a, b) => a.sweep.run - b.sweep.run);
  const shown = state().jobs;
  const all = sweep?.progress.of;
  const many = all && all > runs.length ? `${runs.length} of ${all} runs` : counted(runs.length, "run");
  const isOpen = isSearched || (openedByHand.get(id) ?? runs.some((job) => shown.includes(job.id)));
  const folded = element("details", { open: isOpen },
    element("summary", {
      "data-key": `runs ${id}`,
      // Told apart from the toggling that drawing the list anew brings about.
      onclick: () => openedByHand.set(id, !folded.open),
    }, `Sweep of ${nameOf(runs[0])}: `, element("span", { class: "quiet" }, many)),
    element("ul", { class: "tasks runs", "aria-label": `runs of the sweep of ${nameOf(runs[0])}` },
      inOrder.map((job) => jobRow(job, runWords(sweep, job.sweep.run) ?? `run ${job.sweep.run}`))));
  return element("li", { class: "group" }, folded);
}

export function studyRow(study) {
  const isChosen = state().study === study.id;
  const { runs, of } = study.progress;
  const link = within(addressOfStudy(study.id), () => openStudy(study.id),
    { "data-key": `open ${study.id}`, "aria-current": isChosen ? "true" : null }, nameOf(study));
  return row(study, {
    isChosen, before: element("span", {}), link, told: `${runs} of ${of} paths, ${ago(study.created_at)}`, done: runs, most: of,
  });
}

export function sweepRow(sweep) {
  const isChosen = state().sweep === sweep.id;
  const { ended, of } = sweep.progress;
  const link = within(addressOfSweep(sweep.id), () => openSweep(sweep.id),
    { "data-key": `open ${sweep.id}`, "aria-current": isChosen ? "true" : null }, nameOf(sweep));
  return row(sweep, {
    isChosen, before: element("span", {}), link, told: `${ended} of ${of} runs, ${ago(sweep.created_at)}`, done: ended, most: of,
  });
}

export function curveRow(curve) {
  const isChosen = state().curve === curve.id;
  const { points, of } = curve.progress;
  const link = within(addressOfCurve(curve.id), () => openCurve(curve.id),
    { "data-key": `open ${curve.id}`, "aria-current": isChosen ? "true" : null }, nameOf(curve));
  return row(curve, {
    isChosen, before: element("span", {}), link, told: `${counted(points, "point")} over ${placeWords(curve.plan.curve.parameter)}, ${ago(curve.created_at)}`,
    done: points, most: of,
  });
}
