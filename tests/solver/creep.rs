//! Scenes, found by a search over random ones, in which steps come to be so short that they change nothing.

use crate::common::paths::{judged, typed};
use arcslip::model::JobRequest;
use arcslip::result::increment::Increment;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Increments within which a path that creeps ends by name.
const MOST: usize = 50;
/// Steps (dimensionless) below this are too short to get anywhere.
const SHORT: f64 = 2e-8;

fn request(model: &Value) -> JobRequest {
    let arc_length = json!({"initial": 0.02, "min": 1e-9, "max": 0.1});
    typed(json!({"model": model, "analysis": {"arc_length": arc_length, "max_increments": 1000}}))
}

/// The increments of a path that ends since its steps are too short.
fn creeping(model: &Value) -> Vec<Increment> {
    let traced = judged(&request(model));
    assert_eq!(traced.report.stop_reason, StopReason::StepUnderflow, "{}", traced.report.sentence);
    traced.increments
}

/// How many of them are there from the first short step on.
fn after_the_first_short_step(increments: &[Increment]) -> usize {
    increments.iter().skip_while(|one| one.step == 0.0 || one.step >= SHORT).count()
}

/// Nodes that touch without reaction when the stage begins: its directions are degenerate. One of them is held across its
/// spring by a millionth of a millionth of what holds the others, and gives way as the load has hardly begun. From there on
/// regular points lie some 2e-9 apart.
#[test]
fn a_degenerate_start_that_creeps_ends_by_name() {
    let increments = creeping(&json!({
        "dimension": 3,
        "nodes": {"n0": [0, 0, 0], "n1": [1, 0, 0], "pin": [3, 1, -1], "n2": [2, 0, 1e-10]},
        "supports": {"pin": ["x", "y", "z"]},
        "elements": [
            {"kind": "spring", "nodes": ["n1"], "stiffness": [[1e-12, 0, 0], [0, 1, 0], [0, 0, 0]]},
            {"kind": "bar", "nodes": ["pin", "n1"], "axial_stiffness": 2},
            {"kind": "bar", "nodes": ["n0", "n1"], "axial_stiffness": 0.5},
            {"kind": "spring", "nodes": ["n2"], "stiffness": [[0.5, 0, 0], [0, 1e-12, 0], [0, 0, 1e-6]]},
            {"kind": "bar", "nodes": ["n1", "n2"], "axial_stiffness": 1e-6}
        ],
        "obstacles": {
            "floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
            "wall": {"kind": "plane", "point": [0, 0, 0], "normal": [-1, 0, 0]}
        },
        "contacts": [
            {"node": "n0", "obstacle": "wall", "friction": 1},
            {"node": "n2", "obstacle": "floor", "friction": 0.25}
        ],
        "stages": [{"name": "push", "forces": {"n1": [1, 0.5, 0.5]}, "until": {"load_above": 1}}]
    }));
    assert!(increments[0].point.degenerate);
    let creeping = after_the_first_short_step(&increments);
    assert!(creeping <= MOST, "{creeping} increments from the first short step on");
}

/// An eigenvalue that is rounding beside stiff bars crosses zero again and again, at one state.
#[test]
fn bifurcations_at_one_state_end_by_name() {
    let increments = creeping(&json!({
        "dimension": 2,
        "nodes": {"n0": [0, 1e-10], "p0": [2, 2.0000000001], "n1": [1, 0], "p1": [2, 0], "n2": [2, 0],
            "p2": [3, 2], "q2": [4, 1]},
        "supports": {"p0": ["x", "y"], "p1": ["x", "y"], "p2": ["x", "y"], "q2": ["x", "y"]},
        "elements": [
            {"kind": "spring", "nodes": ["n0"], "stiffness": [[2, 0], [0, 1]]},
            {"kind": "bar", "nodes": ["p0", "n0"], "axial_stiffness": 1},
            {"kind": "spring", "nodes": ["n1"], "stiffness": [[1e-6, 0], [0, 1e-3]]},
            {"kind": "bar", "nodes": ["p1", "n1"], "axial_stiffness": 0.5},
            {"kind": "spring", "nodes": ["n2"],
                "stiffness": [[1e-6, -0.001131370849898476], [-0.001131370849898476, 2]]},
            {"kind": "bar", "nodes": ["p2", "n2"], "axial_stiffness": 1},
            {"kind": "bar", "nodes": ["q2", "n2"], "axial_stiffness": 1e6},
            {"kind": "bar", "nodes": ["n1", "n2"], "axial_stiffness": 1e6}
        ],
        "obstacles": {
            "floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
            "bowl": {"kind": "ball", "center": [2, 2], "radius": 2, "side": "inside"}
        },
        "contacts": [
            {"node": "n1", "obstacle": "floor", "friction": 0.25},
            {"node": "n2", "obstacle": "bowl", "friction": 1}
        ],
        "stages": [{"name": "push", "forces": {"n1": [1, 0], "n2": [1, 0]}, "until": {"load_above": 1}}]
    }));
    assert!(increments.len() <= MOST, "{} increments", increments.len());
}

/// A contact comes to the limit of its mode and keeps it, again and again, some 1e-18 apart.
#[test]
fn contacts_that_keep_their_modes_end_by_name() {
    let increments = creeping(&json!({
        "dimension": 2,
        "nodes": {"n0": [0, 1e-7], "p0": [-1, 1e-7], "n1": [1, 0], "n2": [2, 1e-10], "p2": [4, 2.0000000001]},
        "supports": {"p0": ["x", "y"], "p2": ["x", "y"], "n2": ["x"]},
        "elements": [
            {"kind": "bar", "nodes": ["p0", "n0"], "axial_stiffness": 1},
            {"kind": "spring", "nodes": ["n1"], "stiffness": [[2, 0], [0, 0]]},
            {"kind": "bar", "nodes": ["n0", "n1"], "axial_stiffness": 1},
            {"kind": "bar", "nodes": ["p2", "n2"], "axial_stiffness": 1e6},
            {"kind": "bar", "nodes": ["n1", "n2"], "axial_stiffness": 1}
        ],
        "obstacles": {
            "floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
            "ball": {"kind": "ball", "center": [0, -1.9999999], "radius": 2}
        },
        "contacts": [
            {"node": "n0", "obstacle": "ball", "friction": 0},
            {"node": "n2", "obstacle": "floor", "friction": 1000}
        ],
        "stages": [
            {"name": "press", "forces": {"n0": [-1, -1], "n2": [0, 1]}, "until": {"load_above": 1}},
            {"name": "push", "forces": {"n1": [1, 0]}, "until": {"load_above": 1}}
        ]
    }));
    assert!(increments.len() <= MOST, "{} increments", increments.len());
}

/// Next to a bar that is a million million times as stiff as others the pivots say nothing of the signs of the equations.
/// They are told all the same, at both ends of a step alike. (Else each step ends as if it passed a singular point, and is
/// taken shorter than the one before.)
#[test]
fn signs_next_to_a_stiff_bar_do_not_shorten_steps() {
    let model = json!({
        "dimension": 2,
        "nodes": {"n0": [0, 1e-10], "p0": [-1, 2.0000000001], "q0": [2, -0.9999999999], "n1": [1, 0], "p1": [2, 1],
            "q1": [1, -1]},
        "supports": {"p0": ["x", "y"], "q0": ["x", "y"], "p1": ["x", "y"], "q1": ["x", "y"]},
        "elements": [
            {"kind": "spring", "nodes": ["n0"], "stiffness": [[1e-6, 0], [0, 0]]},
            {"kind": "bar", "nodes": ["p0", "n0"], "axial_stiffness": 1},
            {"kind": "bar", "nodes": ["q0", "n0"], "axial_stiffness": 1e-6},
            {"kind": "spring", "nodes": ["n1"], "stiffness": [[1, 0], [0, 0]]},
            {"kind": "bar", "nodes": ["p1", "n1"], "axial_stiffness": 1},
            {"kind": "bar", "nodes": ["q1", "n1"], "axial_stiffness": 1e6},
            {"kind": "bar", "nodes": ["n0", "n1"], "axial_stiffness": 1e-6}
        ],
        "obstacles": {"bowl": {"kind": "ball", "center": [0, 1.0000000001], "radius": 1, "side": "inside"}},
        "contacts": [{"node": "n0", "obstacle": "bowl", "friction": 0.25}],
        "stages": [{"name": "press", "forces": {"n1": [0, -1]}, "until": {"load_above": 1}}]
    });
    let traced = judged(&request(&model));
    assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "{}", traced.report.sentence);
    assert!(traced.increments.len() <= 30, "{} increments", traced.increments.len());
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() <= 1e-10, "increment {}: {errors:?}", increment.index);
    }
}
