//! Inertial motions that rough obstacles stop.

use crate::common::paths::{request, trace, typed};
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

/// Where the reaction of a slipping contact vanishes in a time step, lift-off and stick dissipate alike, and the forces of
/// the step go on along lift-off alone: a step that took the other never reached its end, however short.
#[test]
fn mass_that_rough_planes_stop_together_comes_to_rest() {
    for (name, model, near) in [
        ("truss", include_str!("../models/truss-stopped-by-rough-planes.json"), 1e-5),
        ("tripod", include_str!("../models/tripod-stopped-by-rough-planes.json"), 6e-3),
    ] {
        let at_rest = |tolerance: f64| {
            let mut request = request(model);
            request.analysis.jump_motion.as_mut().expect("a motion").tolerance = tolerance;
            let (increments, report) = trace(&request);
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{name}");
            let last = increments.last().expect("an increment");
            let energy = &last.energy;
            let kept = energy.strain + energy.dissipated + energy.released;
            assert!((energy.external_work - kept).abs() < 1e-8, "{name}: {energy:?}");
            last.displacements["a"].to_vec()
        };
        let [coarse, fine] = [1e-2, 1e-4].map(at_rest);
        let apart = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < near, "{name}: {coarse:?} and {fine:?}");
    }
}

/// A press comes down on a node that a rough stop holds: where the angle between the two is below that of friction there is
/// no state at rest, and no motion.
#[test]
fn a_node_that_jams_under_a_press_has_no_equilibrium() {
    for kind in ["overdamped", "inertial"] {
        let request = typed(json!({
            "model": {
                "dimension": 2, "nodes": {"left": [-1.2, 0], "node": [-0.12, 0.5], "right": [1.3, 0]},
                "supports": {"left": ["x", "y"], "right": ["x", "y"]},
                "elements": [
                    {"kind": "bar", "nodes": ["left", "node"], "axial_stiffness": 1},
                    {"kind": "bar", "nodes": ["node", "right"], "axial_stiffness": 1},
                ],
                "obstacles": {
                    "stop": {"kind": "plane", "point": [0, 0.056], "normal": [-0.2, 1]},
                    "press": {"kind": "plane", "point": [0, 1], "normal": [0, -1]},
                },
                "contacts": [
                    {"node": "node", "obstacle": "stop", "friction": 0.8},
                    {"node": "node", "obstacle": "press", "friction": 0},
                ],
                "stages": [{
                    "name": "press", "obstacle_motion": {"press": [0, -1]}, "control": "load",
                    "until": {"load_above": 1.5},
                }],
            },
            "analysis": {"jump_motion": {"kind": kind}},
        }));
        let (_, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::NoEquilibrium, "{kind}: {report:?}");
        assert!(report.sentence.contains("its motion cannot begin"), "{kind}: {report:?}");
    }
}
