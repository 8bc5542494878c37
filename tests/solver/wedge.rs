//! A node against several obstacles at once: a groove, a corner, two coincident floors.

use crate::common::paths::{close, place, scene_file, trace, typed};
use arcslip::model::JobRequest;
use arcslip::model::request::Method;
use arcslip::result::increment::Status;
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

const METHODS: [Method; 2] = [Method::Auto, Method::Mpec];

fn with(mut request: JobRequest, method: Method) -> JobRequest {
    request.analysis.method = method;
    request
}

/// A node (springs k = 1/2) pressed by 1 into a groove of two flanks at 45° and pushed to the right. In the groove the
/// reactions of the two flanks are not unique with friction; the load at which it leaves is: the left flank carries
/// nothing and the right one is on its cone, `s = tan(45° + arctan μ) = (1 + μ)/(1 - μ)`. On the flank, at the distance
/// ξ from the bottom: `s (1 - μ) = 1 + μ + √2 k ξ`.
#[test]
fn a_groove() {
    for friction in [0.0, 0.25, 0.6] {
        for method in METHODS {
            let mut request = with(scene_file("groove"), method);
            request.model.contacts.iter_mut().for_each(|contact| contact.friction = friction);
            let (increments, report) = trace(&request);
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "friction {friction}");
            let leaves = (1.0 + friction) / (1.0 - friction);
            for increment in &increments {
                let what = format!("friction {friction}, increment {}", increment.index);
                let u = &increment.displacements["node"];
                if &*increment.stage == "press" || increment.load_factor <= leaves + 1e-9 {
                    close(u[0].hypot(u[1]), 0.0, 1e-12, &what);
                } else {
                    close(u[0], u[1], 1e-12, &what);
                    let exact = (leaves * (1.0 - friction) + u[0]) / (1.0 - friction);
                    close(increment.load_factor, exact, 1e-11, &what);
                    assert_eq!(
                        (increment.contacts[0].status, increment.contacts[1].status),
                        (Status::Free, Status::Slip)
                    );
                    let normal = (1.0 + increment.load_factor) * 0.5_f64.sqrt();
                    close(increment.contacts[1].normal_reaction, normal, 1e-11, &what);
                }
            }
            let left = increments.iter().any(|increment| (increment.load_factor - leaves).abs() < 1e-9);
            assert!(left, "leaving the groove at {leaves} is a point of the path");
        }
    }
}

/// A node on the floor (pressed by 1) pushed against a wall half a unit away, springs k = 1: it slips at μ, touches at
/// μ + 1/2 and stays in the corner. The wall is smooth, so the floor carries the press alone.
#[test]
fn a_corner() {
    for friction in [0.0, 0.3] {
        for method in METHODS {
            let request = typed(json!({
                "model": {
                    "name": "node in a corner", "dimension": 2, "nodes": {"node": [0, 0]},
                    "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                    "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                                  "wall": {"kind": "plane", "point": [0.5, 0], "normal": [-1, 0]}},
                    "contacts": [{"node": "node", "obstacle": "floor", "friction": friction},
                                 {"node": "node", "obstacle": "wall", "friction": 0}],
                    "stages": [
                        {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
                        {"name": "push", "forces": {"node": [1, 0]}, "until": {"load_above": 2}}
                    ]
                }
            }));
            let (increments, report) = trace(&with(request, method));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted);
            let touches = friction + 0.5;
            assert!(increments.iter().any(|increment| (increment.load_factor - touches).abs() < 1e-10));
            for increment in increments.iter().filter(|increment| &*increment.stage == "push") {
                let s = increment.load_factor;
                let what = format!("friction {friction}, s = {s}");
                close(increment.displacements["node"][0], (s - friction).clamp(0.0, 0.5), 1e-11, &what);
                close(increment.displacements["node"][1], 0.0, 1e-14, &what);
                let [floor, wall] = [&increment.contacts[0], &increment.contacts[1]];
                close(floor.normal_reaction, 1.0, 1e-11, &what);
                // The floor's friction and the wall share what the springs leave.
                if s >= touches {
                    close(wall.normal_reaction - floor.tangential_reaction[0], s - 0.5, 1e-10, &what);
                }
            }
        }
    }
}

/// Two coincident floors are one: the path is that of the one-bar truss, each floor carries half of `r_n = P h/L`, the
/// share of least norm.
#[test]
fn coincident_floors_share_the_reaction() {
    for method in METHODS {
        let request = with(scene_file("doubled-floor"), method);
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        for increment in &increments[1..] {
            let x = place(&request, increment, "tip")[0];
            let by_length = 1.0 / x.hypot(1.0) - 1.0 / 1.5_f64.hypot(1.0);
            let what = format!("at x = {x}");
            close(increment.load_factor, by_length * (0.3 - x), 1e-11, &what);
            for contact in &increment.contacts {
                close(contact.normal_reaction, 0.5 * by_length, 1e-10, &what);
                close(contact.tangential_reaction[0], -0.15 * by_length, 1e-10, &what);
            }
        }
    }
}

/// One, two or three coincident floors: the same stick, the same load of slip, the same slip.
#[test]
fn copies_of_a_floor_leave_a_stuck_node_stuck() {
    for copies in 1..4 {
        let planes: serde_json::Map<String, serde_json::Value> = (0..copies)
            .map(|k| (format!("floor{k}"), json!({"kind": "plane", "point": [k, 0], "normal": [0, 1 + k]})))
            .collect();
        let contacts: Vec<_> =
            (0..copies).map(|k| json!({"node": "node", "obstacle": format!("floor{k}"), "friction": 0.5})).collect();
        let request = typed(json!({
            "model": {
                "name": "node on copies of a floor", "dimension": 2, "nodes": {"node": [0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                "obstacles": planes, "contacts": contacts,
                "stages": [
                    {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
                    {"name": "push", "forces": {"node": [1, 0]}, "until": {"load_above": 1}}
                ]
            }
        }));
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{copies} copies");
        for increment in increments.iter().filter(|increment| &*increment.stage == "push") {
            let exact = (increment.load_factor - 0.5).max(0.0);
            close(increment.displacements["node"][0], exact, 1e-11, &format!("{copies} copies"));
        }
    }
}

/// A node in the corner of a floor and a wall on the left, springs k = 1, pressed into it by (-1, -1), then pushed by `push`.
fn pressed_into_a_corner(floor: f64, wall: f64, push: [f64; 2]) -> JobRequest {
    typed(json!({
        "model": {
            "name": format!("corner, friction {floor} and {wall}, push {push:?}"),
            "dimension": 2, "nodes": {"node": [0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                          "wall": {"kind": "plane", "point": [0, 0], "normal": [1, 0]}},
            "contacts": [{"node": "node", "obstacle": "floor", "friction": floor},
                         {"node": "node", "obstacle": "wall", "friction": wall}],
            "stages": [
                {"name": "press", "forces": {"node": [-1, -1]}, "until": {"load_above": 1}},
                {"name": "push", "forces": {"node": push}, "until": {"load_above": 3}}
            ]
        }
    }))
}

/// With `μ_floor μ_wall = 1` the two cones together are a half-plane: forces `R` with `R_x + μ R_y >= 0`, `μ` the floor's.
/// The corner lets go where `R = (1, 1) - s p` reaches its bound, `s = (1 + μ)/(p_x + μ p_y)`: along the floor where
/// `R_y > 0` there, along the wall where `R_x > 0`, and at once where `R = 0`.
#[test]
fn a_corner_whose_cones_span_a_half_plane_lets_go() {
    let along_the_floor = |s: f64| if s <= 1.0 { [2.5 * s - 1.5, 0.0] } else { [2.0 * s - 1.0, s - 1.0] };
    // Up the wall R_y = -R_x/3, R_x = 1 - s.
    let along_the_wall = |s: f64| {
        if s <= 1.0 { [0.0, 2.5 * s - 1.0 - (1.0 - s) / 3.0] } else { [s - 1.0, 2.5 * s - 1.0] }
    };
    let at_once = |s: f64| [s - 1.0, s - 1.0];
    type Free<'a> = &'a dyn Fn(f64) -> [f64; 2];
    let cases: [(f64, f64, [f64; 2], Free<'_>); 5] = [
        (1.0, 1.0, [1.0, 1.0], &at_once),
        (3.0, 1.0 / 3.0, [1.0, 1.0], &at_once),
        // Rounding of a coefficient leaves a half-plane.
        (1.0, 1.0 + 4e-13, [1.0, 1.0], &at_once),
        (0.5, 2.0, [2.0, 1.0], &along_the_floor),
        (3.0, 1.0 / 3.0, [1.0, 2.5], &along_the_wall),
    ];
    for method in METHODS {
        for (floor, wall, push, free) in cases {
            let (increments, report) = trace(&with(pressed_into_a_corner(floor, wall, push), method));
            let what = format!("friction {floor} and {wall}, push {push:?}");
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}");
            let leaves = (1.0 + floor) / (push[0] + floor * push[1]);
            assert!(increments.iter().any(|increment| (increment.load_factor - leaves).abs() < 1e-11), "{what}");
            for increment in increments.iter().filter(|increment| &*increment.stage == "push") {
                let s = increment.load_factor;
                let exact = if s <= leaves { [0.0; 2] } else { free(s) };
                for (found, exact) in increment.displacements["node"].iter().zip(exact) {
                    close(*found, exact, 1e-10, &format!("{what}, s = {s}"));
                }
            }
        }
    }
}

/// The same near a half-plane: a little less and the corner lets go where the force leaves the narrower sector (here at
/// its tip); a little more and the node is wedged, held by whatever reactions that takes.
#[test]
fn a_corner_just_off_a_half_plane() {
    for off in [1e-11, 1e-7] {
        let (increments, report) = trace(&pressed_into_a_corner(1.0, 1.0 - off, [1.0, 1.0]));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        close(increments[increments.len() - 1].displacements["node"][0], 2.0, 1e-10, "free at s = 3");
    }
    for off in [1e-7, 1e-4] {
        let (increments, report) = trace(&pressed_into_a_corner(1.0, 1.0 + off, [1.0, 1.0]));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let last = &increments[increments.len() - 1];
        close(last.displacements["node"][0], 0.0, 0.0, "wedged at s = 3");
        // R = (-2, -2) = r (1, -μ_wall) + q (-1, 1) with q the floor's: r off = 4, q = r + 2.
        close(last.contacts[1].normal_reaction * off, 4.0, 1e-6, "the wall's part");
    }
}

/// Nearly without end: the cone of each flank is all but a half-plane and the groove holds whatever the push. The normal
/// reaction of a flank may be lost in the rounding of the whole, its cone is kept all the same.
#[test]
fn a_groove_with_very_large_friction_holds() {
    for friction in [1e3, 1e6, 1e12, 1e75] {
        let mut request = scene_file("groove");
        request.model.contacts.iter_mut().for_each(|contact| contact.friction = friction);
        request.analysis.max_increments = 60;
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::MaxIncrements, "friction {friction}");
        assert!(report.largest_complementarity <= 1e-10, "friction {friction}: {report:?}");
        for increment in &increments {
            let u = &increment.displacements["node"];
            assert_eq!((u[0], u[1]), (0.0, 0.0), "friction {friction}");
            let [left, right] = [&increment.contacts[0], &increment.contacts[1]];
            for contact in [left, right] {
                assert!(contact.tangential_reaction[0].abs() <= friction * contact.normal_reaction, "{contact:?}");
            }
        }
    }
}

/// At the tip of a corner (the force on the node just zero) the way back is one motion, however the obstacles share its
/// force, and it is not taken: friction 0.9 and 1, pushed straight out, the node leaves at s = 1.
#[test]
fn the_way_back_into_a_corner_is_listed_once_and_not_taken() {
    for method in METHODS {
        let (increments, report) = trace(&with(pressed_into_a_corner(0.9, 1.0, [1.0, 1.0]), method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let leaves = increments
            .iter()
            .find(|increment| &*increment.stage == "push" && (increment.load_factor - 1.0).abs() < 1e-11)
            .expect("leaving is a point of the path");
        let directions = leaves.directions.as_ref().expect("directions");
        let found: Vec<_> = directions.iter().map(|one| (one.contacts.clone(), one.retrace, one.taken)).collect();
        let (held, left) = (vec![Status::Stick; 2], vec![Status::Free; 2]);
        assert_eq!(found, [(held, true, false), (left, false, true)]);
        for increment in increments.iter().filter(|increment| &*increment.stage == "push") {
            let exact = (increment.load_factor - 1.0).max(0.0);
            close(increment.displacements["node"][0], exact, 1e-11, "u_x");
        }
    }
}

/// A groove that moves as a whole by `s` carries its node (spring k = 1/2, pressed by 1) along until the spring pulls it
/// out: `k s = tan(45° + arctan μ)`.
#[test]
fn a_groove_that_moves_carries_its_node() {
    for friction in [0.0, 0.25] {
        let mut request = scene_file("groove");
        request.model.contacts.iter_mut().for_each(|contact| contact.friction = friction);
        let carried = typed(json!({
            "model": {"dimension": 2, "nodes": {"node": [0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                "stages": [{"name": "carry", "obstacle_motion": {"left": [1, 0], "right": [1, 0]},
                            "until": {"load_above": 6}}]}
        }));
        request.model.stages[1] = carried.model.stages[0].clone();
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "friction {friction}");
        let leaves = 2.0 * (1.0 + friction) / (1.0 - friction);
        assert!(increments.iter().any(|increment| (increment.load_factor - leaves).abs() < 1e-10));
        for increment in increments.iter().filter(|increment| &*increment.stage == "carry") {
            let (s, u) = (increment.load_factor, &increment.displacements["node"]);
            if s <= leaves {
                close(u[0], s, 1e-11, "carried");
                close(u[1], 0.0, 1e-12, "carried");
            } else {
                // Up the left flank by ξ in x and -ξ less in y: (k u_x, 1 + k u_y) stays on the cone.
                close(u[1], s - u[0], 1e-11, "on the left flank");
                close(0.5 * u[0], 0.5 * leaves * (1.0 + 0.5 * u[1]), 1e-10, "on its cone");
            }
        }
    }
}

/// Smooth flanks at 45° of which the left one moves by `s` along x: the node (k = 1, pressed by 1) is at their meeting
/// point `(s/2, s/2)`, and `r = (1 + s, 1)/√2`. On the way back by `-2 s` from there `r_left = (2 - 2 s)/√2` falls to zero
/// at s = 1, and the node stays on the right flank.
#[test]
fn smooth_flanks_that_move_against_each_other() {
    for method in METHODS {
        let request = typed(json!({
            "model": {
                "name": "moving flanks", "dimension": 2, "nodes": {"node": [0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                "obstacles": {"left": {"kind": "plane", "point": [0, 0], "normal": [1, 1]},
                              "right": {"kind": "plane", "point": [0, 0], "normal": [-1, 1]}},
                "contacts": [{"node": "node", "obstacle": "left", "friction": 0},
                             {"node": "node", "obstacle": "right", "friction": 0}],
                "stages": [
                    {"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}},
                    {"name": "close", "obstacle_motion": {"left": [1, 0]}, "until": {"load_above": 1}},
                    {"name": "open", "obstacle_motion": {"left": [-2, 0]}, "until": {"load_above": 2}}
                ]
            }
        }));
        let (increments, report) = trace(&with(request, method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", increments.last());
        for increment in increments.iter().filter(|increment| &*increment.stage != "press") {
            let s = increment.load_factor;
            let opening = &*increment.stage == "open";
            let place = if opening { (0.5 - s).max(-0.5) } else { 0.5 * s };
            let left = if opening { (2.0 - 2.0 * s).max(0.0) } else { 1.0 + s };
            let what = format!("{} at s = {s}", increment.stage);
            for component in &increment.displacements["node"] {
                close(*component, place, 1e-11, &what);
            }
            close(increment.contacts[0].normal_reaction, left * 0.5_f64.sqrt(), 1e-10, &what);
            close(increment.contacts[1].normal_reaction, 0.5_f64.sqrt(), 1e-10, &what);
        }
    }
}

/// A node on a floor (pressed by 1, springs k = 1) before planes that move in turn.
fn pushed(name: &str, floor: f64, wall: ([f64; 2], f64), motions: &[([f64; 2], f64)]) -> JobRequest {
    let mut stages = vec![json!({"name": "press", "forces": {"node": [0, -1]}, "until": {"load_above": 1}})];
    for (index, (motion, above)) in motions.iter().enumerate() {
        let stage = format!("move {index}");
        stages.push(json!({"name": stage, "obstacle_motion": {"wall": motion}, "until": {"load_above": above}}));
    }
    typed(json!({
        "model": {
            "name": name, "dimension": 2, "nodes": {"node": [0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]},
                          "wall": {"kind": "plane", "point": [0, 0], "normal": wall.0}},
            "contacts": [{"node": "node", "obstacle": "floor", "friction": floor},
                         {"node": "node", "obstacle": "wall", "friction": wall.1}],
            "stages": stages
        }
    }))
}

/// A wall that pushes a node over a rough floor by s: `r_wall = s + μ` where the wall is smooth. Drawn back from 2 by `3 s` it
/// is followed by the node, whose friction has turned round, to `u = μ`; there the node stays. With a rough wall the
/// reactions are not unique, the motion is the same.
#[test]
fn a_wall_pushes_a_node_over_a_rough_floor() {
    let floor = 0.3;
    for wall in [0.0, 0.4] {
        for method in METHODS {
            let name = format!("pushed by a wall of friction {wall}");
            let request = pushed(&name, floor, ([1.0, 0.0], wall), &[([1.0, 0.0], 2.0), ([-3.0, 0.0], 1.0)]);
            let (increments, report) = trace(&with(request, method));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{name}: {:?}", increments.last());
            for increment in &increments {
                let s = increment.load_factor;
                let what = format!("{name}, {} at s = {s}", increment.stage);
                let (place, pressed) = match &*increment.stage {
                    "press" => (0.0, 0.0),
                    "move 0" => (s, s + floor),
                    _ => ((2.0 - 3.0 * s).max(floor), (2.0 - 3.0 * s - floor).max(0.0)),
                };
                close(increment.displacements["node"][0], place, 1e-11, &what);
                close(increment.displacements["node"][1], 0.0, 1e-13, &what);
                // A stage that has just begun has not turned the friction round.
                if wall == 0.0 && s > 0.0 {
                    close(
                        increment.contacts[0].normal_reaction,
                        if &*increment.stage == "press" { s } else { 1.0 },
                        1e-11,
                        &what,
                    );
                    close(increment.contacts[1].normal_reaction, pressed, 1e-11, &what);
                    let way = match &*increment.stage {
                        "press" => 0.0,
                        "move 0" => s,
                        _ => 4.0 - place,
                    };
                    close(increment.energy.dissipated, floor * way, 1e-10, &what);
                }
            }
            let leaves = (2.0 - floor) / 3.0;
            assert!(increments.iter().any(|increment| (increment.load_factor - leaves).abs() < 1e-11), "{name}");
        }
    }
}

/// A plane at 45° that moves against the node by s along the floor: it pushes the node along, carrying ever more of the
/// press, until that is off the floor where the force is at the lower bound of the plane's cone, at
/// `s = L = (1 + μ)/(1 - μ)`; then the node slides up the plane, `u_x = (s + 1) L/(L + 1)`, `u_y = s - u_x`.
#[test]
fn a_moving_plane_lifts_a_node_off_the_floor() {
    let friction = 0.3;
    for method in METHODS {
        let request = pushed("lifted", 0.2, ([1.0, 1.0], friction), &[([1.0, 0.0], 4.0)]);
        let (increments, report) = trace(&with(request, method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", increments.last());
        let bound = (1.0 + friction) / (1.0 - friction);
        assert!(increments.iter().any(|increment| (increment.load_factor - bound).abs() < 1e-11));
        for increment in increments.iter().filter(|increment| &*increment.stage == "move 0") {
            let s = increment.load_factor;
            let along = if s <= bound { s } else { (s + 1.0) * bound / (bound + 1.0) };
            close(increment.displacements["node"][0], along, 1e-11, &format!("u_x at s = {s}"));
            close(increment.displacements["node"][1], s - along, 1e-11, &format!("u_y at s = {s}"));
        }
    }
}

/// A wall that moves by (s, s/2) slips on the node while it pushes it: `r_floor = (1 - μ_w s)/(1 + μ_f μ_w)`, until the
/// floor carries nothing at `s = 1/μ_w`; the node then goes up, dragged: `u = (s, μ_w s - 1)`.
#[test]
fn a_wall_that_moves_askew_drags_a_node_up() {
    let (floor, wall) = (0.2, 0.4);
    for method in METHODS {
        let request = pushed("dragged", floor, ([1.0, 0.0], wall), &[([1.0, 0.5], 4.0)]);
        let (increments, report) = trace(&with(request, method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", increments.last());
        assert!(increments.iter().any(|increment| (increment.load_factor - 1.0 / wall).abs() < 1e-11));
        for increment in
            increments.iter().filter(|increment| &*increment.stage == "move 0" && increment.load_factor > 0.0)
        {
            let s = increment.load_factor;
            let carried = ((1.0 - wall * s) / (1.0 + floor * wall)).max(0.0);
            close(increment.contacts[0].normal_reaction, carried, 1e-11, &format!("floor at s = {s}"));
            close(increment.displacements["node"][0], s, 1e-11, &format!("u_x at s = {s}"));
            close(increment.displacements["node"][1], (wall * s - 1.0).max(0.0), 1e-11, &format!("u_y at s = {s}"));
        }
    }
}

/// A node on a floor (μ = 1/2) under a plane at 45° that moves down and slips on it: carried to the left by `5/8 s`, with
/// `R = (5/4 - 9/8 x, 5/4 + 15/32 x)` at `x`. Where that is on the floor's cone, at `x = 0.625/1.359375`, the plane
/// carries nothing. It leaves, and the node stays on the floor to the end of the stage.
#[test]
fn a_node_carried_between_planes_lets_that_go_which_carries_nothing() {
    for method in METHODS {
        let request = typed(json!({
            "model": {
                "name": "let go",
                "dimension": 2,
                "nodes": {"node": [0.0, 0.0]},
                "elements": [{"kind": "spring", "nodes": ["node"],
                    "stiffness": [[1.125, -0.46875], [-0.46875, 0.890625]]}],
                "obstacles": {
                    "plane": {"kind": "plane", "point": [0.0, 0.0], "normal": [1.0, 1.0]},
                    "floor": {"kind": "plane", "point": [0.0, 0.0], "normal": [0.0, 1.0]}
                },
                "contacts": [
                    {"node": "node", "obstacle": "plane", "friction": 1.4042431888619333},
                    {"node": "node", "obstacle": "floor", "friction": 0.5}
                ],
                "stages": [
                    {"name": "press", "until": {"load_above": 1.0}, "forces": {"node": [-1.25, -1.25]}},
                    {"name": "move", "until": {"load_above": 1.0}, "obstacle_motion": {"plane": [0.125, -0.75]}}
                ]
            },
            "analysis": {"max_increments": 60}
        }));
        let (increments, report) = trace(&with(request, method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", increments.last());
        let place = 0.625 / 1.359375;
        let event = increments.iter().find(|increment| (increment.load_factor - place / 0.625).abs() < 1e-11);
        let [plane, floor] = &event.expect("the plane's force falls to zero").contacts[..] else { panic!("two") };
        assert_eq!((plane.status, floor.status), (Status::Slip, Status::Slip));
        close(plane.normal_reaction, 0.0, 1e-12, "plane");
        close(floor.normal_reaction, 1.25 + 0.46875 * place, 1e-12, "floor");
        close(floor.tangential_reaction[0], 0.5 * floor.normal_reaction, 1e-12, "friction");
        let last = increments.last().expect("an end");
        assert_eq!((last.contacts[0].status, last.contacts[1].status), (Status::Free, Status::Stick));
        close(last.load_factor, 1.0, 1e-12, "end");
        close(last.displacements["node"][0], -place, 1e-12, "the node stays");
    }
}

/// Smooth floor, wall and back of a box in space, springs k = 1: pressed against floor and wall the node slides along their
/// edge to the back at y = 1/2 and stays in the corner of the three; the back then moves on by `s` against the others, and
/// last a pull out of the wall frees the node of it at s = 1.
#[test]
fn a_smooth_corner_in_space() {
    for method in METHODS {
        let request = typed(json!({
            "model": {
                "name": "box", "dimension": 3, "nodes": {"node": [0, 0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]},
                              "wall": {"kind": "plane", "point": [0, 0, 0], "normal": [1, 0, 0]},
                              "back": {"kind": "plane", "point": [0, 0.5, 0], "normal": [0, -1, 0]}},
                "contacts": [{"node": "node", "obstacle": "floor", "friction": 0},
                             {"node": "node", "obstacle": "wall", "friction": 0},
                             {"node": "node", "obstacle": "back", "friction": 0}],
                "stages": [
                    {"name": "press", "forces": {"node": [-1, 0, -1]}, "until": {"load_above": 1}},
                    {"name": "along", "forces": {"node": [0, 1, 0]}, "until": {"load_above": 1}},
                    {"name": "back", "obstacle_motion": {"back": [0, -1, 0]}, "until": {"load_above": 1}},
                    {"name": "pull", "forces": {"node": [1, 0, 0]}, "until": {"load_above": 2}}
                ]
            }
        }));
        let (increments, report) = trace(&with(request, method));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{:?}", increments.last());
        for increment in &increments {
            let s = increment.load_factor;
            let (u, [floor, wall, back]) = match &*increment.stage {
                "press" => ([0.0, 0.0, 0.0], [s, s, 0.0]),
                "along" => ([0.0, s.min(0.5), 0.0], [1.0, 1.0, (s - 0.5).max(0.0)]),
                "back" => ([0.0, 0.5 - s, 0.0], [1.0, 1.0, 0.5 + s]),
                _ => ([(s - 1.0).max(0.0), -0.5, 0.0], [1.0, (1.0 - s).max(0.0), 1.5]),
            };
            let what = format!("{} at s = {s}", increment.stage);
            for (found, exact) in increment.displacements["node"].iter().zip(u) {
                close(*found, exact, 1e-11, &what);
            }
            for (contact, exact) in increment.contacts.iter().zip([floor, wall, back]) {
                close(contact.normal_reaction, exact, 1e-10, &what);
            }
        }
    }
}

/// What is not available ends the path by its name: three rough planes that meet in one edge (which of them bear a slide
/// along it is open).
#[test]
fn corners_that_are_not_available_are_named() {
    let normals = [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
    let (mut obstacles, mut contacts) = (serde_json::Map::new(), Vec::new());
    for (index, normal) in normals.iter().enumerate() {
        let name = format!("plane{index}");
        contacts.push(json!({"node": "node", "obstacle": name, "friction": 0.3}));
        obstacles.insert(name, json!({"kind": "plane", "point": [0, 0, 0], "normal": normal}));
    }
    let request = typed(json!({
        "model": {"dimension": 3, "nodes": {"node": [0, 0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
            "obstacles": obstacles, "contacts": contacts,
            "stages": [{"name": "press", "forces": {"node": [0, 0, -1]}, "until": {"load_above": 1}}]}
    }));
    let (_, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::CornerNotAvailable);
}
