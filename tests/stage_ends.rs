//! A stage ends exactly where it says, however the step or an event falls.

mod common;

use arcslip::model::request::{DisplacementBound, Until};
use arcslip::path::StopReason;
use arcslip::path::increment::PointKind;
use common::generators::slider_chain;
use common::paths::{request, scene, trace};
use serde_json::json;

/// Steps that end exactly at the bound: the first step, and many equal ones.
#[test]
fn a_step_that_ends_at_the_bound_ends_the_stage() {
    for (bound, step) in [(0.02, 0.02), (1.0, 0.1), (1.0, 0.05), (1.0, 0.125), (1.0, 0.25), (1.0, 1.0), (0.1, 0.02)] {
        let mut request = scene("klarbring");
        request.analysis.arc_length.initial = step;
        request.analysis.arc_length.max = step;
        request.analysis.arc_length.load_scale = Some(1.0);
        request.model.stages[0].until = Some(Until { load_above: Some(bound), ..Until::default() });
        request.model.stages[1].until = Some(Until { load_above: Some(bound), ..Until::default() });
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "bound {bound}, step {step}");
        for stage in ["press", "pull"] {
            let last = increments.iter().rfind(|increment| &*increment.stage == stage).expect("the stage has points");
            assert_eq!(last.load_factor, bound, "bound {bound}, step {step}");
            assert_eq!(last.point.kind, PointKind::End);
        }
    }
}

/// The corner of Klarbring's node lies exactly at the load that ends the stage.
#[test]
fn an_event_at_the_bound_ends_the_stage() {
    let mut request = scene("klarbring");
    request.model.stages[1].until = Some(Until { load_above: Some(1.5), ..Until::default() });
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let last = increments.last().expect("an end");
    assert_eq!((last.load_factor, last.displacements["node"][0]), (1.5, 0.0));
}

/// The floor holds the node exactly at the displacement that ends the stage.
#[test]
fn a_contact_at_the_bound_ends_the_stage() {
    let model = json!({"model": {
        "name": "falls onto the floor", "dimension": 2, "nodes": {"node": [0, 0]},
        "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
        "obstacles": {"floor": {"kind": "plane", "point": [0, -0.5], "normal": [0, 1]}},
        "contacts": [{"node": "node", "obstacle": "floor", "friction": 0.5}],
        "stages": [{"name": "lower", "forces": {"node": [0.1, -1]},
                    "until": {"displacement": {"node": "node", "component": "y", "below": -0.5}}}]
    }});
    let (increments, report) = trace(&request(&model.to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!((increments.last().expect("an end").load_factor - 0.5).abs() < 1e-12);
}

#[test]
fn a_bound_that_is_met_before_the_stage_begins_ends_it_at_once() {
    let mut request = scene("klarbring");
    let again = request.model.stages[0].clone();
    request.model.stages.insert(1, again);
    request.model.stages[1].name = "no further".into();
    request.model.stages[1].until = Some(Until {
        displacement: Some(DisplacementBound {
            node: "node".into(),
            component: arcslip::model::request::Component::Y,
            above: None,
            below: Some(1.0),
        }),
        ..Until::default()
    });
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!(increments.iter().all(|increment| &*increment.stage != "no further"));
}

/// The slider chain: block m+1 starts to slip exactly at `s = (m+1) μ W`, block m then having moved `μ W/k` past block
/// m+1's rest position.
#[test]
fn a_count_of_contact_changes_ends_the_slider_chain() {
    let (friction, weight, stiffness) = (0.3, 2.0, 5.0);
    for n in [2usize, 5, 7] {
        let mut model = slider_chain(n, friction, weight, stiffness);
        model["model"]["stages"][1]["until"] = json!({"contact_change": n - 1});
        let (increments, report) = trace(&request(&model.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{n}");
        let changes: Vec<_> = increments.iter().filter(|i| matches!(i.point.kind, PointKind::ContactChange)).collect();
        assert_eq!(changes.len(), n - 1);
        for (m, change) in changes.iter().enumerate() {
            let force = friction * weight;
            assert!((change.load_factor - (m + 1) as f64 * force).abs() < 1e-12, "{m}: {}", change.load_factor);
            if m > 0 {
                let moved = change.displacements[format!("block{}", m - 1).as_str()][0];
                assert!((moved - force / stiffness).abs() < 1e-12, "{m}: {moved}");
            }
        }
    }
}
