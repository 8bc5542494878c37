//! Sliders in a row (a hundred of them: `many_contacts`): block m+1 starts to slip exactly at `s = (m+1) μ W`, block m then having moved `μ W/k` past block
//! m+1's rest position; when the last one slips nothing resists any more.

use crate::common::paths::{close, scene_file, trace, typed};
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

fn check(increments: &[Increment], n: usize, friction: f64, weight: f64, stiffness: f64) {
    let force = friction * weight;
    let pull: Vec<&Increment> = increments.iter().filter(|increment| &*increment.stage == "pull").collect();
    let events: Vec<&&Increment> =
        pull.iter().filter(|i| matches!(i.point.kind, PointKind::ContactChange | PointKind::End)).collect();
    assert_eq!(events.len(), n, "one event a block");
    for (m, event) in events.iter().enumerate() {
        close(event.load_factor, (m + 1) as f64 * force, 1e-10, "load at which the next block slips");
        // The spring before block k carries what the blocks from k to m hold back.
        for block in 0..m {
            let here = event.displacements[format!("block{block}").as_str()][0];
            let next = event.displacements[format!("block{}", block + 1).as_str()][0];
            close((here - next) * stiffness, (m - block) as f64 * force, 1e-10 * n as f64, "force of a spring");
        }
        let still = &event.displacements[format!("block{m}").as_str()];
        close(still[0], 0.0, 1e-12, "the block has not moved yet");
    }
    for increment in &pull {
        for (block, contact) in increment.contacts.iter().enumerate() {
            close(contact.normal_reaction, weight, 1e-10, "weight");
            let slips = (block as f64) < increment.load_factor / force - 1.0 - 1e-9;
            assert!(contact.status == Status::Slip || !slips, "block {block} at {}", increment.load_factor);
        }
    }
}

#[test]
fn five_built_in() {
    let (increments, report) = trace(&scene_file("slider-chain"));
    assert_eq!(report.stop_reason, StopReason::Mechanism);
    check(&increments, 5, 0.5, 1.0, 1.0);
}

/// Two sliders of friction bound `μ` on a spring each, of stiffness 1, joined by one of stiffness `k`, are pushed at the
/// second one until both slip, and back. While the first one sticks it stays on its cone, and the second one leaves its
/// own. The push slips at `μ` and `2μ + μ/k`, the way back at `2μ` and `4μ + 2μ/k`.
#[test]
fn stiffly_joined_sliders_slip_back_at_exact_loads() {
    for (exponent, friction) in (0..=14).map(|half| f64::from(half) / 2.0).flat_map(|e| [(e, 0.3), (e, 0.7)]) {
        let stiffness = 10.0_f64.powf(exponent).round();
        let spring = |nodes: &[&str], along: f64, up: f64| json!({"kind": "spring", "nodes": nodes, "stiffness": [[along, 0], [0, up]]});
        let stage = |name: &str, forces: Value, until: f64| json!({"name": name, "forces": forces, "until": {"load_above": until}});
        let request = typed(json!({"model": {
            "dimension": 2, "nodes": {"first": [0, 0], "second": [1, 0]},
            "elements": [spring(&["first", "second"], stiffness, 0.0), spring(&["first"], 1.0, 1.0), spring(&["second"], 1.0, 1.0)],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "first", "obstacle": "floor", "friction": friction},
                         {"node": "second", "obstacle": "floor", "friction": friction}],
            "stages": [stage("press", json!({"first": [0, -1], "second": [0, -1]}), 1.0),
                       stage("push", json!({"second": [1, 0]}), 4.0), stage("back", json!({"second": [-1, 0]}), 6.0)]
        }}));
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{stiffness}");
        let changes = increments.iter().filter(|increment| increment.point.kind == PointKind::ContactChange);
        let loads: Vec<(&str, f64)> = changes.map(|increment| (&*increment.stage, increment.load_factor)).collect();
        let rest = friction / stiffness;
        let exact = [
            ("push", friction),
            ("push", 2.0 * friction + rest),
            ("back", 2.0 * friction),
            ("back", 4.0 * friction + 2.0 * rest),
        ];
        assert_eq!(loads.len(), 4, "{stiffness}: {loads:?}");
        for ((stage, load), (exact_stage, exact)) in loads.iter().zip(exact) {
            assert_eq!(*stage, exact_stage, "{stiffness}: {loads:?}");
            // What rounded displacements leave in the force of the spring.
            close(*load, exact, 1e-11 + 2e-15 * stiffness, "load at which a slider slips");
        }
    }
}
