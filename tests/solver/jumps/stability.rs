//! Whether states are stable, beside small motions followed in time by a program of its own.

use super::flat_truss;
use super::random_trusses::under_load;
use super::truss_in_motion::Motion;
use crate::common::paths::{close, judged, trace, typed};
use crate::common::random::Numbers;
use arcslip::model::JobRequest;
use arcslip::model::request::{Obstacle, StageControl};
use arcslip::result::increment::{DeadLoadStability, Increment, Instability, PointKind};
use serde_json::json;

impl Motion<'_> {
    /// One explicit step; the contacts keep to their laws.
    fn step(&mut self, length: f64) {
        let model = &self.request.model;
        let mut velocities = self.forces();
        let mut lifts = vec![[0.0; 2]; velocities.len()];
        for contact in &model.contacts {
            let node = self.node(&contact.node);
            let Obstacle::Plane { point, normal } = &model.obstacles[&contact.obstacle] else { panic!("a plane") };
            let size = normal[0].hypot(normal[1]);
            let normal = [normal[0] / size, normal[1] / size];
            let gap = (0..2).map(|k| (self.places[node][k] - point[k]) * normal[k]).sum::<f64>();
            let force = velocities[node];
            let approach = force[0] * normal[0] + force[1] * normal[1];
            if gap + length * approach >= 0.0 {
                continue;
            }
            // The reaction that leaves the node on the plane at the end of the step.
            let pressure = -gap / length - approach;
            let along = [force[0] - approach * normal[0], force[1] - approach * normal[1]];
            let drag = along[0].hypot(along[1]);
            let left = if drag > 0.0 { (1.0 - contact.friction * pressure / drag).max(0.0) } else { 0.0 };
            velocities[node] = along.map(|component| component * left);
            lifts[node] = normal.map(|component| component * -gap);
        }
        for (name, held) in &model.supports {
            let node = self.node(name);
            held.iter().for_each(|component| velocities[node][component.index()] = 0.0);
        }
        for ((place, velocity), lift) in self.places.iter_mut().zip(&velocities).zip(&lifts) {
            (0..2).for_each(|k| place[k] += length * velocity[k] + lift[k]);
        }
    }

    /// Whether some small disturbance grows by a factor of hundred within so many steps.
    fn leaves(request: &JobRequest, increment: &Increment, numbers: &mut Numbers, steps: usize) -> bool {
        const SMALL: f64 = 1e-7;
        (0..4).any(|_| {
            let start = Motion::from(request, increment);
            let mut moving = Motion::from(request, increment);
            for (name, place) in request.model.nodes.keys().zip(&mut moving.places) {
                let held = request.model.supports.get(name).is_some_and(|held| held.len() == 2);
                if !held {
                    place.iter_mut().for_each(|value| *value += numbers.between(-1.0, 1.0) * SMALL);
                }
            }
            (0..steps).any(|_| {
                moving.step(0.2);
                let apart = start.places.iter().zip(&moving.places);
                apart.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max) > 100.0 * SMALL
            })
        })
    }
}

#[test]
fn the_verdict_is_that_of_small_motions() {
    let (mut compared, mut unstable, mut unknown) = (0, 0, 0);
    for seed in 0..40 {
        let mut request = under_load(flat_truss(&mut Numbers(seed)));
        // Along the path itself, falling stretches and all.
        request.model.stages[0].control = StageControl::Path;
        request.analysis.max_increments = 150;
        let traced = judged(&request);
        let mut numbers = Numbers(1000 + seed);
        let regular = traced.increments.iter().filter(|one| one.point.kind == PointKind::Regular);
        for one in regular.skip(7).step_by(17).take(6) {
            let stability = one.stability.expect("asked for");
            let steps = if stability.dead_load == DeadLoadStability::Unstable { 200_000 } else { 5_000 };
            let leaves = Motion::leaves(&request, one, &mut numbers, steps);
            match stability.dead_load {
                DeadLoadStability::Stable => assert!(!leaves, "{seed}, {}: {stability:?}", one.index),
                DeadLoadStability::Unstable => {
                    unstable += 1;
                    assert!(leaves, "{seed}, {}: {stability:?}", one.index);
                }
                DeadLoadStability::Unknown => unknown += 1,
            }
            compared += 1;
        }
    }
    println!("{compared} states, {unstable} unstable, {unknown} unknown");
    assert!(compared >= 200 && unstable >= 30 && unknown <= compared / 50);
}

/// Von Mises' truss between its limit points is unstable, with one negative eigenvalue.
#[test]
fn a_falling_branch_is_unstable() {
    let mut request = crate::common::paths::scene_file("von-mises-truss");
    request.analysis.record = Some(serde_json::from_value(json!({"stability": true})).expect("a record"));
    let (increments, _) = trace(&request);
    for one in increments.iter().filter(|one| one.point.kind == PointKind::Regular) {
        let stability = one.stability.expect("asked for");
        let height = 0.5 + one.displacements["apex"][1];
        let rest = 1.25_f64.sqrt();
        // The stiffness along the path, and that of the apex sideways.
        let length = (1.0 + height * height).sqrt();
        let down = 2.0 / rest - 2.0 / length.powi(3);
        let aside = 2.0 / rest - 2.0 * height * height / length.powi(3);
        let negative = u64::from(down < 0.0) + u64::from(aside < 0.0);
        assert_eq!(stability.negative_eigenvalues, Some(negative), "at height {height}");
        let expected = if negative == 0 { DeadLoadStability::Stable } else { DeadLoadStability::Unstable };
        assert_eq!(stability.dead_load, expected);
        assert_eq!(stability.instability, (negative > 0).then_some(Instability::Divergence));
    }
}

/// Klarbring's node with μ = 1.5 about to slip at s = 1.5 is unstable; with a stiffness without coupling it is not.
#[test]
fn friction_decides_about_a_node_about_to_slip() {
    let node = |coupling: f64, load: f64| {
        typed(json!({
            "model": {
                "dimension": 2, "nodes": {"node": [0, 0]},
                "elements": [
                    {"kind": "spring", "nodes": ["node"], "stiffness": [[1, coupling], [coupling, 1]]}
                ],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "contacts": [{"node": "node", "obstacle": "floor", "friction": 1.5}],
                "stages": [
                    {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
                    {"name": "pull", "forces": {"node": [1, 0]}, "until": {"load_above": load}},
                ],
            },
            "analysis": {"record": {"stability": true}},
        }))
    };
    let (increments, _) = trace(&node(-0.8, 3.0));
    let slips = increments.iter().find(|one| one.point.kind == PointKind::NonsmoothLimit).expect("a limit point");
    close(slips.load_factor, 1.5, 1e-12, "load");
    assert_eq!(slips.stability.expect("asked for").dead_load, DeadLoadStability::Unstable);
    // Stuck, or held by friction that grows with the slip.
    assert_eq!(increments[1].stability.expect("asked for").dead_load, DeadLoadStability::Stable);
    for coupling in [0.0, 0.5] {
        let (increments, _) = trace(&node(coupling, 3.0));
        for one in &increments {
            assert_eq!(one.stability.expect("asked for").dead_load, DeadLoadStability::Stable, "{coupling}");
        }
    }
}

/// A node whose foot slides on a belt, coupled to it by a spring across: with masses 2 along and 1 across the belt, and
/// `k11/2 = k22 + k3`, the two modes couple and flutter if `k12 (k12 - μ k3) < 0` (mode coupling; N. Hoffmann, M. Fischer,
/// R. Allgaier, L. Gaul, Mech. Res. Commun. 29 (2002) 197).
#[test]
fn a_foot_on_a_belt_flutters_above_a_known_friction() {
    let on_belt = |friction: f64, sense: f64| {
        let request = typed(json!({
            "model": {
                "dimension": 2, "nodes": {"body": [0, 1], "foot": [0, 0]},
                "elements": [
                    {"kind": "spring", "nodes": ["body"], "stiffness": [[4, 0.5], [0.5, 1]]},
                    {"kind": "spring", "nodes": ["body", "foot"], "stiffness": [[1e4, 0], [0, 1]]},
                ],
                "obstacles": {"belt": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "contacts": [{"node": "foot", "obstacle": "belt", "friction": friction}],
                "stages": [
                    {"name": "press", "forces": {"body": [0, -1]}, "until": {"load_above": 1}},
                    {"name": "run", "obstacle_motion": {"belt": [sense, 0]}, "until": {"load_above": 2}},
                ],
            },
            "analysis": {"record": {"stability": true}},
        }));
        let (increments, report) = trace(&request);
        let last = increments.last().expect("an end");
        assert_eq!(last.contacts[0].status, arcslip::result::increment::Status::Slip, "{report:?}");
        last.stability.expect("asked for").instability
    };
    // The friction of a belt that runs to the left pulls the foot to the left.
    let [left, right] = [-1.0, 1.0].map(|sense| [0.49, 0.51].map(|friction| on_belt(friction, sense)));
    println!("left {left:?}, right {right:?}");
    let flutters: Vec<bool> = left.iter().chain(&right).map(|found| *found == Some(Instability::Flutter)).collect();
    assert_eq!(flutters.iter().filter(|flutters| **flutters).count(), 1, "in one sense, above 0.5");
    assert!(flutters[1] || flutters[3]);
}

/// A column of two stiff links on a belt, H. Ziegler's (Ing.-Arch. 20 (1952) 49) with friction for the force that follows:
/// the upper end is pinned, springs hold knee and lower end, and a foot carries the lower end through a spring across the
/// belt.
struct ColumnOnBelt {
    friction: f64,
    /// The belt runs to the right (1) or to the left (-1).
    sense: f64,
}

impl ColumnOnBelt {
    const AXIAL: f64 = 1e5;
    const KNEE: f64 = 1.0;
    const END: f64 = 3.0;
    const FOOT: [f64; 2] = [1e4, 1.7];

    /// The row at which the foot slides.
    fn slides(&self) -> Increment {
        let half = 0.5_f64.sqrt();
        let bar = |nodes: [&str; 2]| json!({"kind": "bar", "nodes": nodes, "axial_stiffness": Self::AXIAL});
        let request = typed(json!({
            "model": {
                "dimension": 2,
                "nodes": {"pin": [0, 2.0 * half], "knee": [half, half], "end": [0, 0], "foot": [0, 0]},
                "supports": {"pin": ["x", "y"]},
                "elements": [
                    bar(["pin", "knee"]), bar(["knee", "end"]),
                    {"kind": "spring", "nodes": ["knee"], "stiffness": [[Self::KNEE, 0], [0, Self::KNEE]]},
                    {"kind": "spring", "nodes": ["end"], "stiffness": [[Self::END, 0], [0, 0]]},
                    {"kind": "spring", "nodes": ["end", "foot"], "stiffness": [[Self::FOOT[0], 0], [0, Self::FOOT[1]]]},
                ],
                "obstacles": {"belt": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
                "contacts": [{"node": "foot", "obstacle": "belt", "friction": self.friction}],
                "stages": [
                    {"name": "press", "forces": {"end": [0, -0.2]}, "until": {"load_above": 1}},
                    {"name": "run", "obstacle_motion": {"belt": [self.sense, 0]}, "until": {"load_above": 1}},
                ],
            },
            "analysis": {"record": {"stability": true}},
        }));
        let (increments, report) = trace(&request);
        let last = increments.last().expect("an end");
        assert_eq!(last.contacts[0].status, arcslip::result::increment::Status::Slip, "{report:?}");
        last.clone()
    }

    /// The instability by the motion itself, `q̈ + K q = 0` over knee, end and the foot along the belt, with mass 1 at each:
    /// `K` has the friction's `μ` times the pressure's rate beside the elements' stiffnesses.
    fn by_hand(&self, row: &Increment) -> Option<Instability> {
        let half = 0.5_f64.sqrt();
        let at = |name: &str, x: f64, y: f64| [x + row.displacements[name][0], y + row.displacements[name][1]];
        let (pin, knee, end) = ([0.0, 2.0 * half], at("knee", half, half), at("end", 0.0, 0.0));
        let mut stiffness = nalgebra::DMatrix::zeros(5, 5);
        for (from, to, freedoms) in [(pin, knee, [None, Some(0)]), (knee, end, [Some(0), Some(2)])] {
            let along = [to[0] - from[0], to[1] - from[1]];
            let length = along[0].hypot(along[1]);
            let force = Self::AXIAL * (length - 1.0);
            for (row, column) in (0..2).flat_map(|row| (0..2).map(move |column| (row, column))) {
                let projection = along[row] * along[column] / length.powi(2);
                let across = if row == column { 1.0 - projection } else { -projection };
                let value = Self::AXIAL * projection + force / length * across;
                for (first, one) in freedoms.iter().enumerate().filter_map(|(place, one)| Some((place, (*one)?))) {
                    for (second, other) in freedoms.iter().enumerate().filter_map(|(place, one)| Some((place, (*one)?)))
                    {
                        stiffness[(one + row, other + column)] += if first == second { value } else { -value };
                    }
                }
            }
        }
        (0..2).for_each(|k| stiffness[(k, k)] += Self::KNEE);
        stiffness[(2, 2)] += Self::END + Self::FOOT[0];
        stiffness[(3, 3)] += Self::FOOT[1];
        stiffness[(4, 4)] += Self::FOOT[0];
        stiffness[(2, 4)] -= Self::FOOT[0];
        stiffness[(4, 2)] -= Self::FOOT[0];
        // The pressure falls as the end rises, and with it the force of the belt on the foot.
        stiffness[(4, 3)] += self.sense * self.friction * Self::FOOT[1];
        let values: Vec<nalgebra::Complex<f64>> = stiffness.complex_eigenvalues().iter().copied().collect();
        if values.iter().any(|value| value.im.abs() > 1e-9 * value.re.abs()) {
            return Some(Instability::Flutter);
        }
        values.iter().any(|value| value.re < 0.0).then_some(Instability::Divergence)
    }
}

#[test]
fn a_column_of_two_links_on_a_belt_flutters() {
    let verdicts = |friction: f64, sense: f64| {
        let column = ColumnOnBelt { friction, sense };
        let row = column.slides();
        let stability = row.stability.expect("asked for");
        let found = stability.instability;
        assert_eq!(found, column.by_hand(&row), "friction {friction}, sense {sense}");
        assert_eq!(stability.negative_eigenvalues, Some(0), "no eigenvalue is real and negative");
        found == Some(Instability::Flutter)
    };
    let (mut steady, mut flutters) = (0.0, 1.0);
    assert!(!verdicts(0.02, 1.0) && verdicts(flutters, 1.0));
    for _ in 0..24 {
        let middle = 0.5 * (steady + flutters);
        if verdicts(middle, 1.0) { flutters = middle } else { steady = middle }
    }
    println!("flutter above a friction of {flutters:.7}");
    // A belt that runs the other way steadies the column.
    for tenth in 1..=10 {
        assert!(!verdicts(0.1 * f64::from(tenth), -1.0));
    }
}

#[test]
fn what_is_not_asked_for_is_not_there() {
    let (increments, _) = trace(&crate::common::paths::scene_file("von-mises-truss"));
    assert!(increments.iter().all(|one| one.stability.is_none()));
}
