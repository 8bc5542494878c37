//! Motions without stress: a bar, a triangle of bars and a beam that turn about a pin, moved by their supports. The exact
//! path is a circle; forces and energies are round-off.

use crate::common::paths::{request, trace};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// A bar from the origin whose free end is raised from the x axis by 0.9 of its length.
fn bar(stiffness: f64, length: f64) -> Value {
    json!({
        "dimension": 2, "nodes": {"pin": [0, 0], "tip": [length, 0]},
        "supports": {"pin": ["x", "y"], "tip": ["y"]},
        "elements": [{"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": stiffness}],
        "stages": [{"name": "raise", "displacements": {"tip": [0, 0.9 * length]}, "until": {"load_above": 1}}]
    })
}

/// A triangle of three bars that turns about its first corner.
fn triangle(stiffness: f64, length: f64) -> Value {
    let side = |a: &str, b: &str| json!({"kind": "bar", "nodes": [a, b], "axial_stiffness": stiffness});
    let mut model = bar(stiffness, length);
    model["nodes"]["third"] = json!([0.3 * length, 0.8 * length]);
    model["elements"] = json!([side("pin", "tip"), side("pin", "third"), side("tip", "third")]);
    model
}

/// A chain of beams whose first node is turned by an angle.
fn turned_beam(stiffness: f64, length: f64, angle: f64) -> Value {
    let node = |k: usize| [length * k as f64 / 4.0, 0.0];
    let beam = |k: usize| {
        json!({"kind": "beam", "nodes": [format!("n{}", k), format!("n{}", k + 1)], "axial_stiffness": stiffness,
            "bending_stiffness": 1e-4 * stiffness * length * length})
    };
    json!({
        "dimension": 2, "nodes": {"n0": node(0), "n1": node(1), "n2": node(2), "n3": node(3), "n4": node(4)},
        "supports": {"n0": ["x", "y", "rz"]}, "elements": [beam(0), beam(1), beam(2), beam(3)],
        "stages": [{"name": "turn", "displacements": {"n0": [0, 0, angle]}, "until": {"load_above": 1}}]
    })
}

/// Follows a scene whose `tip` runs on a circle about the origin up to an angle; returns the number of increments.
fn follow(name: &str, model: &Value, tip: &str, length: f64, angle: f64) -> usize {
    let (increments, report) = trace(&request(&json!({"model": model}).to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{name}: {report:?}");
    for increment in &increments {
        let moved = &increment.displacements[tip];
        let radius = (length + moved[0]).hypot(moved[1]);
        assert!((radius / length - 1.0).abs() < 1e-12, "{name}: increment {}: radius {radius}", increment.index);
    }
    let last = increments.last().expect("an end");
    let moved = &last.displacements[tip];
    let (x, y) = (length * angle.cos() - length, length * angle.sin());
    let error = (moved[0] - x).abs().max((moved[1] - y).abs()) / length;
    println!("{name}: {} increments, error of the end {error:.1e}", increments.len());
    assert!(error < 1e-11, "{name}: {error}");
    assert!(report.largest_energy_error < 1e-6, "{name}: {}", report.largest_energy_error);
    increments.len()
}

/// The length of steps follows the path, not the round-off of forces: as many increments for any stiffness and size.
#[test]
fn motions_without_stress_take_few_increments() {
    let raised = 0.9_f64.asin();
    for stiffness in [1.0, 1e6, 1e12] {
        for length in [1e-3, 1.0, 1e3] {
            let name = |what: &str| format!("{what}, EA = {stiffness:e}, length {length:e}");
            let counts = [
                follow(&name("bar"), &bar(stiffness, length), "tip", length, raised),
                follow(&name("triangle"), &triangle(stiffness, length), "tip", length, raised),
                follow(&name("beam"), &turned_beam(stiffness, length, 2.0), "n4", length, 2.0),
            ];
            assert!(counts.iter().all(|count| *count <= 60), "{} {counts:?}", name("counts"));
        }
    }
}
