// The state that determines the view, which is also kept in the address, so that a link leads to the same view.
//
// jobs: ids drawn in the path plot; the first is the one whose structure and figures are shown. study, sweep, curve: the id
// of one that is shown in their place. abscissa and ordinate: a member of the increments or a JSON Pointer to one; null for the job's own
// choice. at: the chosen increment, null for the last. turn: azimuth and elevation (degrees) from which a structure in space
// is seen, null for the usual ones. exaggeration: of its displacements. figures: the diagnostics are open. status and search: what
// the lists show. run: the form for a new run is open; scene: what is in it; as: "study" or "sweep" where it queues one; again: how
// often the model of a job has been asked for, which is not in the address.

const EMPTY = {
  jobs: [], study: null, sweep: null, curve: null, abscissa: null, ordinate: null, at: null, turn: null, exaggeration: 1,
  figures: false, status: "", search: "", run: false, scene: "",
  as: "", again: 0,
};
/** What jobs, studies, sweeps and curves can be filtered by. */
export const STATUSES = ["queued", "running", "completed", "stopped", "cancelled", "failed"];
/** Prefix in place of the name of a scene: the model of a job. */
const OF_A_JOB = "job:";
/** Milliseconds between changes of the address without a history entry, whose rate browsers limit. */
const PAUSE = 250;
const ID = /^[0-9a-f-]{36}$/i;
const listeners = new Set();

function ofAddress() {
  const given = new URLSearchParams(location.search);
  const at = Number.parseInt(given.get("at") ?? "", 10);
  const idOf = (name) => (ID.test(given.get(name) ?? "") ? given.get(name) : null);
  return {
    jobs: [...new Set((given.get("jobs") ?? "").toLowerCase().split(",").filter((id) => ID.test(id)))],
    study: idOf("study"),
    sweep: idOf("sweep"),
    curve: idOf("curve"),
    abscissa: given.get("abscissa"),
    ordinate: given.get("ordinate"),
    at: Number.isSafeInteger(at) && at >= 0 ? at : null,
    turn: angles(given.get("turn") ?? ""),
    exaggeration: factor(given.get("exaggeration")),
    figures: given.has("figures"),
    status: STATUSES.find((status) => status === given.get("status")) ?? "",
    search: (given.get("search") ?? "").trim(),
    run: given.has("run"),
    scene: given.get("scene") ?? "",
    as: ["study", "sweep"].find((kind) => kind === given.get("as")) ?? "",
  };
}

function angles(text) {
  const found = text.split(",").map(Number);
  return text && found.length === 2 && found.every(Number.isFinite) ? found : null;
}

function factor(text) {
  const found = Number(text ?? "1");
  return text !== "" && Number.isFinite(found) && found >= 0 ? found : 1;
}

function address(state) {
  const parts = [];
  if (state.study) parts.push(`study=${state.study}`);
  if (state.sweep) parts.push(`sweep=${state.sweep}`);
  if (state.curve) parts.push(`curve=${state.curve}`);
  if (state.jobs.length) parts.push(`jobs=${state.jobs.join(",")}`);
  if (state.abscissa) parts.push(`abscissa=${encodeURIComponent(state.abscissa)}`);
  if (state.ordinate) parts.push(`ordinate=${encodeURIComponent(state.ordinate)}`);
  if (state.at !== null) parts.push(`at=${state.at}`);
  if (state.turn) parts.push(`turn=${state.turn.map(Math.round).join(",")}`);
  if (state.exaggeration !== 1) parts.push(`exaggeration=${state.exaggeration}`);
  if (state.figures) parts.push("figures");
  if (state.status) parts.push(`status=${encodeURIComponent(state.status)}`);
  if (state.search) parts.push(`search=${encodeURIComponent(state.search)}`);
  if (state.run) parts.push("run");
  if (state.run && state.scene) parts.push(`scene=${encodeURIComponent(state.scene)}`);
  if (state.run && state.as) parts.push(`as=${state.as}`);
  return parts.length ? `?${parts.join("&")}` : "/";
}

let now = { ...EMPTY, ...ofAddress() };
let written = -PAUSE;
let later = null;

/** Writes the state to the address: at once, or when the pause since the last time is over. */
function write() {
  clearTimeout(later);
  const wait = written + PAUSE - performance.now();
  if (wait > 0) {
    later = setTimeout(write, wait);
    return;
  }
  written = performance.now();
  history.replaceState(null, "", address(now));
}

export const state = () => now;
/** Whether both states show the same view, apart from form, filter and chosen point. */
export const isSameView = (a, b) => a.jobs.join() === b.jobs.join() && a.run === b.run && a.study === b.study
  && a.sweep === b.sweep && a.curve === b.curve;

/** Changes the state; listeners get the previous one. Another job or form makes a history entry, an increment does not. */
export function change(changes) {
  const before = now;
  now = { ...now, ...changes };
  if (!isSameView(before, now)) {
    clearTimeout(later);
    history.replaceState(null, "", address(before));
    history.pushState(null, "", address(now));
  } else if (address(now) !== address(before)) {
    write();
  }
  for (const listener of listeners) listener(before);
}

/** The changes that leave nothing shown. */
const NOTHING = { jobs: [], study: null, sweep: null, curve: null, at: null, abscissa: null, ordinate: null, run: false };

/** Shows these jobs and nothing else. */
export function openJobs(jobs) {
  change({ ...NOTHING, jobs });
}

export const openJob = (id) => openJobs([id]);

export function openStudy(id) {
  change({ ...NOTHING, study: id });
}

export function openSweep(id) {
  change({ ...NOTHING, sweep: id });
}

export function openCurve(id) {
  change({ ...NOTHING, curve: id });
}

/** The job whose model is requested in place of a scene; null for a scene. */
export const jobOf = (scene) => (scene.startsWith(OF_A_JOB) ? scene.slice(OF_A_JOB.length) : null);

/** Shows the model of a job in the form, replacing its content. */
export function openModelOf(id) {
  change({ run: true, scene: `${OF_A_JOB}${id}`, as: "", again: now.again + 1 });
}

export const addressOfJob = (...ids) => `/?jobs=${ids.join(",")}`;
export const addressOfStudy = (id) => `/?study=${id}`;
export const addressOfSweep = (id) => `/?sweep=${id}`;
export const addressOfCurve = (id) => `/?curve=${id}`;

export function onChange(listener) {
  listeners.add(listener);
}

addEventListener("popstate", () => {
  clearTimeout(later);
  const before = now;
  now = { ...EMPTY, ...ofAddress(), again: before.again };
  for (const listener of listeners) listener(before);
});
