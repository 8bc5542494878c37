// The lists of jobs, of studies and of sweeps beside the view: progress, filter, which paths are drawn together.

import { choice, element, fill } from "./dom.js";
import {
  addressOfJob, addressOfStudy, addressOfSweep, change, isSameView, openJob, openStudy, openSweep, state, STATUSES,
} from "./state.js";
import { TaskList } from "./task-list.js";
import { ago, isGoingOn, nameOf } from "./words.js";

export class TaskLists {
  constructor(place) {
    this.jobs = new TaskList({
      title: "Jobs", of: "jobs", row: jobRow,
      empty: (status) => (status ? `No job is ${status}.` : "There are no jobs yet: start with New run."),
    });
    this.studies = new TaskList({
      title: "Studies", of: "studies", row: studyRow,
      empty: (status) => (status ? `No study is ${status}.` : "None yet: a new run can be a study, too."),
    });
    this.sweeps = new TaskList({
      title: "Sweeps", of: "sweeps", row: sweepRow,
      empty: (status) => (status ? `No sweep is ${status}.` : "None yet: a new run can be a sweep, too."),
    });
    this.lists = [this.jobs, this.studies, this.sweeps];
    this.filter = element("label", {}, "Show ");
    fill(place, element("div", { class: "bar" }, element("h2", {}, "Jobs"), this.filter), this.jobs.place,
      element("h2", { class: "second" }, "Studies"), this.studies.place,
      element("h2", { class: "second" }, "Sweeps"), this.sweeps.place);
    this.drawFilter();
    this.load();
  }

  load() {
    for (const list of this.lists) list.load();
  }

  /** The view has changed. */
  changed(before) {
    const { status } = state();
    if (before.status !== status) {
      this.drawFilter();
      this.load();
    } else if (!isSameView(before, state())) {
      for (const list of this.lists) list.draw();
    }
  }

  drawFilter() {
    fill(this.filter, "Show ", choice({
      "data-key": "filter", id: "filter", onchange: (event) => change({ status: event.target.value }),
    }, [["", "all"], ...STATUSES.map((name) => [name, name])], state().status));
  }
}

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

function row(task, isChosen, before, link, told, done, most) {
  return element("li", { class: isChosen ? "chosen" : null }, before, link,
    element("span", { class: `status ${task.status}` }, task.status), element("small", {}, told),
    isGoingOn(task) ? element("progress", { max: most, value: done, "aria-label": "progress" }) : null);
}

function jobRow(job) {
  const { jobs: shown, study, sweep } = state();
  const place = study || sweep ? -1 : shown.indexOf(job.id);
  const { increments, max_increments: most } = job.progress;
  const others = shown.filter((id) => id !== job.id);
  const draw = element("input", {
    type: "checkbox", checked: place >= 0, "data-key": `draw ${job.id}`, "aria-label": `draw ${nameOf(job)} with the others`,
    title: "draw with the others",
    onchange: (event) => change({
      jobs: event.target.checked ? [...others, job.id] : others, run: false, study: null, sweep: null, ...(place === 0 ? { at: null } : {}),
      ...(study || sweep ? { abscissa: null, ordinate: null } : {}),
    }),
  });
  const link = within(addressOfJob(job.id), () => openJob(job.id),
    { "data-key": `open ${job.id}`, "aria-current": place === 0 ? "true" : null }, nameOf(job));
  const branch = job.parent ? `, branch at increment ${job.parent.increment}, direction ${job.parent.direction}` : "";
  const told = `${increments} increments, ${ago(job.created_at)}${branch}${job.sweep ? `, run ${job.sweep.run} of a sweep` : ""}`;
  return row(job, place === 0, draw, link, told, increments, most);
}

function studyRow(study) {
  const isChosen = state().study === study.id;
  const { runs, of } = study.progress;
  const link = within(addressOfStudy(study.id), () => openStudy(study.id),
    { "data-key": `open ${study.id}`, "aria-current": isChosen ? "true" : null }, nameOf(study));
  return row(study, isChosen, element("span", {}), link, `${runs} of ${of} paths, ${ago(study.created_at)}`, runs, of);
}

function sweepRow(sweep) {
  const isChosen = state().sweep === sweep.id;
  const { ended, of } = sweep.progress;
  const link = within(addressOfSweep(sweep.id), () => openSweep(sweep.id),
    { "data-key": `open ${sweep.id}`, "aria-current": isChosen ? "true" : null }, nameOf(sweep));
  return row(sweep, isChosen, element("span", {}), link, `${ended} of ${of} runs, ${ago(sweep.created_at)}`, ended, of);
}
