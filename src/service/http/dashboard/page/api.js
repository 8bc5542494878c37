// Calls of the service: JSON in and out, problems (RFC 9457) as errors, the bearer token where the service asks for one.

import { reached } from "./reach.js";

const TOKEN = "arcslip token";
let asks = () => {};

/** An error answer of a call. */
export class Problem extends Error {
  constructor(status, told) {
    super(told.detail ?? told.title ?? `The service answered ${status}.`);
    this.status = status;
    this.title = told.title ?? "";
    /** The mistakes in refused input, as [{pointer, detail}]. */
    this.errors = told.errors ?? [];
  }
}

/** The service did not answer. */
export class Unreachable extends Error {
  constructor() {
    super("The service cannot be reached.");
  }
}

/** Whether a call was aborted because its result is no longer needed. */
export const isGivenUp = (problem) => problem.name === "AbortError";

/** The listeners that are told when the service asks for a token. */
export function onTokenAsked(listener) {
  asks = listener;
}

/** The token, kept for the session of the tab. */
export function keepToken(token) {
  sessionStorage.setItem(TOKEN, token);
}

/** Calls the service; returns the response. */
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
  // Another token may have the required scope.
  if (answer.status === 401 || (answer.status === 403 && token)) asks(told.detail ?? "");
  throw new Problem(answer.status, told);
}

/** Not every text that was stored as a token can be sent in a header. */
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

/** Posts a text unchanged. */
export async function post(place, text) {
  return (await call(place, { method: "POST", body: text })).json();
}
