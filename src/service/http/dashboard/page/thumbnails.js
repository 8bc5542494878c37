// Small pictures of paths in the list of jobs: load factor over arc length. Each takes one call; the calls come one after
// another, after what the reader waits for, and only for rows that are in sight.

import { get } from "./api.js";
import { byId, element } from "./dom.js";

const NAMESPACE = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT, RIM] = [44, 28, 2];
/** Increments that are read for a picture, and points that are drawn of them. */
const [MOST, DRAWN] = [10_000, 200];
/** Unknowns times increments up to which the service finds the columns at once. */
const LARGEST = 1_000_000;
/** Milliseconds before the first picture, and between pictures. */
const [FIRST, PAUSE] = [1200, 60];

/** Job id to `{key, points, words}`; the key changes with what a picture is of. */
const held = new Map();
const wanted = new Map();
/** Jobs that have been deleted: a list that was on its way may still show their rows. */
const gone = new Set();
let isBusy = false;
let reading = { id: null, given: new AbortController() };

const inSight = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    inSight.unobserve(target);
    wanted.set(target.dataset.job, target);
    drawWanted();
  }
});

/** The picture of a job's path, empty until it has been read. */
export function thumbnail({ id, status, progress, plan }) {
  const picture = document.createElementNS(NAMESPACE, "svg");
  const attributes = { class: "thumbnail", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true", "data-job": id };
  for (const [name, value] of Object.entries(attributes)) picture.setAttribute(name, value);
  const isGoingOn = status === "running" || status === "queued";
  // The picture of a path that grows is drawn again at its end.
  const key = isGoingOn ? status : `${progress.last_index}`;
  picture.dataset.key = key;
  const known = held.get(id);
  if (known) draw(picture, known);
  if (known?.key === key) return picture;
  const size = (plan?.unknowns ?? 0) * Math.min(MOST, progress.increments);
  if (progress.last_index === null) held.set(id, { key, points: [], words: "no increment yet" });
  else if (size > LARGEST) held.set(id, { key, points: [], words: "no picture: the path is too large for one" });
  if (held.get(id)?.key === key) draw(picture, held.get(id));
  else inSight.observe(picture);
  return picture;
}

/** No picture of a job is read from now on; for a job that is about to be deleted. */
export function forget(id) {
  gone.add(id);
  wanted.delete(id);
  if (reading.id === id) reading.given.abort();
}

async function drawWanted() {
  if (isBusy) return;
  isBusy = true;
  await rest(FIRST);
  while (wanted.size > 0) {
    await rest(PAUSE);
    // The path that is opened comes first, and a page out of sight needs no pictures.
    if (document.hidden || byId("job").classList.contains("loading")) continue;
    const [[id, picture]] = wanted;
    wanted.delete(id);
    if (!picture.isConnected && !document.querySelector(`.thumbnail[data-job="${id}"]`)) continue;
    if (gone.has(id)) continue;
    held.set(id, { key: picture.dataset.key, ...await read(id) });
    for (const one of document.querySelectorAll(`.thumbnail[data-job="${id}"]`)) draw(one, held.get(id));
  }
  isBusy = false;
}

async function read(id) {
  reading = { id, given: new AbortController() };
  try {
    const place = `/v1/jobs/${id}/columns?of=arc_length,load_factor&limit=${MOST}`;
    const page = await get(place, reading.given.signal);
    const { arc_length: x, load_factor: y } = page.columns;
    const isPart = page.index.length === MOST;
    return {
      points: thinned(x.map((value, place) => [value, y[place]])),
      words: `load factor over arc length${isPart ? `, the first ${MOST} increments` : ""}`,
    };
  } catch (problem) {
    return { points: [], words: `no picture: ${problem.message}` };
  }
}

function thinned(points) {
  const every = Math.ceil(points.length / DRAWN);
  return points.filter((_, place) => place % every === 0 || place === points.length - 1);
}

function draw(picture, { points, words }) {
  const title = document.createElementNS(NAMESPACE, "title");
  title.textContent = words;
  const line = document.createElementNS(NAMESPACE, points.length > 0 ? "polyline" : "text");
  if (points.length > 0) {
    line.setAttribute("points", placed(points));
  } else {
    line.setAttribute("x", WIDTH / 2);
    line.setAttribute("y", HEIGHT / 2);
    line.textContent = "–";
  }
  picture.replaceChildren(title, line);
}

function placed(points) {
  const scale = (of, size, isUpwards) => {
    const values = points.map((point) => point[of]);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const span = high - low || 1;
    return (value) => {
      const part = RIM + (size - 2 * RIM) * ((value - low) / span);
      return (isUpwards ? size - part : part).toFixed(1);
    };
  };
  const [x, y] = [scale(0, WIDTH, false), scale(1, HEIGHT, true)];
  return points.map(([across, along]) => `${x(across)},${y(along)}`).join(" ");
}

const rest = (milliseconds) => new Promise((resume) => setTimeout(resume, milliseconds));
