//! Stages that begin at a limit point, and stages whose end is passed within a jump.

use super::{jump, von_mises};
use crate::common::paths::{close, scene_file, trace, typed};
use arcslip::model::JobRequest;
use arcslip::result::increment::PointKind;
use arcslip::result::stop_reason::StopReason;
use itertools::iproduct;
use serde_json::{Value, json};

/// Von Mises' truss under these stages, which jumps where its path ends.
fn truss(stages: &Value) -> JobRequest {
    typed(von_mises(stages, &json!({"on_path_end": "jump", "record": {"stability": true}})))
}

#[test]
fn a_stage_that_begins_at_a_limit_point_jumps_at_once() {
    let first = json!({"name": "up", "forces": {"apex": [0, -1]}, "until": {"limit_points": 1}});
    for force in [[0.0, -1.0], [1.0, -1.0], [0.0, -0.01]] {
        let on = json!({"name": "on", "forces": {"apex": force}, "control": "load", "until": {"load_above": 0.01}});
        let (increments, report) = trace(&truss(&json!([first, on])));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{force:?}");
        let (before, after) = jump(&increments);
        assert_eq!(before.point.kind, PointKind::Start, "{force:?}");
        let event = before.point.event.as_deref().expect("an event");
        assert_eq!(event, "stage \"on\" begins; the load cannot rise: the structure jumps");
        assert!(after.displacements["apex"][1] < -1.0);
        let loads = increments[before.index as usize..].iter().map(|one| one.load_factor);
        assert!(loads.is_sorted(), "the load rises");
    }
    // The load falls without more ado.
    let back = json!({"name": "back", "forces": {"apex": [0, 1]}, "control": "load", "until": {"load_above": 0.01}});
    let (increments, report) = trace(&truss(&json!([first, back])));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!(increments.iter().all(|one| one.point.kind != PointKind::Jump));
}

/// A horizontal force does no work on the vertical motion that is free at the limit point: first order tells no direction. With
/// the place `(x, y)` of the apex and the bars' length `l`, where `l^3 = L` at the limit point, the energy has there
/// `E_yyy = 6 y/(L l^2)` and `E_xxy = -2 y (2 - y^2)/(L l^2)`: two branches cross, `dy = +-sqrt((2 - y^2)/3) dx`, and on each the
/// load rises to one side. Of these two directions the arc length goes on with the motion that was free, and the load alone
/// towards the stable branch, whatever the axes are.
#[test]
fn a_stage_whose_load_does_no_work_on_the_motion_of_a_limit_point_has_the_directions_of_second_order() {
    let first = json!({"name": "up", "forces": {"apex": [0, -1]}, "until": {"limit_points": 1}});
    for (force, control) in iproduct!([[1.0, 0.0], [-1.0, 0.0]], ["path", "load"]) {
        let on = json!({"name": "on", "forces": {"apex": force}, "until": {"load_above": 0.05}, "control": control});
        let analysis = json!({"arc_length": {"initial": 1e-3}, "record": {"stability": true}});
        let (increments, report) = trace(&typed(von_mises(&json!([first, on]), &analysis)));
        let start = increments.iter().find(|one| &*one.stage == "on").expect("a start");
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", start.point);
        let directions = start.directions.as_ref().expect("directions");
        assert_eq!(directions.len(), 4);
        let square = 1.25_f64.cbrt() - 1.0;
        let slope = ((2.0 - square) / 3.0).sqrt();
        assert_eq!(directions.iter().filter(|one| one.load_rate > 0.0).count(), 2);
        assert!(start.point.bifurcation);
        let next = &increments[start.index as usize + 1];
        let [x, y] = [0, 1].map(|axis| next.displacements["apex"][axis] - start.displacements["apex"][axis]);
        close(y.abs() / x.abs(), slope, 20.0 * next.step, "the slope of a branch");
        assert!(x * force[0] > 0.0 && next.step < 2e-3, "{x}, {}", next.step);
        let negative = next.stability.as_ref().expect("stability").negative_eigenvalues;
        assert_eq!((y < 0.0, negative), if control == "path" { (true, Some(1)) } else { (false, Some(0)) });
    }
}

#[test]
fn a_stage_ends_at_rest_where_its_end_is_passed_within_a_jump() {
    let next = json!({"name": "next", "forces": {"apex": [1, 0]}, "until": {"load_above": 0.001}});
    let far = json!({"name": "far", "forces": {"apex": [0, -1]}, "until": {"load_above": 0.05}, "control": "load"});
    let landed = jump(&trace(&truss(&json!([far]))).0).1.clone();
    for until in [
        json!({"displacement": {"node": "apex", "component": "y", "below": -0.8}}),
        json!({"increments": landed.index}),
    ] {
        let press = json!({"name": "press", "forces": {"apex": [0, -1]}, "control": "load", "until": until});
        let request = truss(&json!([press, next]));
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{until}");
        let after = jump(&increments).1;
        close(after.displacements["apex"][1], landed.displacements["apex"][1], 1e-12, "the state at rest");
        assert!(after.point.event.as_deref().expect("an event").ends_with("; stage \"press\" ends"));
        let begins = &increments[after.index as usize + 1];
        assert_eq!((begins.point.kind, &*begins.stage), (PointKind::Start, "next"));
    }
}

/// Klarbring's node at its nonsmooth limit point: it sticks while the pull falls or turns, as it does just below that point,
/// though slip would dissipate. Along the slip an eigenvalue is negative.
#[test]
fn a_load_that_turns_at_a_nonsmooth_limit_point_goes_back_along_the_stable_branch() {
    let request = |stages: Value| {
        let mut request = serde_json::to_value(scene_file("klarbring")).expect("JSON");
        let press = request["model"]["stages"][0].clone();
        let mut all = vec![press];
        all.extend(stages.as_array().expect("stages").iter().cloned());
        request["model"]["stages"] = json!(all);
        request["analysis"] = json!({"record": {"stability": true}, "max_increments": 400});
        typed(request)
    };
    let pull = |value: f64| json!({"name": "pull", "forces": {"node": [value, 0]}});
    let mut turned = pull(1.0);
    (turned["control"], turned["history"]) = (json!("load"), json!([1.5, 0.5, 1.4]));
    let mut limit = pull(1.0);
    limit["until"] = json!({"limit_points": 1});
    let mut back = pull(-1.0);
    (back["name"], back["control"], back["until"]) = (json!("back"), json!("load"), json!({"load_above": 0.5}));
    for stages in [json!([turned]), json!([limit, back])] {
        let (increments, report) = trace(&request(stages));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        for one in &increments {
            assert!(one.displacements["node"].iter().all(|part| part.abs() < 1e-12), "it sticks: {one:?}");
            assert_eq!(one.stability.as_ref().and_then(|stability| stability.negative_eigenvalues), Some(0));
        }
    }
}

/// At the limit load of von Mises' truss a support moves outwards: of two branches along which its motion goes on the truss
/// takes the stable one, on which it rises.
#[test]
fn a_support_that_moves_at_a_limit_point_takes_the_stable_branch() {
    let first = json!({"name": "up", "forces": {"apex": [0, -1]}, "until": {"limit_points": 1}});
    let on = json!({"name": "on", "displacements": {"left": [0.05, 0]}, "control": "load", "until": {"load_above": 1}});
    let (increments, report) = trace(&typed(von_mises(&json!([first, on]), &json!({"record": {"stability": true}}))));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let [start, end] =
        [increments.iter().find(|one| &*one.stage == "on"), increments.last()].map(|one| one.expect("one"));
    assert!(end.displacements["apex"][1] > start.displacements["apex"][1] + 0.1, "{end:?}");
    assert_eq!(end.stability.as_ref().and_then(|stability| stability.negative_eigenvalues), Some(0));
}
