//! Changes of contact that vanish in the parameter, beside a closed form.

use crate::common::paths::{close, trace, typed};
use crate::limit_curves::{curve_of, ended, followed};
use arcslip::result::increment::PointKind;
use arcslip::studies::critical_curves::CurveRow;
use serde_json::json;

const WEIGHT: f64 = 0.2;

/// The friction that holds the foot of von Mises' truss at a height of its apex, `EA = b = 1`, `h = 1/2`: the thrust over the
/// force on the floor.
fn friction_at(height: f64) -> f64 {
    let force = 1.0 / height.hypot(1.0) - 1.0 / 1.25_f64.sqrt();
    force / (WEIGHT + force * height)
}

/// The friction above which the foot never slips, and the height at which it nearly does, by golden section.
fn holding_friction() -> (f64, f64) {
    let part = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (-0.5, 0.5);
    for _ in 0..200 {
        let [first, second] = [high - part * (high - low), low + part * (high - low)];
        if friction_at(first) > friction_at(second) { high = second } else { low = first }
    }
    let height = low.midpoint(high);
    (friction_at(height), height)
}

/// The foot slips along a stretch that shrinks to nothing as friction grows: the change at which it begins to slip ends where
/// its bound is touched only, that at which it stops ends where it meets the first one, at the same friction.
#[test]
fn a_stretch_of_slip_vanishes_at_a_known_friction() {
    let request = typed(json!({
        "model": {
            "dimension": 2, "nodes": {"left": [-1, 0], "apex": [0, 0.5], "foot": [1, 0]},
            "supports": {"left": ["x", "y"]},
            "elements": [
                {"kind": "bar", "nodes": ["left", "apex"], "axial_stiffness": 1},
                {"kind": "bar", "nodes": ["apex", "foot"], "axial_stiffness": 1},
                {"kind": "spring", "nodes": ["foot"], "stiffness": [[0.5, 0], [0, 0]]},
            ],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "foot", "obstacle": "floor", "friction": 0.5}],
            "stages": [
                {"name": "weight", "forces": {"foot": [0, -WEIGHT]}, "until": {"load_above": 1}},
                {"name": "press", "forces": {"apex": [0, -1]}, "until": {"load_above": 0.1}},
            ],
        },
    }));
    let (friction, height) = holding_friction();
    let (increments, _) = trace(&request);
    let changes: Vec<u64> =
        increments.iter().filter(|one| one.point.kind == PointKind::ContactChange).map(|one| one.index).collect();
    let [begins, stops] = changes[..] else { panic!("{changes:?}") };
    let follow = |increment: u64| {
        let settings = json!({
            "parameter": "/model/contacts/0/friction", "range": [0.3, 0.8], "step": 0.05, "increment": increment,
        });
        followed(&curve_of(&request, &settings).expect("a curve")).expect("a curve")
    };
    let found = follow(begins);
    let why = ended(&found).ends_above.clone().expect("a reason");
    assert!(why.contains("foot begins to slip on floor by touching the bound only"), "{why}");
    let last = found.rows.last().expect("a row");
    assert!(last.codimension_two, "{last:?}");
    close(last.value, friction, 1e-13, "the friction above which the foot never slips");
    close(last.displacements["apex"][1], height - 0.5, 1e-6, "the height of the apex there");
    for CurveRow { value, displacements, .. } in &found.rows {
        close(*value, friction_at(0.5 + displacements["apex"][1]), 1e-12, "the friction at which it begins to slip");
    }
    let found = follow(stops);
    let why = ended(&found).ends_above.clone().expect("a reason");
    let what = "foot begins to slip on floor and foot stops slipping on floor at the same place";
    assert!(why.contains(what), "{why}");
    let (_, after) = why.split_once("meet at ").expect("a value");
    let value: f64 = after.split_whitespace().next().expect("a value").parse().expect("a number");
    close(value, friction, 1e-9, "the friction at which both meet");
}
