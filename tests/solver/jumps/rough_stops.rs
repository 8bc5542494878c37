//! Inertial motions that rough obstacles stop.

use crate::common::paths::{request, trace};
use arcslip::result::stop_reason::StopReason;

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
