// Texts for the symbols of the interface.

const STOPPED = {
  stages_completed: "Every stage reached its end.",
  max_increments: "It has as many increments as it was allowed.",
  mechanism: "The structure has become a mechanism: it moves without resistance.",
  no_direction: "There is no direction in which the path goes on.",
  no_equilibrium: "The structure jumps and comes to rest in no stable state.",
  cycle: "The path has come back to where it was.",
  step_underflow: "Even the shortest step does not converge.",
  time_limit: "It has run as long as a job may; what is stored stands.",
  storage_limit: "It has stored as much as a job may; what is stored stands.",
};
/** Stop reasons as ends of a path, in a word or two. Few of them are mistakes: a mechanism is what a path may well end in. */
const ENDED = {
  no_limit_point: "no curve", max_increments: "all increments used", no_direction: "no direction on", no_equilibrium: "no state at rest", step_underflow: "step too short",
  storage_limit: "storage limit", time_limit: "time limit",
};
const STATUS = {
  queued: "waits in the queue", running: "is running", completed: "completed", stopped: "has ended where its path does",
  cancelled: "cancelled", failed: "failed", deleted: "has been deleted",
};
const KINDS = {
  start: "start", regular: "regular point", smooth_limit: "limit point", nonsmooth_limit: "limit point at a contact change",
  smooth_bifurcation: "bifurcation point", contact_change: "contact change", bifurcation: "bifurcation point", end: "end",
  jump: "at rest after a jump", motion: "motion of a jump",
};

/** The name of a job, a study or a sweep. */
export const nameOf = ({ name }) => name || "(no name)";
/** A text of a user, escaped so that Plotly reads no markup or templates in it. */
export const verbatim = (text) => String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;")
  .replaceAll("%{", "%\u200b{");
/** A name of the interface as plain words. */
export const plainWords = (name) => String(name).replaceAll("_", " ");
export const statusWords = (status) => STATUS[status] ?? status;
/** The status of a job, a study or a sweep in a few words; of a path that stopped, what ended it. */
export const statusOf = ({ status, stop_reason: reason }) =>
  (status === "stopped" ? `ended: ${ENDED[reason] ?? plainWords(reason ?? "path")}` : status);
export const kindWords = (kind) => KINDS[kind] ?? plainWords(kind);
/** The description of a named point: its kind, and whether it is a bifurcation. */
export const pointWords = ({ kind, bifurcation }) =>
  `${kindWords(kind)}${bifurcation && !kind.includes("bifurcation") ? " and bifurcation" : ""}`;
export const isGoingOn = (job) => job.status === "queued" || job.status === "running";

/** A number of things: `1 increment`, `2 increments`. */
export const counted = (number, one) => `${number} ${one}${number === 1 ? "" : "s"}`;

/** Words as a sentence. */
export const sentence = (told) => `${told[0].toUpperCase()}${told.slice(1)}.`;
export function stopSentence(job) {
  if (job.error) return `It failed: ${job.error}.`;
  const told = job.report?.sentence;
  if (told) return sentence(told);
  return job.stop_reason ? STOPPED[job.stop_reason] ?? plainWords(job.stop_reason) : "";
}

/** Sentences on what is valid and may be a mistake. */
export const warningSentences = (plan) => (plan?.warnings ?? []).map(({ pointer, detail }) => `${pointer}: ${detail}.`);

export const leftOutSentence = ({ what, why }) => `${what}, because ${why}.`;

/** The settings, with the defaults marked. */
export function settingsSentences(request, plan, defaults) {
  const given = request.analysis ?? {};
  const of = (from, otherwise, name) => {
    const value = from?.[name];
    return value === undefined || value === null ? `${words(otherwise?.[name])} (default)` : words(value);
  };
  const setting = (name) => of(given, defaults, name);
  const arc = (name) => of(given.arc_length, defaults.arc_length, name);
  return [
    `Increments are found by the method: ${setting("method")}.`,
    `Where there is a choice of directions, the path takes the one of: ${setting("selection")}.`,
    `Contact changes become points of their own: ${setting("events")}.`,
    `It ends after so many increments at the latest: ${setting("max_increments")}.`,
    `Arc length of an increment: first ${arc("initial")}, at least ${arc("min")}, at most ${arc("max")}.`,
    plan ? `${counted(plan.unknowns, "unknown")}, ${counted(plan.contacts, "contact")}, ${counted(plan.stages, "stage")}; `
      + `displacements are measured by ${short(plan.displacement_scale)}, forces by ${short(plan.force_scale)}.` : null,
  ].filter(Boolean);
}

/** For each request, the settings in which the requests differ, as text. */
export function differences(requests) {
  const settings = requests.map(({ model, analysis = {} }) => ({
    friction: [...new Set((model.contacts ?? []).map(({ friction }) => friction))].join(" and ") || "none",
    method: words(analysis.method, "default"), selection: words(analysis.selection, "default"),
    "longest step": words(analysis.arc_length?.max, "default"),
  }));
  const differs = (name) => new Set(settings.map((one) => one[name])).size > 1;
  return settings.map((one) => Object.keys(one).filter(differs).map((name) => `${name} ${one[name]}`).join(", "));
}

const words = (value, otherwise = "computed from the scene") => plainWords(value ?? otherwise);

export const short = (value) => (typeof value === "number" ? Number(value.toPrecision(5)).toString() : "–");

export function ago(time) {
  const seconds = Math.max(0, (Date.now() - Date.parse(time)) / 1000);
  if (seconds < 60) return "just now";
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ago`;
  if (seconds < 86400) return `${Math.floor(seconds / 3600)} h ago`;
  return new Date(time).toLocaleDateString();
}
