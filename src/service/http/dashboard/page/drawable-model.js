// What can be drawn of the model in the text of a request, and sentences on what cannot.

import { SOLIDS } from "./structure-solids.js";

const KINDS = ["plane", "ball", "cylinder", "polyline", "box", "triangle_mesh"];
/** The most sentences; the others are counted. */
const SENTENCES = 8;

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
const membersOf = (value) => Object.entries(isObject(value) ? value : {});
const listOf = (value) => (Array.isArray(value) ? value : []);

class Reading {
  constructor(dimension) {
    this.dimension = dimension;
    this.problems = [];
  }

  isVector(value) {
    return Array.isArray(value) && value.length === this.dimension && value.every(Number.isFinite);
  }

  /** The members of which there is nothing to say; `why(value, name)`: what is wrong, null if nothing is. */
  keep(given, what, why) {
    const isRight = ([name, value]) => this.isRight(`${what} “${name}”`, why(value, name));
    return Object.fromEntries(membersOf(given).filter(isRight));
  }

  isRight(what, wrong) {
    if (wrong) this.problems.push(`${what} is not drawn: ${wrong}`);
    return !wrong;
  }

  hasComponent(name) {
    return ["x", "y", ...(this.dimension === 2 ? ["rz"] : ["z", "rx", "ry", "rz"])].includes(name);
  }

  /** Rotations may come last: one in the plane, three in space. */
  motionOr(value) {
    const turns = Array.isArray(value) && value.length === (this.dimension === 2 ? 3 : 6);
    return this.vectorOr(turns ? value.slice(0, this.dimension) : value);
  }

  vectorOr(value) {
    return this.isVector(value) ? null : `it has to be ${this.dimension} numbers`;
  }
}

/** `{model, problems}`: what can be drawn, null where nothing can, and sentences on the rest. */
export function drawableModel(text) {
  let request;
  try {
    request = JSON.parse(text);
  } catch (problem) {
    return nothing(`The text is not JSON yet: ${problem.message}`);
  }
  const given = request?.model;
  if (!isObject(given)) return nothing("There is no “model” in the text");
  if (given.dimension !== 2 && given.dimension !== 3) return nothing("The model's “dimension” has to be 2 or 3");
  if (isObject(given.mesh)) return nothing("The picture of a model with a mesh is drawn when the job runs");
  const reading = new Reading(given.dimension);
  const nodes = reading.keep(given.nodes, "The node", (place) => reading.vectorOr(place));
  if (Object.keys(nodes).length === 0) return nothing(...bounded(reading.problems), "There is no node that can be drawn");
  const units = isObject(given.units) ? given.units : {};
  const model = { ...parts(reading, expanded(given), nodes), dimension: given.dimension, nodes, units };
  return { model, problems: bounded(reading.problems) };
}

const nothing = (...problems) => ({ model: null, problems });

function bounded(problems) {
  const more = problems.length - SENTENCES;
  return more > 0 ? [...problems.slice(0, SENTENCES), `and ${more} more like these`] : problems;
}

/** The nodes of a set or a surface, and of `@name`; a name as it is where it stands for nothing else. */
function membersOfName(given, name) {
  if (typeof name !== "string" || !name.startsWith("@")) return [name];
  const set = given.sets?.[name.slice(1)];
  const named = new Set(listOf(set?.elements));
  const ofElements = listOf(given.elements).filter((item) => named.has(item?.name)).flatMap((item) => listOf(item.nodes));
  const found = [listOf(set?.nodes), listOf(given.surfaces?.[name.slice(1)]?.faces).flat(), ofElements]
    .find((nodes) => nodes.length > 0);
  return found ? [...new Set(found)] : [name];
}

/** The model with nodes in place of the names of sets and surfaces. */
function expanded(given) {
  const byNode = (pattern) => Object.fromEntries(membersOf(pattern).flatMap(([name, value]) =>
    membersOfName(given, name).map((node) => [node, value])));
  const stageOfNodes = (stage) => (isObject(stage) ? { ...stage, forces: byNode(stage.forces), moments: byNode(stage.moments),
    displacements: byNode(stage.displacements) } : stage);
  const contactsOf = (item) => membersOfName(given, item?.surface === undefined || item.node ? item?.node : `@${item.surface}`)
    .map((node) => ({ ...item, node }));
  return { ...given, supports: byNode(given.supports), contacts: listOf(given.contacts).flatMap(contactsOf),
    stages: listOf(given.stages).map(stageOfNodes) };
}

function parts(reading, given, nodes) {
  const missing = (name) => (typeof name === "string" && Object.hasOwn(nodes, name) ? null : `there is no node “${name}”`);
  const obstacles = reading.keep(given.obstacles, "The obstacle", (obstacle) => obstacleProblem(reading, obstacle));
  const elements = listOf(given.elements).filter((item, number) =>
    reading.isRight(`Element ${number}`, elementProblem(reading, item, missing)));
  const contacts = listOf(given.contacts).filter((item, number) => reading.isRight(`Contact ${number}`,
    missing(item?.node) ?? counterpartProblem(item, obstacles, given.surfaces)));
  const supports = reading.keep(given.supports, "The support of", (held, name) => missing(name)
    ?? (listOf(held).length && held.every((one) => reading.hasComponent(one)) ? null
      : "it has to list components, such as \"x\""));
  return { obstacles, elements, contacts, supports, stages: listOf(given.stages).map((stage, number) =>
    stageOf(reading, stage, number, { missing, obstacles })) };
}

function rotationProblem(reading, rotation) {
  if (!Number.isFinite(rotation?.angle)) return "its angle has to be a number";
  const vectors = [rotation.about, reading.dimension === 3 ? rotation.axis : undefined].filter((given) => given !== undefined);
  return vectors.map((given) => reading.vectorOr(given)).find(Boolean) ?? null;
}

function counterpartProblem({ obstacle, against }, obstacles, surfaces) {
  if (against !== undefined) return Object.hasOwn(surfaces ?? {}, against) ? null : `there is no surface “${against}”`;
  return Object.hasOwn(obstacles, obstacle) ? null : `there is no obstacle “${obstacle}”`;
}

function obstacleProblem(reading, obstacle) {
  if (!KINDS.includes(obstacle?.kind)) return "its kind has to be plane, ball, cylinder, polyline, box or triangle_mesh";
  if (obstacle.kind === "ball") {
    return obstacle.radius > 0 ? reading.vectorOr(obstacle.center) : "its radius has to be a number above 0";
  }
  if (obstacle.kind === "polyline") return polylineProblem(reading, obstacle);
  if (obstacle.kind === "box") return boxProblem(reading, obstacle);
  if (obstacle.kind === "triangle_mesh") return meshProblem(reading, obstacle);
  if (obstacle.kind === "cylinder" && reading.dimension !== 3) return "a cylinder is an obstacle in space";
  if (obstacle.kind === "cylinder" && !(obstacle.radius > 0)) return "its radius has to be a number above 0";
  const member = obstacle.kind === "cylinder" ? "axis" : "normal";
  const isDirection = reading.isVector(obstacle[member]) && obstacle[member].some((value) => value !== 0);
  return isDirection ? reading.vectorOr(obstacle.point) : `its ${member} has to be a direction`;
}

function boxProblem(reading, { center, size, rounding, x, y }) {
  if (!reading.isVector(size) || !size.every((side) => side > 0)) return `its size has to be ${reading.dimension} numbers above 0`;
  if (rounding !== undefined && !(rounding > 0)) return "its rounding has to be a number above 0";
  return [center, x, y].filter((given) => given !== undefined).map((given) => reading.vectorOr(given)).find(Boolean)
    ?? (center === undefined ? "it has to have a center" : null);
}

function meshProblem(reading, { points, triangles }) {
  if (reading.dimension !== 3) return "a triangle mesh is an obstacle in space";
  if (!listOf(points).length || !points.every((point) => reading.isVector(point))) return "its points have to be 3 numbers each";
  const isTriangle = (corners) => listOf(corners).length === 3 && corners.every((number) => Array.isArray(points[number]));
  return listOf(triangles).length && triangles.every(isTriangle) ? null : "its triangles have to be the numbers of 3 points each";
}

const isPoint = (point) => Array.isArray(point) && point.length === 2 && point.every(Number.isFinite);

function polylineProblem(reading, { points, closed, rounding, section }) {
  const least = closed ? 3 : 2;
  if (reading.dimension === 3 && !["origin", "x", "y"].every((name) => reading.isVector(section?.[name]))) {
    return "in space its section has to be {\"origin\": [...], \"x\": [...], \"y\": [...]}";
  }
  if (listOf(points).length < least) return `it has to have ${least} points or more`;
  if (rounding !== undefined && !(rounding > 0)) return "its rounding has to be a number above 0";
  return listOf(points).every(isPoint) ? null : "its points have to be 2 numbers each";
}

/** How many nodes an element of a kind may have. */
const COUNTS = { bar: [2], spring: [1, 2], beam: [2, 3], rotational_spring: [1, 2], ...SOLIDS };

function elementProblem(reading, item, missing) {
  const names = listOf(item?.nodes);
  const most = COUNTS[item?.kind];
  if (most === undefined) return "its kind has to be bar, spring, beam, rotational_spring or a solid";
  if (!most.includes(names.length)) return `it has to have ${most.join(" or ")} nodes`;
  const found = names.map(missing).find(Boolean);
  if (found || item.kind !== "spring") return found ?? null;
  return listOf(item.stiffness).length === reading.dimension && item.stiffness.every((row) => reading.isVector(row)) ? null
    : `its stiffness has to be ${reading.dimension} rows of ${reading.dimension} numbers`;
}

function stageOf(reading, stage, number, { missing, obstacles }) {
  const of = (what) => `${what} of stage ${typeof stage?.name === "string" ? `“${stage.name}”` : number} on`;
  const onNode = (value, name) => missing(name) ?? reading.vectorOr(value);
  return {
    name: `${number}`,
    forces: reading.keep(stage?.forces, of("The force"), onNode),
    moments: reading.keep(stage?.moments, of("The moment"), (value, name) =>
      missing(name) ?? (Number.isFinite(value) ? null : "it has to be a number")),
    displacements: reading.keep(stage?.displacements, of("The displacement"), (value, name) =>
      missing(name) ?? reading.motionOr(value)),
    obstacle_motion: reading.keep(stage?.obstacle_motion, of("The motion"), (value, name) =>
      (Object.hasOwn(obstacles, name) ? reading.vectorOr(value) : `there is no obstacle “${name}”`)),
    obstacle_rotation: reading.keep(stage?.obstacle_rotation, of("The rotation"), (value, name) =>
      (Object.hasOwn(obstacles, name) ? rotationProblem(reading, value) : `there is no obstacle “${name}”`)),
  };
}
