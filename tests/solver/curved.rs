//! Round obstacles, outside and inside.

use crate::common::paths::{close, place, scene_file, trace, typed};
use arcslip::check::scenes::exact::bowl::bowl_load;
use arcslip::check::scenes::exact::hump::Hump;
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::{PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

const METHODS: [Method; 2] = [Method::Auto, Method::Mpec];

fn with(mut request: JobRequest, method: Method) -> JobRequest {
    request.analysis.method = method;
    request
}

/// A zero of a function between two places of different sign.
fn zero(function: impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    let sign = function(from).signum();
    for _ in 0..200 {
        let middle = 0.5 * (from + to);
        if function(middle).signum() == sign { from = middle } else { to = middle }
    }
    0.5 * (from + to)
}

#[test]
fn a_truss_slides_over_a_hump() {
    let exact = Hump::BUILT_IN;
    let slope = |angle: f64| exact.load(angle + 1e-5) - exact.load(angle - 1e-5);
    let limits = [zero(slope, -0.8, 0.0), zero(slope, 0.2, 0.68)];
    for method in METHODS {
        let request = with(scene_file("hump"), method);
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        for increment in &increments[1..] {
            let at = place(&request, increment, "tip");
            let angle = at[0].atan2(at[1]);
            let what = format!("increment {}, angle {angle}", increment.index);
            close(at[0].hypot(at[1]), 1.0, 1e-12, &what);
            close(increment.load_factor, exact.load(angle), 1e-11, &what);
            close(increment.contacts[0].normal_reaction, exact.normal_reaction(angle), 1e-11, &what);
            assert_eq!(increment.contacts[0].status, Status::Slip, "{what}");
        }
        let found: Vec<_> = increments.iter().filter(|i| i.point.kind == PointKind::SmoothLimit).collect();
        assert_eq!(found.len(), 2);
        for (found, angle) in found.iter().zip(limits) {
            close(found.load_factor, exact.load(angle), 1e-10, "limit load");
        }
    }
}

#[test]
fn a_node_climbs_out_of_a_bowl() {
    for friction in [0.0, 0.2, 0.5] {
        for method in METHODS {
            let mut request = with(scene_file("bowl"), method);
            request.model.contacts[0].friction = friction;
            let (increments, report) = trace(&request);
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "friction {friction}");
            for increment in increments.iter().filter(|increment| &*increment.stage == "push") {
                let at = place(&request, increment, "node");
                let angle = at[0].atan2(1.0 - at[1]);
                let what = format!("friction {friction}, increment {}", increment.index);
                close(at[0].hypot(1.0 - at[1]), 1.0, 1e-12, &what);
                if increment.load_factor <= friction {
                    close(at[0], 0.0, 1e-12, &what);
                } else {
                    let exact = bowl_load(0.1, friction, angle);
                    close(increment.load_factor, exact, 1e-10 * exact, &what);
                }
            }
            let begins = increments.iter().any(|i| &*i.stage == "push" && (i.load_factor - friction).abs() < 1e-12);
            assert!(begins || friction == 0.0, "slip begins at the load {friction}");
        }
    }
}

/// The same in space, in a vertical plane at any angle: the slip runs along a great circle although the frame of
/// tangents turns on the way.
#[test]
fn a_node_climbs_out_of_a_hollow_sphere() {
    let friction = 0.2;
    for direction in [0.0_f64, 0.4, 1.9] {
        let (sine, cosine) = direction.sin_cos();
        let request = typed(json!({
            "model": {
                "name": "node in a hollow sphere", "dimension": 3, "nodes": {"node": [0, 0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"],
                              "stiffness": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]}],
                "obstacles": {"bowl": {"kind": "ball", "center": [0, 0, 1], "radius": 1, "side": "inside"}},
                "contacts": [{"node": "node", "obstacle": "bowl", "friction": friction}],
                "stages": [
                    {"name": "press", "forces": {"node": [0, 0, -1]}, "until": {"load_above": 1}},
                    {"name": "push", "forces": {"node": [cosine, sine, 0]}, "until": {"load_above": 2}}
                ]
            },
            "analysis": {"arc_length": {"initial": 0.02, "min": 1e-9, "max": 0.1, "displacement_scale": 1,
                                        "load_scale": 1}}
        }));
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let mut slid = false;
        for increment in increments.iter().filter(|i| &*i.stage == "push" && i.load_factor > friction) {
            let at = place(&request, increment, "node");
            let (along, across) = (cosine * at[0] + sine * at[1], cosine * at[1] - sine * at[0]);
            close(across, 0.0, 1e-10, "across the push");
            let exact = bowl_load(0.1, friction, along.atan2(1.0 - at[2]));
            close(increment.load_factor, exact, 1e-9, "load");
            slid |= increment.contacts[0].status == Status::Slip;
        }
        assert!(slid);
    }
}

/// A node on springs (k = 1) is pressed onto the top of a ball from above it: first touch at the gap, then the load
/// goes into the ball; let go again, it lifts off at the same load.
#[test]
fn touch_and_lift_off_of_a_ball() {
    let request = typed(json!({
        "model": {
            "name": "node above a ball", "dimension": 2, "nodes": {"node": [0, 1.25]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
            "obstacles": {"ball": {"kind": "ball", "center": [0, 0], "radius": 1}},
            "contacts": [{"node": "node", "obstacle": "ball", "friction": 0.4}],
            "stages": [
                {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 0.5}},
                {"name": "lift", "forces": {"node": [0, 1]}, "until": {"load_above": 0.5}}
            ]
        }
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    for increment in &increments {
        let load = if &*increment.stage == "press" { increment.load_factor } else { 0.5 - increment.load_factor };
        close(increment.displacements["node"][1], -load.min(0.25), 1e-12, "height");
        close(increment.contacts[0].normal_reaction, (load - 0.25).max(0.0), 1e-12, "reaction");
    }
    let events: Vec<_> =
        increments.iter().filter(|increment| increment.point.kind == PointKind::ContactChange).collect();
    assert_eq!(events.len(), 2, "touch and lift-off");
    events.iter().for_each(|event| close(event.load_factor, 0.25, 1e-10, "load of an event"));
}

/// A node in space sticks to the lowest point of a ball that moves sideways: two axes are equally aligned with the normal
/// there but for round-off, and the tangents of the increments refer to the first of them throughout.
#[test]
fn tangents_at_the_apex_of_a_ball_stay_in_order() {
    let request = typed(json!({
        "model": {
            "name": "node under a ball", "dimension": 3, "nodes": {"node": [0, 0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"],
                "stiffness": [[1, 0.1, 0.2], [0.1, 0.9, 0.15], [0.2, 0.15, 1.3]]}],
            "obstacles": {"ball": {"kind": "ball", "center": [0, 0, 3], "radius": 3}},
            "contacts": [{"node": "node", "obstacle": "ball", "friction": 5}],
            "stages": [
                {"name": "press", "obstacle_motion": {"ball": [0, 0, -0.3]}, "until": {"load_above": 1}},
                {"name": "push", "obstacle_motion": {"ball": [0.17, 0.05, 0]}, "until": {"load_above": 1}}
            ]
        },
        "analysis": {"arc_length": {"max": 0.03}}
    }));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!(increments.len() > 40);
    for increment in &increments {
        let contact = &increment.contacts[0];
        // The normal is -z: the tangents are x, and n × x = -y.
        close(contact.tangential_reaction[0], contact.reaction[0], 1e-14, "along x");
        close(contact.tangential_reaction[1], -contact.reaction[1], 1e-14, "along y");
    }
}
