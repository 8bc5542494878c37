//! An element with three nodes and a rotation, and a contact that moves with three nodes, traced like any others.
//!
//! A lever rotates about a fixed node. One of its ends rests on two bars that snap through; the other end then hits a
//! rail between two nodes on springs, sticks to it and slips along it. Path following knows neither: its results are
//! compared with equilibrium and the contact laws written down again below.

use crate::continuation::path::iterator::Path;
use crate::continuation::scene::{AdditionalParts, Scene};
use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::kinematics::{CoupledKinematics, Kinematics, LocalDisplacements};
use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::vector::Vector;
use crate::mechanics::contact::{ContactPair, Sliding};
use crate::mechanics::problem::state::State;
use crate::mechanics::structure::Structure;
use crate::mechanics::structure::elements::FiniteElement;
use crate::model::request::JobRequest;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{Increment, PointKind, Status};
use serde_json::json;
use std::sync::Arc;

type Plane = [f64; 2];

fn minus(a: Plane, b: Plane) -> Plane {
    [a[0] - b[0], a[1] - b[1]]
}

fn plus(a: Plane, b: Plane) -> Plane {
    [a[0] + b[0], a[1] + b[1]]
}

fn times(factor: f64, a: Plane) -> Plane {
    a.map(|value| factor * value)
}

fn dot(a: Plane, b: Plane) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// A quarter turn counter-clockwise.
fn turned(a: Plane) -> Plane {
    [-a[1], a[0]]
}

fn rotated(angle: f64, a: Plane) -> Plane {
    plus(times(angle.cos(), a), times(angle.sin(), turned(a)))
}

/// A rigid lever about its first node, with springs between its ends and the other two nodes and between the rotations.
///
/// ```text
/// W = ½ k Σ |u_o - u_m - (R(θ_m) - I) X_o|² + ½ κ Σ (θ_o - θ_m)²
/// ```
#[derive(Debug, Clone)]
struct Lever {
    nodes: [usize; 3],
    /// From the first node to each of the others.
    arms: [Plane; 2],
    stiffness: f64,
    bending: f64,
}

impl Lever {
    /// The stretch of the spring at an end, the arm as it has turned, and the difference of the rotations.
    fn end(&self, which: usize, q: &[f64]) -> (Plane, Plane, f64) {
        let arm = rotated(q[2], self.arms[which]);
        let at = 3 * (which + 1);
        let moved = minus([q[at], q[at + 1]], [q[0], q[1]]);
        (minus(moved, minus(arm, self.arms[which])), arm, q[at + 2] - q[2])
    }
}

impl FiniteElement for Lever {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn rotations(&self) -> usize {
        1
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let of = |which: usize| {
            let (stretch, _, bent) = self.end(which, q);
            0.5 * self.stiffness * dot(stretch, stretch) + 0.5 * self.bending * bent * bent
        };
        of(0) + of(1)
    }

    fn write_force(&self, q: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let mut carried = 0.0_f64;
        for which in 0..2 {
            let (stretch, arm, bent) = self.end(which, q);
            let at = 3 * (which + 1);
            for k in 0..2 {
                force[at + k] += self.stiffness * stretch[k];
                force[k] -= self.stiffness * stretch[k];
            }
            force[2] -= self.stiffness * dot(stretch, turned(arm)) + self.bending * bent;
            force[at + 2] += self.bending * bent;
            carried = carried.max(self.stiffness * dot(stretch, stretch).sqrt());
        }
        carried
    }

    fn write_stiffness(&self, q: &[f64], stiffness: &mut [f64]) {
        stiffness.fill(0.0);
        let mut add = |row: usize, column: usize, value: f64| stiffness[9 * row + column] += value;
        for which in 0..2 {
            let (stretch, arm, _) = self.end(which, q);
            let (at, k, swept) = (3 * (which + 1), self.stiffness, turned(arm));
            for (c, swept) in swept.into_iter().enumerate() {
                for (row, column, sign) in [(at, at, 1.0), (0, 0, 1.0), (at, 0, -1.0), (0, at, -1.0)] {
                    add(row + c, column + c, sign * k);
                }
                for (row, sign) in [(at + c, -1.0), (c, 1.0)] {
                    add(row, 2, sign * k * swept);
                    add(2, row, sign * k * swept);
                }
            }
            add(2, 2, k * dot(swept, swept) + k * dot(stretch, arm));
            for (row, column, sign) in [(2, 2, 1.0), (at + 2, at + 2, 1.0), (2, at + 2, -1.0), (at + 2, 2, -1.0)] {
                add(row, column, sign * self.bending);
            }
        }
    }

    fn write_force_sizes(&self, q: &[f64], least: f64, sizes: &mut [f64]) {
        let reach = q.iter().fold(least, |reach: f64, value| reach.max(value.abs()));
        sizes.fill(2.0 * (self.stiffness + self.bending) * reach);
    }

    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        self.stiffness
    }
}

/// A node in front of a rail that is pinned at its second node and guided by its third: `x` is the position of the node
/// in the rail's axes, along it and across it.
#[derive(Debug)]
struct NodeOnRail {
    nodes: [usize; 3],
    places: [Plane; 3],
}

/// The displacements of the node and of the rail's nodes.
fn all(displacement: LocalDisplacements<'_>) -> [f64; 6] {
    std::array::from_fn(displacement)
}

/// The rail's unit vector, normal and length, and the position of the node along and across it.
struct Rail {
    tangent: Plane,
    normal: Plane,
    length: f64,
    along: f64,
    across: f64,
}

impl NodeOnRail {
    fn rail(&self, q: &[f64]) -> Rail {
        let place = |k: usize| plus(self.places[k], [q[2 * k], q[2 * k + 1]]);
        let (node, rail) = (minus(place(0), place(1)), minus(place(2), place(1)));
        let length = dot(rail, rail).sqrt();
        let tangent = times(1.0 / length, rail);
        let normal = turned(tangent);
        Rail { tangent, normal, length, along: dot(tangent, node), across: dot(normal, node) }
    }
}

impl CoupledKinematics for NodeOnRail {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn place(&self, displacement: LocalDisplacements<'_>) -> Vector {
        let (start, here) = (self.rail(&[0.0; 6]), self.rail(&all(displacement)));
        [here.along - start.along, here.across - start.across, 0.0]
    }

    fn each_column(&self, displacement: LocalDisplacements<'_>, each: &mut dyn FnMut(usize, &Vector)) {
        let Rail { tangent, normal, length, along, across } = self.rail(&all(displacement));
        for k in 0..2 {
            let by_node = [tangent[k], normal[k]];
            let by_rail = [across / length * normal[k], -along / length * normal[k]];
            each(k, &[by_node[0], by_node[1], 0.0]);
            each(2 + k, &[-by_node[0] - by_rail[0], -by_node[1] - by_rail[1], 0.0]);
            each(4 + k, &[by_rail[0], by_rail[1], 0.0]);
        }
    }

    fn each_curvature(
        &self,
        displacement: LocalDisplacements<'_>,
        force: &Vector,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        let Rail { tangent, normal, length, along, across } = self.rail(&all(displacement));
        let [t, n, _] = *force;
        let (moment, pull) = (t * across - n * along, t * along + n * across);
        for i in 0..2 {
            for j in 0..2 {
                // Contributions of the node's position and of the rail; the second node moves both.
                let node_rail = (t * normal[i] - n * tangent[i]) * normal[j] / length;
                let rail_node = (t * normal[j] - n * tangent[j]) * normal[i] / length;
                let rail_rail = -(pull * normal[i] * normal[j]
                    + moment * (tangent[i] * normal[j] + normal[i] * tangent[j]))
                    / (length * length);
                add(i, 2 + j, -node_rail);
                add(2 + i, j, -rail_node);
                add(i, 4 + j, node_rail);
                add(4 + i, j, rail_node);
                add(2 + i, 2 + j, node_rail + rail_node + rail_rail);
                add(2 + i, 4 + j, -node_rail - rail_rail);
                add(4 + i, 2 + j, -rail_node - rail_rail);
                add(4 + i, 4 + j, rail_rail);
            }
        }
    }
}

const FRICTION: f64 = 0.5;
const ARMS: [Plane; 2] = [[-1.0, 0.0], [1.0, 0.0]];
const RAIL: [Plane; 3] = [[1.0, 0.0], [1.5, 0.3], [0.5, 0.3]];
/// Stiffnesses of the springs that support the nodes of the rail.
const SEATS: [Plane; 2] = [[0.05, 0.02], [0.03, 0.04]];
/// Stiffness of the spring at the lever's end: a request accepts no node that none of its own elements supports.
const RIGHT: Plane = [0.01, 0.02];
/// Feet of the bars, and their common length.
const FEET: [Plane; 2] = [[-1.8, -0.6], [-0.2, -0.6]];
const LEVER: f64 = 2.0;
const BENDING: f64 = 0.05;
/// Nodes of the lever (pivot and ends) and of the rail, then of the bars' feet.
const NAMES: [&str; 7] = ["pivot", "left", "right", "held", "guided", "foot", "other_foot"];

/// The request; `extra` more nodes in a row hang on the left end.
fn request(method: &str, extra: usize) -> JobRequest {
    let places = [[0.0, 0.0], ARMS[0], ARMS[1], RAIL[1], RAIL[2], FEET[0], FEET[1]];
    let mut nodes = serde_json::Map::new();
    NAMES.iter().zip(places).for_each(|(name, place)| drop(nodes.insert((*name).into(), json!(place))));
    let seat =
        |name: &str, k: Plane| json!({"kind": "spring", "nodes": [name], "stiffness": [[k[0], 0.0], [0.0, k[1]]]});
    let mut elements = vec![
        json!({"kind": "bar", "nodes": ["foot", "left"], "axial_stiffness": 1.0}),
        json!({"kind": "bar", "nodes": ["other_foot", "left"], "axial_stiffness": 1.0}),
        seat("held", SEATS[0]),
        seat("guided", SEATS[1]),
        seat("right", RIGHT),
    ];
    let mut before = "left".to_owned();
    for k in 0..extra {
        let name = format!("extra{k}");
        nodes.insert(name.clone(), json!([-1.0, 1.0 + k as f64]));
        elements.push(json!({"kind": "spring", "nodes": [before, name], "stiffness": [[1.0, 0.0], [0.0, 1.0]]}));
        before = name;
    }
    serde_json::from_value(json!({
        "model": {
            "dimension": 2,
            "nodes": nodes,
            "supports": {"pivot": ["x", "y"], "foot": ["x", "y"], "other_foot": ["x", "y"]},
            "elements": elements,
            "stages": [
                {"name": "press", "forces": {"left": [0.0, -0.1]}, "until": {"displacement": {"node": "left", "component": "y", "below": -1.3}}},
                {"name": "release", "forces": {"left": [0.0, 0.1]}},
            ],
        },
        "analysis": {
            "method": method,
            "arc_length": {"initial": 0.02, "max": 0.05, "displacement_scale": 1.0},
            "max_increments": 150,
        },
    }))
    .expect("a request")
}

fn scene(method: &str, extra: usize) -> Scene {
    let lever = Lever { nodes: [0, 1, 2], arms: ARMS, stiffness: LEVER, bending: BENDING };
    let kinematics = NodeOnRail { nodes: [2, 3, 4], places: RAIL };
    let contact = ContactPair {
        initial_gap: kinematics.rail(&[0.0; 6]).across,
        kinematics: Kinematics::Coupled(Arc::new(kinematics)),
        obstacle: RigidSurface::Plane { normal: [0.0, 1.0, 0.0] },
        friction: CoulombFriction::new(FRICTION),
        sliding: Sliding::Line { across: [0.0, 0.0, 1.0] },
    };
    let parts = AdditionalParts { elements: [lever].into_iter().collect(), contacts: vec![("right", "rail", contact)] };
    Scene::with_parts(None, &request(method, extra), parts).expect("a scene")
}

/// A point of a path with data that are not in its increment.
struct Seen {
    increment: Increment,
    state: State,
}

fn traced(scene: &Scene) -> Vec<Seen> {
    let mut path = Path::new(scene, CancelFlag::default());
    let mut seen = Vec::new();
    while let Some(increment) = path.next() {
        seen.push(Seen { increment, state: path.trace.at.here.state.clone() });
    }
    seen
}

/// Residual of equilibrium at a state, by hand: all forces on each node and all moments.
fn left_over(structure: &Structure, state: &State, load: f64) -> f64 {
    let u = |node: usize| {
        let first = structure.translations_of(node).start;
        [state.displacement[first], state.displacement[first + 1]]
    };
    let turn = |node: usize| state.displacement[structure.numbering.rotations_of(node).start];
    let mut forces = [[0.0; 2]; 5];
    let mut moment = 0.0_f64;
    for (which, arm) in ARMS.iter().enumerate() {
        let end = rotated(turn(0), *arm);
        let pull = times(LEVER, minus(u(which + 1), minus(end, *arm)));
        forces[which + 1] = minus(forces[which + 1], pull);
        // The pull rotates the lever; the ends carry no moment, so that they rotate with it.
        moment += end[0] * pull[1] - end[1] * pull[0];
        assert!((turn(which + 1) - turn(0)).abs() <= 1e-12);
    }
    for foot in FEET {
        let (before, now) = (minus(ARMS[0], foot), minus(plus(ARMS[0], u(1)), foot));
        let lengths = [before, now].map(|vector| dot(vector, vector).sqrt());
        let pull = (lengths[1] - lengths[0]) / lengths[0];
        forces[1] = minus(forces[1], times(pull / lengths[1], now));
    }
    forces[1][1] -= 0.1 * load;
    for (seat, node) in [SEATS[0], SEATS[1], RIGHT].iter().zip([3, 4, 2]) {
        (0..2).for_each(|k| forces[node][k] -= seat[k] * u(node)[k]);
    }
    // The rail's force on the node, and on the rail by equilibrium of the rail itself: the traction at the node that
    // pins it, the normal pressure at the position of the node, as on a beam on two supports.
    let reaction = state.reactions[0];
    let place = |k: usize, node: usize| plus(RAIL[k], u(node));
    let (node, rail) = (minus(place(0, 2), place(1, 3)), minus(place(2, 4), place(1, 3)));
    let length = dot(rail, rail).sqrt();
    let tangent = times(1.0 / length, rail);
    let normal = turned(tangent);
    let (pressure, traction) = (times(reaction.normal, normal), times(reaction.tangential[0], tangent));
    let share = dot(node, tangent) / length;
    forces[2] = plus(forces[2], plus(pressure, traction));
    forces[3] = minus(forces[3], plus(times(1.0 - share, pressure), traction));
    forces[4] = minus(forces[4], times(share, pressure));
    forces[1..].iter().flatten().fold(moment.abs(), |largest, value| largest.max(value.abs()))
}

fn check(structure: &Structure, seen: &[Seen]) {
    let mut before: Option<f64> = None;
    let pressed =
        seen.iter().rfind(|one| &*one.increment.stage == "press").map_or(0.0, |one| one.increment.load_factor);
    for Seen { increment, state } in seen {
        let load = match &*increment.stage {
            "press" => increment.load_factor,
            _ => pressed - increment.load_factor,
        };
        let residual = left_over(structure, state, load);
        assert!(residual <= 1e-11, "{residual:e} at {}", increment.index);
        let place = |k: usize, node: usize| {
            let first = structure.translations_of(node).start;
            plus(RAIL[k], [state.displacement[first], state.displacement[first + 1]])
        };
        let (node, rail) = (minus(place(0, 2), place(1, 3)), minus(place(2, 4), place(1, 3)));
        let length = dot(rail, rail).sqrt();
        let (along, gap) = (dot(rail, node) / length, dot(turned(rail), node) / length);
        let (reaction, status) = (state.reactions[0], increment.contacts[0].status);
        let slip = before.map_or(0.0, |before| along - before);
        assert!((increment.contacts[0].gap - gap).abs() <= 1e-14);
        assert!(increment.diagnostics.energy_error <= 1e-6, "{:?} at {}", increment.energy, increment.index);
        match status {
            Status::Free => assert!(gap >= -1e-12 && reaction.size() == 0.0, "{gap:e} at {}", increment.index),
            Status::Stick => {
                assert!(gap.abs() <= 1e-12 && slip.abs() <= 1e-12, "{gap:e} {slip:e} at {}", increment.index);
                assert!(reaction.tangential_size() <= FRICTION * reaction.normal * (1.0 + 1e-12));
            }
            Status::Slip => {
                assert!(gap.abs() <= 1e-12, "{gap:e} at {}", increment.index);
                let drag = reaction.tangential[0] + FRICTION * reaction.normal * slip.signum();
                assert!(slip == 0.0 || drag.abs() <= 1e-12, "{drag:e} at {}", increment.index);
            }
        }
        before = Some(along);
    }
}

/// Below 16 unknowns with dense matrices, the same with sparse ones, and above 16: exact, and the same path.
#[test]
fn a_new_element_and_a_new_contact_are_traced_like_any() {
    let dense = scene("auto", 0);
    assert!(dense.structure.unknowns() < 16 && dense.structure.layout().is_none());
    let mut sparse = dense.clone();
    sparse.structure.set_sparse(true);
    let large = scene("auto", 6);
    assert!(large.structure.unknowns() > 16 && large.structure.layout().is_some());
    let expected = traced(&dense);
    for scene in [&dense, &sparse, &large] {
        let seen = traced(scene);
        check(&scene.structure, &seen);
        let has = |status: Status| seen.iter().any(|one| one.increment.contacts[0].status == status);
        assert!(has(Status::Free) && has(Status::Stick) && has(Status::Slip));
        assert!(seen.iter().any(|one| one.increment.point.kind == PointKind::SmoothLimit));
        let events = |seen: &[Seen]| -> Vec<(PointKind, f64)> {
            let is_event = |one: &&Seen| one.increment.point.kind != PointKind::Regular;
            seen.iter().filter(is_event).map(|one| (one.increment.point.kind, one.increment.load_factor)).collect()
        };
        let (events, of_dense) = (events(&seen), events(&expected));
        for ((kind, load), (other, expected)) in events.iter().zip(&of_dense) {
            assert_eq!(kind, other);
            assert!((load - expected).abs() <= 1e-9, "{kind:?}: {load} {expected}");
        }
    }
}

/// The programs alone find the same points.
#[test]
fn the_program_of_an_increment_has_them_too() {
    let (auto, by_program) = (scene("auto", 0), scene("mpec", 0));
    let (expected, seen) = (traced(&auto), traced(&by_program));
    check(&by_program.structure, &seen);
    assert_eq!(expected.len(), seen.len());
    for (one, other) in seen.iter().zip(&expected) {
        assert!((one.increment.load_factor - other.increment.load_factor).abs() <= 1e-8, "{}", one.increment.index);
    }
}
