// Calls of the service: JSON in and out, problems (RFC 9457) as errors, the bearer token where the service asks for one.

const TOKEN = "arcslip token";
let asks = () => {};

/** What a call answered instead of what was asked for. */
export class Problem extends Error {
  constructor(status, told) {
    super(told.detail ?? told.title ?? `the service answered ${status}`);
    this.status = status;
    this.title = told.title ?? "";
    /** [{pointer, detail}] of input that is refused. */
    this.errors = told.errors ?? [];
  }
}

/** Who is told that the service asks for a token. */
export function onTokenAsked(listener) {
  asks = listener;
}

/** Kept as long as the tab. */
export function keepToken(token) {
  sessionStorage.setItem(TOKEN, token);
}

/** The answer itself. */
export async function call(place, { method = "GET", body, headers = {}, signal } = {}) {
  const sent = { ...headers };
  const token = sessionStorage.getItem(TOKEN);
  if (token) sent.Authorization = `Bearer ${token}`;
  if (body !== undefined) sent["Content-Type"] = "application/json";
  const answer = await fetch(place, { method, body, headers: sent, signal });
  if (answer.ok) return answer;
  const told = await answer.json().catch(() => ({}));
  if (answer.status === 401) asks(told.detail ?? "This service asks for a token.");
  throw new Problem(answer.status, told);
}

export async function get(place, signal) {
  return (await call(place, { signal })).json();
}

let described = null;

/** The defaults of a request's `analysis`, as the service's own description has them. */
export async function analysisDefaults() {
  described ??= get("/openapi.json");
  try {
    const { properties } = (await described).components.schemas.Analysis;
    return Object.fromEntries(Object.entries(properties).map(([name, property]) => [name, property.default]));
  } catch (problem) {
    described = null;
    throw problem;
  }
}

/** Posts text as it stands. */
export async function post(place, text) {
  return (await call(place, { method: "POST", body: text })).json();
}

/** Saves an answer as a file. */
export async function download(place, name) {
  save(await (await call(place)).blob(), name);
}

export function save(blob, name) {
  const address = URL.createObjectURL(blob);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
