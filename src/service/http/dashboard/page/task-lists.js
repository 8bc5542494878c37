// The lists of jobs, of studies, of sweeps and of curves beside the view: search, filter, which paths are drawn together.

import { choice, element, fill } from "./dom.js";
import { change, isSameView, state, STATUSES } from "./state.js";
import { TaskList } from "./task-list.js";
import { curveRow, jobRows, studyRow, sweepRow } from "./task-rows.js";

export class TaskLists {
  constructor(place) {
    this.jobs = new TaskList({
      title: "Jobs", of: "jobs",
      rows: (jobs) => jobRows(jobs, (id) => this.sweeps.tasks?.find((sweep) => sweep.id === id), Boolean(state().search)),
      empty: (status) => (status ? `No job is ${status}.` : "There are no jobs yet: start with New run."),
    });
    this.studies = new TaskList({
      title: "Studies", of: "studies", rows: (studies) => studies.map(studyRow),
      empty: (status) => (status ? `No study is ${status}.` : "None yet: a new run can be a study, too."),
    });
    this.sweeps = new TaskList({
      title: "Sweeps", of: "sweeps", rows: (sweeps) => sweeps.map(sweepRow),
      empty: (status) => (status ? `No sweep is ${status}.` : "None yet: a new run can be a sweep, too."),
      // The runs in the list of jobs are named by the values of their sweep.
      come: () => this.jobs.draw(),
    });
    this.curves = new TaskList({
      title: "Curves", of: "curves", rows: (curves) => curves.map(curveRow),
      empty: (status) => (status ? `No curve is ${status}.` : "None yet: they start at a limit point of a path."),
    });
    this.lists = [this.jobs, this.studies, this.sweeps, this.curves];
    this.filter = element("label", {}, "Show ");
    this.search = element("input", {
      type: "search", id: "search", placeholder: "Search name, id, status", value: state().search, autocomplete: "off",
      "aria-label": "search by name, id, status or what ended it", oninput: () => change({ search: this.search.value.trim() }),
    });
    fill(place, element("div", { class: "bar" }, element("h2", {}, "Jobs"), this.filter), this.search, this.jobs.place,
      element("h2", { class: "second" }, "Studies"), this.studies.place,
      element("h2", { class: "second" }, "Sweeps"), this.sweeps.place,
      element("h2", { class: "second" }, "Curves"), this.curves.place);
    this.drawFilter();
    this.load();
  }

  load() {
    for (const list of this.lists) list.load();
  }

  /** The view has changed. */
  changed(before) {
    const { status, search } = state();
    if (this.search.value.trim() !== search) this.search.value = search;
    if (before.status !== status) {
      this.drawFilter();
      this.load();
    } else if (before.search !== search || !isSameView(before, state())) {
      for (const list of this.lists) list.draw();
    }
  }

  drawFilter() {
    fill(this.filter, "Show ", choice({
      "data-key": "filter", id: "filter", onchange: (event) => change({ status: event.target.value }),
    }, [["", "all"], ...STATUSES.map((name) => [name, name])], state().status));
  }
}
