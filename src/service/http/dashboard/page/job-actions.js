// What can be done with a job, a study or a sweep: cancel, delete, download, run again.

import { call } from "./api.js";
import { askingButton, button, byId, element } from "./dom.js";
import { download, downloadIncrements } from "./downloads.js";
import { change, openModelOf, state } from "./state.js";
import { isGoingOn, nameOf } from "./words.js";

/** `done()` is called after what changes the lists, `failed(problem)` where something is refused. */
export function jobActions(job, done, failed) {
  const { id } = job;
  const then = doing(done, failed);
  return element("div", { class: "actions" },
    isGoingOn(job) ? button("Cancel", then(() => call(`/v1/jobs/${id}/cancel`, { method: "POST" }))) : null,
    job.status === "failed" && !job.sweep ? button("Queue again", then(async () => {
      await call(`/v1/jobs/${id}/retry`, { method: "POST" });
      // What is shown of the path is of its end before.
      location.reload();
    })) : null,
    button("Path (csv)", then(() => download(`/v1/jobs/${id}/path.csv`, `path-${id}.csv`))),
    button("Increments (json)", then(() => downloadIncrements(id))),
    button("Model (json)", then(() => download(`/v1/jobs/${id}/request`, `request-${id}.json`))),
    button("Run again, changed", () => openModelOf(id)),
    askingButton("Delete", `Delete “${nameOf(job)}” and all its increments?`, then(async () => {
      await call(`/v1/jobs/${id}`, { method: "DELETE" });
      leaveFor({ jobs: state().jobs.filter((other) => other !== id), at: null });
    }), { class: "danger", id: "delete" }));
}

export function studyActions(study, done, failed) {
  const { id } = study;
  const then = doing(done, failed);
  const hasFound = study.report !== null;
  return element("div", { class: "actions" },
    isGoingOn(study) ? button("Cancel", then(() => call(`/v1/studies/${id}/cancel`, { method: "POST" }))) : null,
    hasFound ? [
      button("Table (csv)", then(() => download(`/v1/studies/${id}/table.csv`, `study-${id}.csv`))),
      button("Table (text)", then(() => download(`/v1/studies/${id}/table.txt`, `study-${id}.txt`))),
      button("Picture (svg)", then(() => download(`/v1/studies/${id}/picture.svg`, `study-${id}.svg`))),
    ] : [],
    askingButton("Delete", `Delete the study “${nameOf(study)}” and all that it has found?`, then(async () => {
      await call(`/v1/studies/${id}`, { method: "DELETE" });
      leaveFor({ study: null });
    }), { class: "danger", id: "delete" }));
}

export function sweepActions(sweep, hasFound, done, failed) {
  const { id } = sweep;
  const then = doing(done, failed);
  return element("div", { class: "actions" },
    isGoingOn(sweep) ? button("Cancel", then(() => call(`/v1/sweeps/${id}/cancel`, { method: "POST" }))) : null,
    hasFound ? [
      button("Table (csv)", then(() => download(`/v1/sweeps/${id}/table.csv`, `sweep-${id}.csv`))),
      button("Table (text)", then(() => download(`/v1/sweeps/${id}/table.txt`, `sweep-${id}.txt`))),
      button("Picture (svg)", then(() => download(`/v1/sweeps/${id}/picture.svg`, `sweep-${id}.svg`))),
    ] : [],
    askingButton("Delete", `Delete the sweep “${nameOf(sweep)}” and all its jobs?`, then(async () => {
      await call(`/v1/sweeps/${id}`, { method: "DELETE" });
      leaveFor({ sweep: null });
    }), { class: "danger", id: "delete" }));
}

/** What had focus is gone: what is shown instead has it. */
function leaveFor(changes) {
  change(changes);
  byId("view").focus();
}

const doing = (done, failed) => (what) => async () => {
  try {
    await what();
    done();
  } catch (problem) {
    failed(problem);
  }
};
