// Everything that says which view is shown, in one place and in the address, so that a view can be sent.
//
// jobs: ids drawn in the path plot; the first is the one whose structure and figures are shown.
// abscissa: "arc_length" or a JSON Pointer to a displacement; null for the job's own choice. at: the chosen increment, null
// for the last. status: the list's filter. run: the form for a new run is open; scene: what is in it.

const EMPTY = { jobs: [], abscissa: null, at: null, status: "", run: false, scene: "" };
const listeners = new Set();

function ofAddress() {
  const given = new URLSearchParams(location.search);
  const at = Number.parseInt(given.get("at") ?? "", 10);
  return {
    jobs: (given.get("jobs") ?? "").split(",").filter((id) => /^[0-9a-f-]{36}$/i.test(id)),
    abscissa: given.get("abscissa"),
    at: Number.isSafeInteger(at) && at >= 0 ? at : null,
    status: given.get("status") ?? "",
    run: given.has("run"),
    scene: given.get("scene") ?? "",
  };
}

function address(state) {
  const parts = [];
  if (state.jobs.length) parts.push(`jobs=${state.jobs.join(",")}`);
  if (state.abscissa) parts.push(`abscissa=${encodeURIComponent(state.abscissa)}`);
  if (state.at !== null) parts.push(`at=${state.at}`);
  if (state.status) parts.push(`status=${state.status}`);
  if (state.run) parts.push("run");
  if (state.run && state.scene) parts.push(`scene=${encodeURIComponent(state.scene)}`);
  return parts.length ? `?${parts.join("&")}` : "/";
}

let now = { ...EMPTY, ...ofAddress() };

export const state = () => now;

/** Changes the view; listeners get the view before. Another job or form is a step to go back from, an increment is not. */
export function change(changes) {
  const before = now;
  now = { ...now, ...changes };
  const isStep = before.jobs.join() !== now.jobs.join() || before.run !== now.run;
  if (address(now) !== address(before)) history[isStep ? "pushState" : "replaceState"](null, "", address(now));
  for (const listener of listeners) listener(before);
}

export function onChange(listener) {
  listeners.add(listener);
}

addEventListener("popstate", () => {
  const before = now;
  now = { ...EMPTY, ...ofAddress() };
  for (const listener of listeners) listener(before);
});
