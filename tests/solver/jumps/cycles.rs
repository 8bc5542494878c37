//! Loads that go to and fro: closed loops of hysteresis.

use super::{jump, von_mises};
use crate::common::paths::{Traced, close, judged, trace, typed};
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// A von Mises truss that is held by a soft spring, pushed to and fro.
fn truss(history: &[f64], cycles: u64) -> Value {
    let stage = json!({
        "name": "cycle", "forces": {"apex": [0, -1]}, "control": "load", "history": history, "cycles": cycles
    });
    von_mises(&json!([stage]), &json!({"max_increments": 100_000}))
}

/// The last increments of the cycles: those at which the load reaches a number.
fn at_load(increments: &[Increment], load: f64) -> Vec<&Increment> {
    let turns = increments.iter().filter(|one| one.point.event.as_deref().is_some_and(|event| event.contains("turns")));
    turns.filter(|one| one.load_factor == load && one.point.kind != PointKind::Start).collect()
}

#[test]
fn a_hundred_cycles_are_one_closed_loop() {
    let Traced { increments, errors, report, .. } = judged(&typed(truss(&[0.06, -0.06], 100)));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!(errors.iter().all(|errors| errors.largest_of_state() <= 1e-10));
    // Each step is held to 1e-8 of all the energy so far.
    assert!(report.largest_energy_error <= 2e-6, "{report:?}");
    let jumps = increments.iter().filter(|one| one.point.kind == PointKind::Jump).count();
    assert_eq!(jumps, 200, "one there and one back in each cycle");
    let ends = at_load(&increments, 0.06);
    assert_eq!(ends.len(), 100);
    for pair in ends.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        close(after.displacements["apex"][1], before.displacements["apex"][1], 1e-9, "place");
        close(after.energy.strain, before.energy.strain, 1e-9, "strain energy");
    }
    // What each cycle gives off is the area of the loop: the same each time.
    let of_cycle: Vec<f64> = ends.windows(2).map(|pair| pair[1].energy.released - pair[0].energy.released).collect();
    assert!(of_cycle[0] > 0.05, "{}", of_cycle[0]);
    of_cycle.iter().for_each(|one| close(*one, of_cycle[0], 1e-6, "energy of a cycle"));
    assert!(ends[99].displacements["apex"][1] < -1.0 && ends[0].displacements["apex"][1] < -1.0);
}

/// A block on a spring and a rough floor, pulled to and fro: `±F` with friction `f` and stiffness `k` goes through
/// `u = (F - f)/k` and back, and dissipates `2 f` times twice that.
#[test]
fn friction_makes_a_loop_of_known_area() {
    let request = typed(json!({
        "model": {
            "dimension": 2, "nodes": {"block": [0, 0]},
            "elements": [{"kind": "spring", "nodes": ["block"], "stiffness": [[2, 0], [0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.5}],
            "stages": [
                {"name": "press", "forces": {"block": [0, -1]}, "until": {"load_above": 1}},
                {"name": "shake", "forces": {"block": [1, 0]}, "control": "load", "history": [3, -3], "cycles": 100},
            ],
        },
        "analysis": {"max_increments": 10_000},
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let ends = at_load(&increments, 3.0);
    assert_eq!(ends.len(), 100);
    for (cycle, end) in ends.iter().enumerate() {
        close(end.displacements["block"][0], 1.25, 1e-12, "(3 - 0.5)/2");
        close(end.energy.dissipated, 0.5 * 1.25 + 0.5 * 5.0 * cycle as f64, 1e-9, "dissipation");
        assert_eq!(end.energy.released, 0.0, "nothing jumps");
    }
}

/// Displacement control: the apex is moved by its support, and nothing jumps; on a soft spring it snaps.
#[test]
fn a_soft_rig_jumps_and_a_stiff_one_does_not() {
    let request = |stiffness: f64| {
        typed(json!({
            "model": {
                "dimension": 2, "nodes": {"left": [-1, 0], "apex": [0, 0.5], "right": [1, 0], "rig": [0, 2]},
                "supports": {"left": ["x", "y"], "right": ["x", "y"], "rig": ["x", "y"]},
                "elements": [
                    {"kind": "bar", "nodes": ["left", "apex"], "axial_stiffness": 1},
                    {"kind": "bar", "nodes": ["apex", "right"], "axial_stiffness": 1},
                    {"kind": "spring", "nodes": ["apex", "rig"], "stiffness": [[stiffness, 0], [0, stiffness]]},
                ],
                "stages": [{
                    "name": "push", "displacements": {"rig": [0, -1]}, "control": "load", "until": {"load_above": 3}
                }],
            },
        }))
    };
    let (soft, _) = trace(&request(0.02));
    let (before, after) = jump(&soft);
    assert_eq!(before.point.kind, PointKind::SmoothLimit);
    assert!(after.displacements["apex"][1] < -0.9 && before.displacements["apex"][1] > -0.4);
    let (stiff, report) = trace(&request(2.0));
    assert!(stiff.iter().all(|one| one.point.kind != PointKind::Jump), "{report:?}");
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
}

/// A load that is to fall, and one that goes through several levels.
#[test]
fn the_load_follows_its_history() {
    let (increments, _) = trace(&typed(truss(&[0.02, 0.01, 0.03], 1)));
    let turns: Vec<f64> =
        increments.iter().filter(|one| one.point.kind == PointKind::End).map(|one| one.load_factor).collect();
    assert_eq!(turns, [0.02, 0.01, 0.03]);
    let mut falling = truss(&[], 1);
    falling["model"]["stages"][0] =
        json!({"name": "pull", "forces": {"apex": [0, -1]}, "control": "load", "until": {"load_below": -0.05}});
    let (increments, report) = trace(&typed(falling));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!(increments.windows(2).all(|pair| pair[1].load_factor <= pair[0].load_factor));
    assert_eq!(increments.last().expect("an end").load_factor, -0.05);
}
