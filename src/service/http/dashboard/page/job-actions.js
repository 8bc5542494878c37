// The actions on a job, a study, a sweep or a curve: cancel, delete, download, run again.

import { call } from "./api.js";
import { askingButton, button, byId, element } from "./dom.js";
import { download, downloadIncrements } from "./downloads.js";
import { change, openModelOf, state } from "./state.js";
import { isGoingOn, nameOf } from "./words.js";

const thumbnails = import("./thumbnails.js");

/** Calls `done()` after an action that changes the lists, `failed(problem)` after a refused one. */
export function jobActions(job, done, failed) {
  const { id } = job;
  const then = doing(done, failed);
  return element("div", { class: "actions" },
    isGoingOn(job) ? button("Cancel", then(() => call(`/v1/jobs/${id}/cancel`, { method: "POST" }))) : null,
    job.status === "failed" && !job.sweep ? button("Queue again", then(async () => {
      await call(`/v1/jobs/${id}/retry`, { method: "POST" });
      // The view shows the state at the earlier end of the path.
      location.reload();
    })) : null,
    button("Path (csv)", then(() => download(`/v1/jobs/${id}/path.csv`, `path-${id}.csv`))),
    button("ParaView (zip)", then(() => download(`/v1/jobs/${id}/results.pvd`, `path-${id}-pvd.zip`))),
    button("Parquet (zip)", then(() => download(`/v1/jobs/${id}/results.parquet`, `path-${id}-parquet.zip`))),
    button("Increments (json)", then(() => downloadIncrements(id))),
    button("Model (json)", then(() => download(`/v1/jobs/${id}/request`, `request-${id}.json`))),
    button("Duplicate and edit", () => openModelOf(id)),
    askingButton("Delete", `Delete “${nameOf(job)}” and all its increments?`, then(async () => {
      await thumbnails.then(({ forget }) => forget(id), () => {});
      await call(`/v1/jobs/${id}`, { method: "DELETE" });
      leaveFor({ jobs: state().jobs.filter((other) => other !== id), at: null });
    }), { class: "danger", id: "delete" }));
}

/** The actions on a study, a sweep or a curve; `kind` is "study", "sweep" or "curve", `place` the address below which its records are. */
export function findingsActions(record, kind, place, hasFindings, done, failed) {
  const { id } = record;
  const then = doing(done, failed);
  const file = (words, name, ending) => button(words,
    then(() => download(`${place}/${id}/${name}.${ending}`, `${kind}-${id}.${ending}`)));
  const rest = kind === "sweep" ? "all its jobs" : "all that it has found";
  return element("div", { class: "actions" },
    isGoingOn(record) ? button("Cancel", then(() => call(`${place}/${id}/cancel`, { method: "POST" }))) : null,
    hasFindings ? [
      file("Table (csv)", "table", "csv"), file("Table (text)", "table", "txt"), file("Picture (svg)", "picture", "svg"),
    ] : [],
    askingButton("Delete", `Delete the ${kind} “${nameOf(record)}” and ${rest}?`, then(async () => {
      await call(`${place}/${id}`, { method: "DELETE" });
      leaveFor({ [kind]: null });
    }), { class: "danger", id: "delete" }));
}

/** Shows another view, which gets the focus of the removed one. */
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
