//! Obstacles and supports that move with the load factor.

use crate::common::paths::{close, place, scene_file, trace, typed};
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

fn last_of<'a>(increments: &'a [Increment], stage: &str) -> &'a Increment {
    increments.iter().rfind(|increment| &*increment.stage == stage).expect("the stage has points")
}

/// Pressed by 1, friction 0.3, spring 2: the block goes with the floor to 0.15 and stays there. The floor's work is the
/// spring's energy and the friction's dissipation.
#[test]
fn a_block_is_dragged_by_its_floor() {
    let (increments, report) = trace(&scene_file("dragged-block"));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    for increment in increments.iter().filter(|increment| &*increment.stage == "drag") {
        let s = increment.load_factor;
        close(increment.displacements["block"][0], s.min(0.15), 1e-12, "place");
        close(increment.contacts[0].tangential_reaction[0], 2.0 * s.min(0.15), 1e-12, "friction");
        let dissipated = 0.3 * (s - 0.15).max(0.0);
        close(increment.energy.dissipated, dissipated, 1e-11, "dissipated");
        close(increment.energy.external_work, s.min(0.15).powi(2) + dissipated, 1e-11, "work of the floor");
    }
    let drag = increments.iter().filter(|i| &*i.stage == "drag");
    let mut events = drag.filter(|i| !matches!(i.point.kind, PointKind::Start | PointKind::Regular));
    let slips = events.next();
    close(slips.expect("an event").load_factor, 0.15, 1e-10, "slip begins");
}

/// A truss with a spring k = 0.05 at its tip, the floor at the height d under the pin's height 1. Sliding in the
/// direction σ: `s + P x/L - σ μ P (1 - d)/L - k (x + 3/2) = 0`, `r_n = P (1 - d)/L`.
fn slides(x: f64, height: f64, sign: f64) -> (f64, f64) {
    let by_length = 1.0 / x.hypot(height) - 1.0 / 1.5_f64.hypot(1.0);
    (0.05 * (x + 1.5) - by_length * (x - sign * 0.3 * height), by_length * height)
}

#[test]
fn a_floor_rises_under_a_truss() {
    let request = scene_file("rising-floor");
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    for increment in &increments[1..] {
        let raised = if &*increment.stage == "raise" { increment.load_factor } else { 0.4 };
        let at = place(&request, increment, "tip");
        let what = format!("{} {}", increment.stage, increment.load_factor);
        close(at[1], raised, 1e-12, &what);
        let contact = &increment.contacts[0];
        if contact.status == Status::Slip {
            let (sign, load) = if &*increment.stage == "raise" { (-1.0, 0.0) } else { (1.0, increment.load_factor) };
            let (exact, normal) = slides(at[0], 1.0 - raised, sign);
            close(load, exact, 1e-11, &what);
            close(contact.normal_reaction, normal, 1e-11, &what);
        }
    }
    assert_eq!(last_of(&increments, "raise").contacts[0].status, Status::Slip, "outwards while the floor rises");
    assert!(increments.iter().any(|i| &*i.stage == "push" && i.contacts[0].status == Status::Stick), "then stuck");
    assert_eq!(last_of(&increments, "push").contacts[0].status, Status::Slip, "then pushed inwards");
}

/// A floor that rises by d and supports that sink by d are the same but for the observer: the same places against the
/// floor, the same reactions at the same loads, the same dissipation.
#[test]
fn a_rising_floor_is_a_sinking_pin() {
    let (floor, pin) = (scene_file("rising-floor"), scene_file("lowered-pin"));
    let (by_floor, by_pin) = (trace(&floor).0, trace(&pin).0);
    let ends = [("raise", "lower"), ("push", "push")];
    for (first, second) in ends {
        let (a, b) = (last_of(&by_floor, first), last_of(&by_pin, second));
        close(a.load_factor, b.load_factor, 1e-10, "load");
        close(a.displacements["tip"][0], b.displacements["tip"][0], 1e-10, "along the floor");
        close(a.displacements["tip"][1] - 0.4, b.displacements["tip"][1], 1e-12, "against the floor");
        close(b.displacements["pin"][1], -0.4, 0.0, "the pin is where it is told to be");
        close(a.contacts[0].normal_reaction, b.contacts[0].normal_reaction, 1e-10, "normal reaction");
        close(a.contacts[0].tangential_reaction[0], b.contacts[0].tangential_reaction[0], 1e-10, "traction");
        // Both are integrals over points of their own.
        close(a.energy.dissipated, b.energy.dissipated, 1e-6, "dissipation");
    }
    let limits = |increments: &[Increment]| -> Vec<f64> {
        let limits = increments.iter().filter(|i| i.point.kind == PointKind::SmoothLimit && &*i.stage == "push");
        limits.map(|increment| increment.load_factor).collect()
    };
    let (a, b) = (limits(&by_floor), limits(&by_pin));
    assert_eq!((a.len(), b.len()), (2, 2), "the load rises, falls and rises");
    a.iter().zip(&b).for_each(|(a, b)| close(*a, *b, 1e-10, "limit load"));
}

/// Two springs in a row, the far end of one moved: the node between moves by `s k1/(k1 + k2)`.
#[test]
fn a_support_pulls_a_node() {
    let request = typed(json!({
        "model": {
            "name": "node between two springs", "dimension": 2, "nodes": {"node": [0, 0], "grip": [1, 0]},
            "supports": {"grip": ["x", "y"]},
            "elements": [{"kind": "spring", "nodes": ["node", "grip"], "stiffness": [[3, 0], [0, 3]]},
                         {"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
            "stages": [
                {"name": "along", "displacements": {"grip": [1, 0]}, "until": {"load_above": 2}},
                {"name": "across", "displacements": {"grip": [0, -1]}, "until": {"load_above": 1}}
            ]
        }
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    for increment in &increments {
        let s = increment.load_factor;
        let (x, y) = if &*increment.stage == "along" { (s, 0.0) } else { (2.0, -s) };
        close(increment.displacements["node"][0], 0.75 * x, 1e-12, "x");
        close(increment.displacements["node"][1], 0.75 * y, 1e-12, "y");
        // Energy of both springs in a row, 3/8 of the square of the way.
        close(increment.energy.external_work, 0.375 * (x * x + y * y), 1e-12, "work of the support");
    }
}

/// A tip that is always within its cone (|x|/h <= 3/2 < μ = 2) holds while its pin moves over it, from 3/2 to its right
/// to 3/2 to its left: the bar is pressed together and let go, and lifts the tip off where it is unstressed again.
#[test]
fn a_pin_moves_over_a_stuck_tip() {
    let request = typed(json!({
        "model": {
            "name": "pin moved over its tip", "dimension": 2, "nodes": {"pin": [0, 1], "tip": [-1.5, 0]},
            "supports": {"pin": ["x", "y"]},
            "elements": [{"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "tip", "obstacle": "floor", "friction": 2}],
            "stages": [{"name": "move", "displacements": {"pin": [-1, 0]}, "until": {"load_above": 2.9}}]
        }
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    for increment in &increments {
        let ahead = 1.5 - increment.load_factor;
        let by_length = 1.0 / ahead.hypot(1.0) - 1.0 / 1.5_f64.hypot(1.0);
        let contact = &increment.contacts[0];
        close(increment.displacements["tip"][0], 0.0, 1e-13, "stuck");
        close(contact.normal_reaction, by_length, 1e-12, "normal reaction");
        close(contact.tangential_reaction[0], by_length * ahead, 1e-12, "traction");
        // ½ EA L0 ε² with ε = 1 - L/L0.
        let strain = 0.5 * 1.5_f64.hypot(1.0) * (by_length * ahead.hypot(1.0)).powi(2);
        close(increment.energy.strain, strain, 1e-12, "strain energy");
    }
}

/// A smooth ball of radius 1 moves by s to the right under a node on springs k = 2 that is pressed by 1/2. The node
/// leans back on it by φ from the top: the force `(-k u_x, -p - k u_y)` is along the normal where
/// `tan φ = k s/(p - k)`.
#[test]
fn a_ball_moves_under_a_node() {
    let request = typed(json!({
        "model": {
            "name": "ball under a node", "dimension": 2, "nodes": {"node": [0, 1]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[2, 0], [0, 2]]}],
            "obstacles": {"ball": {"kind": "ball", "center": [0, 0], "radius": 1}},
            "contacts": [{"node": "node", "obstacle": "ball", "friction": 0}],
            "stages": [
                {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 0.5}},
                {"name": "move", "obstacle_motion": {"ball": [1, 0]}, "until": {"load_above": 0.4}}
            ]
        }
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    for increment in increments.iter().filter(|increment| &*increment.stage == "move") {
        let s = increment.load_factor;
        let (sine, cosine) = (2.0 * s / -1.5).atan().sin_cos();
        let at = place(&request, increment, "node");
        close(at[0], s + sine, 1e-12, "x");
        close(at[1], cosine, 1e-12, "y");
        let normal = 2.0 * (s * sine + 1.0 - cosine) + 0.5 * cosine;
        close(increment.contacts[0].normal_reaction, normal, 1e-11, "reaction");
    }
}
