//! Where the load just about turns as a node begins to slip.
//!
//! Klarbring's node (stiffness `[[1, -0.8], [-0.8, 1]]`, pressed by 1, pulled by s): while it slips `s = μ + (1 - 0.8 μ) u`, up to
//! u = 1.25, s = 1.25, where it leaves the floor and the load rises. Beyond the critical friction 1.25 the load falls while it
//! slips, however slowly: it turns where the slip begins, and again where the node leaves.

use crate::common::paths::{close, request, trace};
use arcslip::result::increment::PointKind;
use serde_json::json;

const CRITICAL: f64 = 1.25;

/// Kind, load and whether it is a bifurcation point, of each event while it is pulled.
fn events(friction: f64, unit: f64) -> Vec<(PointKind, f64, bool)> {
    let document = json!({"model": {"dimension": 2, "nodes": {"node": [0, 0]},
        "elements": [{"kind": "spring", "nodes": ["node"],
            "stiffness": [[unit, -0.8 * unit], [-0.8 * unit, unit]]}],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [{"node": "node", "obstacle": "floor", "friction": friction}],
        "stages": [{"name": "press", "forces": {"node": [0, -unit]}, "until": {"load_above": 1}},
            {"name": "pull", "forces": {"node": [unit, 0]}, "until": {"load_above": 2}}]}});
    let (increments, _) = trace(&request(&document.to_string()));
    let events = increments.iter().filter(|one| {
        let is_event = !matches!(one.point.kind, PointKind::Start | PointKind::Regular | PointKind::End);
        &*one.stage == "pull" && is_event
    });
    events.map(|one| (one.point.kind, one.load_factor, one.point.bifurcation)).collect()
}

#[test]
fn a_load_that_turns_ever_so_slowly_has_limit_points() {
    for unit in [1.0, 1e9] {
        for exponent in 2..=13 {
            let little = 10.0_f64.powi(-exponent);
            for (friction, turns) in [(CRITICAL * (1.0 + little), true), (CRITICAL * (1.0 - little), false)] {
                let found = events(friction, unit);
                let kind = if turns { PointKind::NonsmoothLimit } else { PointKind::ContactChange };
                assert_eq!(found.len(), 2, "{friction}: {found:?}");
                assert_eq!([found[0].0, found[1].0], [kind; 2], "{friction}: {found:?}");
                close(found[0].1, friction, 1e-12, "load at which it slips");
                close(found[1].1, CRITICAL, 1e-12, "load at which it leaves");
                // It may stick as the load falls, or slip on.
                assert_eq!(found[0].2, turns, "{friction}: {found:?}");
            }
        }
    }
}
