//! Random scenes under a load that only rises: where a jump ends, it ends in a stable state of equilibrium.

use super::flat_truss;
use crate::common::paths::{Traced, judged};
use crate::common::random::{Numbers, random_frame, random_scene, random_space};
use crate::common::random_curves::random_on_curve;
use crate::common::random_solids::random_solid;
use arcslip::model::JobRequest;
use arcslip::model::request::{OnPathEnd, Record, StageControl};
use arcslip::result::increment::{DeadLoadStability, PointKind};
use arcslip::result::stop_reason::StopReason;
use std::collections::BTreeMap;

/// The scene with a load that only rises, and with the stability of each increment.
pub fn under_load(mut request: JobRequest) -> JobRequest {
    for stage in &mut request.model.stages {
        stage.control = StageControl::Load;
        if let Some(until) = &mut stage.until {
            (until.limit_points, until.contact_change) = (None, None);
            if until.load_above.is_some() {
                until.load_below = None;
            }
        }
    }
    request.analysis.on_path_end = OnPathEnd::Jump;
    request.analysis.record.get_or_insert_with(Record::default).stability = true;
    request
}

/// What was found over many scenes.
#[derive(Debug, Default)]
struct Found {
    jumps: usize,
    /// Jumps to states that are not known to be stable.
    doubtful: Vec<(u64, u64)>,
    reasons: BTreeMap<String, Vec<u64>>,
    faults: Vec<String>,
}

impl Found {
    fn over(scenes: impl Fn(u64) -> JobRequest, seeds: std::ops::Range<u64>) -> Self {
        let mut found = Self::default();
        for seed in seeds {
            let traced = judged(&under_load(scenes(seed)));
            found.note(seed, &traced);
        }
        println!("{found:?}");
        found
    }

    fn note(&mut self, seed: u64, traced: &Traced) {
        let mut before: Option<(String, f64)> = None;
        for (one, errors) in traced.increments.iter().zip(&traced.errors) {
            // Where a mechanism moves without load there is no energy to balance.
            let energies = [one.energy.external_work, one.energy.strain, one.energy.released];
            let has_energy = energies.iter().any(|energy| energy.abs() > 1e-9);
            if errors.largest_of_state() > 1e-9 || errors.energy > 1e-6 && has_energy {
                self.faults.push(format!("{seed}, increment {}: {errors:?}", one.index));
            }
            let stage = one.stage.to_string();
            let falls = before
                .as_ref()
                .is_some_and(|(name, load)| *name == stage && one.load_factor < *load - 1e-9 * load.abs());
            if falls {
                self.faults.push(format!("{seed}, increment {}: the load falls", one.index));
            }
            before = Some((stage, one.load_factor));
            if one.point.kind == PointKind::Jump {
                self.jumps += 1;
                if one.stability.is_none_or(|stability| stability.dead_load != DeadLoadStability::Stable) {
                    self.doubtful.push((seed, one.index));
                }
            }
        }
        self.reasons.entry(format!("{:?}", traced.report.stop_reason)).or_default().push(seed);
    }

    fn count(&self, reason: StopReason) -> usize {
        self.reasons.get(&format!("{reason:?}")).map_or(0, Vec::len)
    }
}

#[test]
fn a_hundred_trusses_jump_to_stable_states() {
    let found = Found::over(|seed| flat_truss(&mut Numbers(seed)), 0..100);
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    assert!(found.jumps >= 150, "{} jumps", found.jumps);
    assert!(found.doubtful.is_empty(), "{:?}", found.doubtful);
    assert_eq!(found.count(StopReason::StagesCompleted), 100, "{:?}", found.reasons);
}

#[test]
fn scenes_of_every_kind_jump_and_go_on() {
    type Scenes = (&'static str, fn(u64) -> JobRequest, u64);
    let kinds: [Scenes; 5] = [
        ("scenes", random_scene, 25),
        ("frames", random_frame, 25),
        ("curves", random_on_curve, 25),
        ("space", random_space, 25),
        ("solids", random_solid, 4),
    ];
    for (kind, scenes, seeds) in kinds {
        println!("{kind}");
        let found = Found::over(scenes, 0..seeds);
        assert!(found.faults.is_empty(), "{kind}: {:?}", found.faults);
    }
}
