// Obstacles in the picture of a structure: of planes and of large balls and cylinders the part near the feet, that is, near the
// nodes that may touch them.

import { frame, fromMiddle, sectionAxes, vector } from "./geometry.js";
import { planeCurve } from "./plane-curve.js";
import { fromSheet } from "./plot-style.js";
import { drawTurn } from "./structure-loads.js";
import { meshEdges } from "./triangle-mesh.js";
import { components } from "./units.js";

const { plus, unit, dot, length } = vector;
/** Corners of the polygon that represents a circle, and of each side of the part of an obstacle. */
const ROUND = 48;
const SIDE = 16;
/** Straight lines of a cylinder, and about as many of a polyline in space. */
const RULES = 12;
/** Edges of a triangle mesh that are drawn. */
const MESH_EDGES = 5000;
/** How far a part goes beyond the feet, how deep it is drawn in a plane, and half its side where no node may touch it: as parts
 *  of the extent. */
const BEYOND = 0.2;
const DEEP = 0.07;
const ALONE = 0.3;
/** An obstacle for more feet than these is drawn as the ground that it is. */
const ROWS_OF_FEET = 50;
/** The part of the distance to the feet on another obstacle that a part of an obstacle may take. */
const NOT_HALF = 0.4;
/** With more contacts than these the distances between their feet are not compared. */
const NEIGHBOURS = 300;
/** The part of the extent within which an obstacle is in the picture. */
const NEAR = 0.75;
/** The length of the arrow of an obstacle's motion, as a part of the extent. */
const MOTION = 0.15;

export class ObstacleDrawing {
  /** `now`: where the nodes are; `moved`: the displacements of the obstacles; `moves`, `turns`: those whose arrows are drawn. */
  constructor(model, extent, traces, { now, moved, moves, turns, units, detail }) {
    Object.assign(this, { model, extent, traces, now, moved, moves, turns, units, detail });
    this.line = { color: fromSheet("--obstacle"), width: 2 };
    for (const [name, obstacle] of Object.entries(model.obstacles ?? {})) this.draw(name, obstacle);
  }

  draw(name, obstacle) {
    const { traces, extent } = this;
    const before = traces.reach.length;
    const middle = this.shape(name, obstacle);
    if (!traces.reach.slice(before).some((place) => extent.isNear(place, NEAR))) {
      // Not to push the structure into a corner.
      traces.reach.length = before;
      this.detail.leave(`The obstacle “${name}” is too far from the structure to be in the picture`);
      return;
    }
    const angle = this.turns.get(name) ?? 0;
    if (angle !== 0) {
      drawTurn(traces, extent, {
        trace: "rotation of an obstacle", place: obstacle.turned ? plus(obstacle.turned.pivot, this.moved.get(name) ?? []) : middle,
        axis: obstacle.turned?.axis ?? (this.model.dimension === 3 ? [0, 0, 1] : undefined), value: angle, color: fromSheet("--obstacle"), words: `${name} turns by ${angle} rad`,
      });
    }
    const motion = this.moves.get(name);
    if (!motion?.some((value) => value !== 0)) return;
    const to = plus(middle, unit(motion), MOTION * extent.size);
    traces.arrow("motion of an obstacle", middle, to, fromSheet("--obstacle"), {
      words: `${name} moves by ${components(motion, this.units.length)}`, isAtHead: true,
    });
  }

  /** Draws an obstacle; answers a place on it. */
  shape(name, obstacle) {
    if (obstacle.kind === "polyline") return obstacle.section ? this.prism(name, obstacle) : this.curve(name, obstacle);
    if (obstacle.kind === "triangle_mesh") return this.mesh(name, obstacle);
    if (!this.extent.isWhole(obstacle)) return this.part(name, obstacle);
    return obstacle.kind === "ball" ? this.ball(name, obstacle) : this.cylinder(name, obstacle);
  }

  /** The nodes that may touch an obstacle, where they were and where they are. */
  feet(name) {
    const found = (this.model.contacts ?? []).filter((contact) => contact.obstacle === name);
    return found.flatMap(({ node }) => [this.model.nodes[node], this.now.get(node)]).filter(Boolean);
  }

  /** How far the part around these feet may go so that it does not cover that of a neighbour: each goes not quite half way. */
  room(name, feet) {
    if (feet.length > ROWS_OF_FEET || this.model.contacts.length > NEIGHBOURS) return Infinity;
    const others = (this.model.contacts ?? []).filter(({ obstacle }) => obstacle !== name && obstacle in this.model.obstacles)
      .map(({ node }) => this.model.nodes[node]);
    let nearest = Infinity;
    for (const foot of feet) {
      for (const other of others) nearest = Math.min(nearest, length(plus(foot, other, -1)) || Infinity);
    }
    return NOT_HALF * nearest;
  }

  /** The part near the feet; answers its middle. */
  part(name, obstacle) {
    const { extent, traces, model: { dimension } } = this;
    const feet = this.feet(name);
    const surface = surfaceOf(obstacle, feet[0] ?? extent.middle, this.moved.get(name) ?? []);
    const ranges = extent.stand(name, feet.map(surface.along));
    const around = feet.length ? Math.min(BEYOND, this.room(name, feet) / extent.size) : ALONE;
    const sides = (ranges.length ? ranges : surface.along(extent.middle).map((value) => [value, value]))
      .map(([low, high]) => [low - around * extent.size, high + around * extent.size]);
    const between = ([low, high], step) => low + ((high - low) * step) / SIDE;
    const steps = [...Array(SIDE + 1).keys()];
    const [first, second] = sides;
    if (dimension === 2) {
      const edge = steps.map((step) => surface.on([between(first, step)]));
      traces.lines("obstacle", [edge], this.line, name);
      const below = (place) => plus(place, surface.normalAt(place), -DEEP * extent.size);
      traces.area([...edge, ...edge.map(below).reverse()], fromSheet("--ground"));
      return edge[SIDE / 2];
    }
    const back = [...steps].reverse();
    const edges = [
      ...steps.map((step) => [between(first, step), second[0]]), ...steps.map((step) => [first[1], between(second, step)]),
      ...back.map((step) => [between(first, step), second[1]]), ...back.map((step) => [first[0], between(second, step)]),
    ].map(surface.on);
    traces.lines("obstacle", [edges], this.line, name);
    traces.area(edges, fromSheet("--ground"));
    return surface.on([between(first, SIDE / 2), between(second, SIDE / 2)]);
  }

  /** The parts of a curve near the structure; answers a place on it. */
  curve(name, obstacle) {
    const { extent, traces } = this;
    const { places, outwards } = planeCurve(obstacle);
    const shifted = places.map(({ place, normal }) => ({ place: plus(place, this.moved.get(name) ?? []), normal }));
    const onwards = ({ place, normal }, way) => [...Array(SIDE).keys()].map((step) =>
      ({ place: plus(place, way, ((step + 1) * extent.size) / SIDE), normal }));
    if (outwards.length) {
      shifted.unshift(...onwards(shifted[0], outwards[0]).reverse());
      shifted.push(...onwards(shifted.at(-1), outwards[1]));
    }
    const isNear = ({ place }) => extent.isNear(place, ALONE);
    const runs = shifted.reduce((found, at) => {
      if (!isNear(at)) found.push([]);
      else found.at(-1).push(at);
      return found;
    }, [[]]).filter((run) => run.length > 1);
    for (const run of runs) {
      const edge = run.map(({ place }) => place);
      traces.lines("obstacle", [edge], this.line, name);
      const below = ({ place, normal }) => plus(place, normal, -DEEP * extent.size);
      traces.area([...edge, ...run.map(below).reverse()], fromSheet("--ground"));
    }
    const longest = runs.reduce((best, run) => (run.length > best.length ? run : best), []);
    return (longest[Math.floor(longest.length / 2)] ?? shifted[0]).place;
  }

  /** A ball as a whole; answers its centre. */
  ball(name, obstacle) {
    const { traces, model: { dimension } } = this;
    const center = plus(obstacle.center, this.moved.get(name) ?? []);
    const axes = center.map((_, axis) => center.map((_, other) => (axis === other ? 1 : 0)));
    const pairs = dimension === 2 ? [[0, 1]] : [[0, 1], [1, 2], [0, 2]];
    for (const pair of pairs) {
      const round = circle(center, obstacle.radius, pair.map((axis) => axes[axis]));
      traces.lines("obstacle", [round], this.line, name);
      if (dimension === 2 && obstacle.side !== "inside") traces.area(round, fromSheet("--ground"));
    }
    // A spoke shows how far a ball has turned.
    if (this.turns.has(name) && dimension === 2) {
      const along = [obstacle.radius, 0];
      traces.lines("obstacle", [[center, plus(center, obstacle.turned?.outOf(along) ?? along)]], this.line, name);
    }
    return center;
  }

  /** A polyline in space: the part of its curve near the structure at two places across its plane, and straight lines
   *  between them; answers a place on it. */
  prism(name, obstacle) {
    const { traces, extent } = this;
    const [x, y, across] = sectionAxes(obstacle);
    const origin = plus(obstacle.section.origin, this.moved.get(name) ?? []);
    const feet = this.feet(name);
    const along = (feet.length ? feet : [extent.middle]).map((place) => [dot(plus(place, origin, -1), across)]);
    const [[low, high]] = extent.stand(name, along);
    const beyond = (feet.length ? BEYOND : ALONE) * extent.size;
    const { places, outwards } = planeCurve(obstacle);
    const middle = (low + high) / 2;
    const at = ([first, second], depth) => plus(plus(plus(origin, x, first), y, second), across, depth);
    const onwards = ({ place }, way) => [...Array(SIDE).keys()].map((step) =>
      plus(place, way, ((step + 1) * extent.size) / SIDE));
    const curve = places.map(({ place }) => place);
    const whole = outwards.length
      ? [...onwards(places[0], outwards[0]).reverse(), ...curve, ...onwards(places.at(-1), outwards[1])] : curve;
    const near = whole.filter((place) => extent.isNear(at(place, middle), ALONE));
    const shown = near.length > 1 ? near : whole;
    const edges = [low - beyond, high + beyond].map((depth) => shown.map((place) => at(place, depth)));
    const every = Math.max(1, Math.floor((shown.length - 1) / RULES));
    const rules = shown.map((_, number) => number).filter((number) => number % every === 0 || number === shown.length - 1)
      .map((number) => edges.map((edge) => edge[number]));
    traces.lines("obstacle", [...edges, ...rules], this.line, name);
    return at(shown[Math.floor(shown.length / 2)], middle);
  }

  /** The edges of a triangle mesh; answers its middle. */
  mesh(name, obstacle) {
    const { traces } = this;
    const moved = this.moved.get(name) ?? [];
    const edges = meshEdges(obstacle);
    const shown = edges.slice(0, MESH_EDGES);
    if (shown.length < edges.length) this.detail.leave(`${edges.length - shown.length} edges of the obstacle “${name}” are not drawn`);
    traces.lines("obstacle", shown.map((edge) => edge.map((place) => plus(place, moved))), this.line, name);
    const sum = obstacle.points.reduce((total, place) => plus(total, place), [0, 0, 0]);
    return plus(sum.map((value) => value / obstacle.points.length), moved);
  }

  /** A cylinder all round, as far along as its feet need; answers the middle of its axis. */
  cylinder(name, obstacle) {
    const { traces, extent } = this;
    const axis = unit(obstacle.axis);
    const moved = this.moved.get(name) ?? [];
    const base = plus(obstacle.point, moved);
    const feet = this.feet(name);
    const along = (feet.length ? feet : [extent.middle]).map((place) => [dot(plus(place, base, -1), axis)]);
    const [[low, high]] = extent.stand(name, along);
    const beyond = (feet.length ? BEYOND : ALONE) * extent.size;
    const ends = [low - beyond, high + beyond].map((place) => plus(base, axis, place));
    const across = frame({ kind: "plane", normal: axis }, base).tangents;
    const rounds = ends.map((center) => circle(center, obstacle.radius, across));
    const rules = [...Array(RULES).keys()].map((number) => rounds.map((round) => round[(number * ROUND) / RULES]));
    traces.lines("obstacle", [...rounds, ...rules], this.line, name);
    return plus(ends[0], axis, (high - low) / 2 + beyond);
  }
}

/** A circle about a centre, as a closed polygon, in the plane of two unit vectors. */
function circle(center, radius, [first, second]) {
  return [...Array(ROUND + 1).keys()].map((step) => {
    const angle = (2 * Math.PI * step) / ROUND;
    return plus(plus(center, first, radius * Math.cos(angle)), second, radius * Math.sin(angle));
  });
}

/** Coordinates along the surface of an obstacle: `along(place)` of a position, `on(coordinates)` the position that has them, and
 *  `normalAt(place)`. */
function surfaceOf(obstacle, near, moved) {
  const isPlane = obstacle.kind === "plane";
  const onRound = (place) => {
    const from = fromMiddle(obstacle, place, moved);
    return plus(plus(place, from, -1), unit(from), obstacle.radius);
  };
  const origin = isPlane ? plus(obstacle.point, moved) : onRound(near);
  const { tangents } = frame(obstacle, origin, moved);
  const flat = (coordinates) => tangents.reduce((sum, tangent, axis) => plus(sum, tangent, coordinates[axis]), origin);
  return {
    along: (place) => tangents.map((tangent) => dot(plus(place, origin, -1), tangent)),
    on: (coordinates) => (isPlane ? flat(coordinates) : onRound(flat(coordinates))),
    normalAt: (place) => frame(obstacle, place, moved).normal,
  };
}
