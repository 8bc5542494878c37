// The heading of a job: its name, progress, stop reason and actions.

import { element, fill } from "./dom.js";
import { jobActions } from "./job-actions.js";
import { addressOfJob } from "./state.js";
import { counted, isGoingOn, nameOf, sentence, statusOf, statusWords, stopSentence } from "./words.js";

export class JobHeading {
  /** Tells `changed()` where the lists are to be read again, `said(words)` what is refused, `titled(words)`. */
  constructor(place, told) {
    this.told = told;
    this.summary = element("div", {});
    this.actions = element("div", {});
    fill(place, this.summary, this.actions);
  }

  /** The path is being loaded. */
  prepare() {
    fill(this.summary, element("p", { class: "quiet" }, "Loading the path …"));
    this.draw(null);
  }

  /** `others`: the other paths that are drawn; `run`: of a sweep, in words. */
  show(path, others, run) {
    const { job } = path;
    // The first point, of index 0, is no increment.
    const kept = path.index.filter((index) => index > 0).length;
    const all = path.last() ?? 0;
    const many = kept === all ? `${counted(all, "increment")}. ` : `${counted(all, "increment")}, ${kept} of them kept. `;
    const name = run ? `${nameOf(job)}: ${run}` : nameOf(job);
    this.told.titled(others ? `${name} and ${others} more` : name);
    fill(this.summary, element("div", { class: "bar" }, element("h2", {}, name),
      element("span", { class: `status ${job.status}`, id: "status", "data-status": job.status }, statusOf(job))),
    element("p", { id: "stop" }, many, isGoingOn(job) ? `The job ${statusWords(job.status)}.` : stopSentence(job),
      job.note ? element("span", { id: "note" }, ` ${sentence(job.note)}`) : null,
      job.parent ? element("span", {}, " It follows ", element("a", {
        href: addressOfJob(job.parent.job, job.id), "data-key": "parent",
      }, "another job"), ` from increment ${job.parent.increment} in direction ${job.parent.direction}.`) : null),
    path.problem ? element("p", { class: "bad", role: "alert" }, path.problem) : null);
    this.draw(job);
  }

  /** Replaces the actions only if they change, so that they keep the focus while a path grows. */
  draw(job) {
    const key = job ? `${job.id} ${job.status}` : "";
    if (this.actions.dataset.of === key) return;
    this.actions.dataset.of = key;
    fill(this.actions, job ? jobActions(job, this.told.changed, (problem) => this.told.said(problem.message)) : null);
  }
}
