// Calls of the service: JSON in and out, problems (RFC 9457) as errors, the bearer token where the service asks for one.

import { reached } from "./reach.js";

const TOKEN = "arcslip token";
let asks = () => {};

/** What a call answered instead of what was asked for. */
export class Problem extends Error {
  constructor(status, told) {
    super(told.detail ?? told.title ?? `The service answered ${status}.`);
    this.status = status;
    this.title = told.title ?? "";
    /** [{pointer, detail}] of input that is refused. */
    this.errors = told.errors ?? [];
  }
}

/** The service did not answer. */
export class Unreachable extends Error {
  constructor() {
    super("The service cannot be reached.");
  }
}

/** Whether a call was given up because nobody waits for it any more. */
export const isGivenUp = (problem) => problem.name === "AbortError";

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
  const given = headersOf(sent);
  let answer;
  try {
    answer = await fetch(place, { method, body, headers: given, signal });
  } catch (problem) {
    if (!(problem instanceof TypeError)) throw problem;
    reached(false);
    throw new Unreachable();
  }
  reached(true);
  if (answer.ok) return answer;
  const told = await answer.json().catch(() => ({}));
  // Of one token that may not do this another may.
  if (answer.status === 401 || (answer.status === 403 && token)) asks(told.detail ?? "");
  throw new Problem(answer.status, told);
}

/** No header can hold every token that was kept. */
function headersOf(sent) {
  try {
    return new Headers(sent);
  } catch {
    sessionStorage.removeItem(TOKEN);
    delete sent.Authorization;
    return new Headers(sent);
  }
}

export async function get(place, signal) {
  return (await call(place, { signal })).json();
}

/** Posts text as it stands. */
export async function post(place, text) {
  return (await call(place, { method: "POST", body: text })).json();
}
