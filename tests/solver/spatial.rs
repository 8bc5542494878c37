//! Friction in space: slip that turns, at second order in the step, and slip that runs straight, exact.

use crate::common::paths::{Traced, close, judged, place, scene, scene_file, trace, typed};
use arcslip::check::scenes::exact::tractrix::Tractrix;
use arcslip::check::scenes::exact::turning_drag::turning_drag;
use arcslip::model::request::Method;
use arcslip::result::increment::{PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

const LADDER: [f64; 4] = [0.02, 0.01, 0.005, 0.0025];
/// Errors below this are round-off and the tolerance of Newton's method: an order cannot be read from them.
const ROUND_OFF: f64 = 1e-12;

fn assert_states(traced: &Traced, what: &str) {
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() <= 1e-10, "{what}, increment {}: {errors:?}", increment.index);
        assert!(errors.energy <= 1e-6, "{what}, increment {}: {errors:?}", increment.index);
    }
}

/// An error estimate is right within a factor, where the error is more than round-off.
fn assert_estimate(estimate: f64, error: f64, factor: f64, what: &str) {
    if error > 100.0 * ROUND_OFF {
        let right = estimate >= error / factor && estimate <= error * factor;
        assert!(right, "{what}: estimated {estimate:e}, true {error:e}, factor {factor}");
    }
}

fn assert_orders(errors: &[f64], what: &str) {
    for pair in errors.windows(2).filter(|pair| pair[1] > ROUND_OFF) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order >= 1.8, "{what}: order {order}, errors {errors:?}");
    }
}

/// The curving slip with every step of this arc length.
fn curving_slip(step: f64, method: Method) -> Traced {
    let mut request = scene_file("curving-slip");
    request.analysis.method = method;
    request.analysis.arc_length.initial = step;
    request.analysis.arc_length.max = step;
    request.analysis.max_increments = 10_000;
    judged(&request)
}

#[test]
fn curving_slip_against_the_tractrix() {
    let exact = Tractrix::BUILT_IN;
    let request = scene_file("curving-slip");
    let (mut errors, mut angles) = (Vec::new(), Vec::new());
    for step in LADDER {
        let traced = curving_slip(step, Method::Auto);
        assert_states(&traced, "curving slip");
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
        let mut largest = 0.0_f64;
        for increment in &traced.increments[1..] {
            let at = place(&request, increment, "tip");
            let what = format!("step {step}, increment {}", increment.index);
            assert_eq!(increment.contacts[0].status, Status::Slip, "{what}");
            close(increment.load_factor, exact.load(at[0], at[1]), 1e-11, &what);
            close(increment.contacts[0].normal_reaction, exact.normal_reaction(at[0], at[1]), 1e-11, &what);
            let error = (at[0] - exact.track(exact.offset - at[1])).abs();
            largest = largest.max(error);
            if increment.index > 5 {
                let distance = exact.distance(at[0], at[1]) / traced.plan.displacement_scale;
                assert_estimate(increment.diagnostics.error_estimate, distance, 5.0, &what);
            }
        }
        let end = place(&request, traced.increments.last().expect("an end"), "tip");
        close(end[0], -0.4, 1e-12, "end of the track");
        if step == 0.02 {
            assert!(largest < 1e-6, "track error {largest:e} at arc length 0.02");
        }
        errors.push(largest);
        angles.push(traced.errors.iter().fold(0.0_f64, |largest, errors| largest.max(errors.slip_direction)));
    }
    println!("track errors {errors:?}, angles of the slip {angles:?}");
    assert_orders(&errors, "track");
    assert_orders(&angles, "direction of the slip");
}

#[test]
fn the_program_traces_the_same_curving_slip() {
    let (auto, mpec) = (curving_slip(0.02, Method::Auto), curving_slip(0.02, Method::Mpec));
    assert_eq!(auto.increments.len(), mpec.increments.len());
    for (a, b) in auto.increments.iter().zip(&mpec.increments) {
        close(a.load_factor, b.load_factor, 1e-8, "load");
        for (a, b) in a.displacements["tip"].iter().zip(&b.displacements["tip"]) {
            close(*a, *b, 1e-8, "tip");
        }
    }
}

/// Here the load is given and not free: the error at a load holds the error along the track too.
#[test]
fn a_floor_that_turns_drags_its_block_around() {
    let (radius, turn) = (0.5, 0.8_f64.atan2(0.6));
    let mut largest = Vec::new();
    for step in LADDER {
        let mut request = scene_file("turning-drag");
        request.analysis.arc_length.initial = step;
        request.analysis.arc_length.max = step;
        request.analysis.max_increments = 10_000;
        let traced = judged(&request);
        assert_states(&traced, "turning drag");
        assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
        let start = traced.increments.iter().rfind(|i| &*i.stage == "along").expect("a first drag");
        close(start.displacements["block"][0], radius, 1e-12, "dragged until the cone is reached");
        let mut most = 0.0_f64;
        let turning = traced.increments.iter().filter(|increment| &*increment.stage == "across");
        for (count, increment) in turning.enumerate() {
            let exact = turning_drag(radius, turn, increment.load_factor);
            let u = &increment.displacements["block"];
            let error = (u[0] - exact[0]).hypot(u[1] - exact[1]);
            close(u[0].hypot(u[1]), radius, 1e-12, "on the cone");
            if count > 5 {
                let what = format!("step {step}, increment {}", increment.index);
                // The drag pulls errors together again (to a quarter of their sum here), which a sum of the
                // steps' errors does not see.
                assert_estimate(increment.diagnostics.error_estimate, error, 10.0, &what);
            }
            most = most.max(error);
        }
        largest.push(most);
    }
    println!("errors {largest:?}");
    assert_orders(&largest, "place at a load");
}

/// The one-bar truss in a vertical plane at an angle to the axes: slip runs straight, so the scene of two dimensions
/// holds, events and all.
#[test]
fn a_truss_in_a_turned_vertical_plane_is_that_of_two_dimensions() {
    let (flat, flat_report) = trace(&scene("one-bar-truss"));
    for angle in [0.0_f64, 0.3, 2.0, -1.2] {
        let (sine, cosine) = angle.sin_cos();
        let turned = json!({
            "model": {
                "name": "one-bar truss in space", "dimension": 3,
                "nodes": {"pin": [0, 0, 1], "tip": [-1.5 * cosine, -1.5 * sine, 0]},
                "supports": {"pin": ["x", "y", "z"]},
                "elements": [{"kind": "bar", "nodes": ["pin", "tip"], "axial_stiffness": 1}],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
                "contacts": [{"node": "tip", "obstacle": "floor", "friction": 0.3}],
                "stages": [{"name": "push", "forces": {"tip": [cosine, sine, 0]}}]
            }
        });
        let (increments, report) = trace(&typed(turned));
        assert_eq!(report.stop_reason, flat_report.stop_reason, "turned by {angle}");
        let loads = |increments: &[arcslip::result::increment::Increment]| -> Vec<(PointKind, f64)> {
            let limits = increments.iter().filter(|i| i.point.kind == PointKind::SmoothLimit);
            limits.map(|i| (i.point.kind, i.load_factor)).collect()
        };
        let (flat, increments) = (loads(&flat), loads(&increments));
        assert_eq!(flat.len(), increments.len(), "turned by {angle}");
        for (a, b) in flat.iter().zip(&increments) {
            close(a.1, b.1, 1e-10, "limit load");
        }
    }
}

/// A block pressed by 1 on a floor of friction 0.3 that drags it against springs of stiffness 2: stuck until it has
/// moved 0.15 along the drag, and then left there.
#[test]
fn a_block_dragged_straight_in_space() {
    for (x, y) in [(1.0, 0.0), (0.6, 0.8), (-0.28, 0.96)] {
        let request = typed(json!({
            "model": {
                "name": "block dragged in space", "dimension": 3, "nodes": {"block": [0, 0, 0]},
                "elements": [{"kind": "spring", "nodes": ["block"], "stiffness": [[2, 0, 0], [0, 2, 0], [0, 0, 2]]}],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
                "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.3}],
                "stages": [
                    {"name": "press", "forces": {"block": [0, 0, -1]}, "until": {"load_above": 1}},
                    {"name": "drag", "obstacle_motion": {"floor": [x, y, 0]}, "until": {"load_above": 0.5}}
                ]
            }
        }));
        let (increments, report) = trace(&request);
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        for increment in increments.iter().filter(|increment| &*increment.stage == "drag") {
            let along = increment.load_factor.min(0.15);
            close(increment.displacements["block"][0], along * x, 1e-12, "x");
            close(increment.displacements["block"][1], along * y, 1e-12, "y");
        }
        let energy = increments.last().expect("an end").energy;
        close(energy.dissipated, 0.3 * 0.35, 1e-10, "dissipated");
        close(energy.external_work, 0.3 * 0.35 + 0.15 * 0.15, 1e-10, "work of the floor");
    }
}

/// First touch with the direction of slip unknown until then: a node on springs comes down on a floor and
/// slides on it at once, straight along the push.
#[test]
fn a_first_touch_that_slides() {
    let request = typed(json!({
        "model": {
            "name": "node that lands sliding", "dimension": 3, "nodes": {"node": [0, 0, 0]},
            "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0, -0.2], "normal": [0, 0, 1]}},
            "contacts": [{"node": "node", "obstacle": "floor", "friction": 0.3}],
            "stages": [{"name": "push", "forces": {"node": [0.6, 0.8, -1]}, "until": {"load_above": 1}}]
        }
    }));
    let (increments, _) = trace(&request);
    let touch = increments.iter().skip(1).find(|increment| increment.point.event.is_some()).expect("a touch");
    close(touch.load_factor, 0.2, 1e-12, "load of the touch");
    // Sliding: along the push, s - u = 0.3 (s - 0.2).
    for increment in &increments {
        let s = increment.load_factor;
        let along = s - 0.3 * (s - 0.2).max(0.0);
        close(increment.displacements["node"][0], 0.6 * along, 1e-12, "x");
        close(increment.displacements["node"][1], 0.8 * along, 1e-12, "y");
    }
    assert_eq!(increments.last().expect("an end").contacts[0].status, Status::Slip);
}

/// A node that touches, pushed almost along the floor: with the stiffness `K` its free motion would be `K⁻¹ f`, a
/// thirtieth of it downwards, so that it is hardly pressed and slips. The load rises in proportion to the slip; where the
/// slip is overlooked it can only fall.
#[test]
fn a_slip_that_begins_hardly_pressed() {
    let stiffness = [[1.0, 0.2, 0.4], [0.2, 0.8, 0.1], [0.4, 0.1, 0.9]];
    let free = [-0.3, 0.5, -0.02];
    let force: Vec<f64> = stiffness.iter().map(|row| row.iter().zip(&free).map(|(k, u)| k * u).sum()).collect();
    let request = typed(json!({"model": {
        "name": "hardly pressed", "dimension": 3, "nodes": {"node": [0, 0, 0]},
        "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": stiffness}],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
        "contacts": [{"node": "node", "obstacle": "floor", "friction": 0.7}],
        "stages": [{"name": "push", "forces": {"node": force}, "until": {"load_above": 1}}]
    }}));
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert!(increments.iter().all(|increment| !increment.point.degenerate));
    let end = increments.last().expect("an end");
    assert_eq!(end.load_factor, 1.0);
    for increment in &increments[1..] {
        let contact = &increment.contacts[0];
        assert_eq!(contact.status, Status::Slip);
        assert!(contact.normal_reaction > 0.0);
        let share = increment.load_factor;
        for (u, all) in increment.displacements["node"].iter().zip(&end.displacements["node"]) {
            close(*u, share * all, 1e-13, "in proportion to the load");
        }
    }
}

/// A bar on a rough floor whose foot a very stiff tie holds: it slips at once, slowly, as it does in the plane.
#[test]
fn a_foot_on_a_stiff_tie_slips_in_space_as_in_the_plane() {
    for stiffness in [1e6, 1e9, 1e12] {
        let tied = |dimension: usize| {
            // In the plane the vertical is y.
            let at = |x: f64, z: f64| if dimension == 2 { vec![x, z] } else { vec![x, 0.0, z] };
            let fixed = if dimension == 2 { vec!["x", "y"] } else { vec!["x", "y", "z"] };
            let mut elements = vec![
                json!({"kind": "bar", "nodes": ["pin", "foot"], "axial_stiffness": 1.0}),
                json!({"kind": "bar", "nodes": ["wall", "foot"], "axial_stiffness": stiffness}),
            ];
            if dimension == 3 {
                let aside = [[0.0; 3], [0.0, 0.05, 0.0], [0.0; 3]];
                elements.push(json!({"kind": "spring", "nodes": ["foot"], "stiffness": aside}));
            }
            typed(json!({
                "model": {
                    "name": format!("tie of {stiffness:e} in {dimension}D"),
                    "dimension": dimension,
                    "nodes": {"pin": at(0.0, 1.0), "foot": at(-1.5, 0.0), "wall": at(-2.5, 0.0)},
                    "supports": {"pin": fixed, "wall": fixed},
                    "elements": elements,
                    "obstacles": {"floor": {"kind": "plane", "point": at(0.0, 0.0), "normal": at(0.0, 1.0)}},
                    "contacts": [{"node": "foot", "obstacle": "floor", "friction": 0.3}],
                    "stages": [{"name": "push", "forces": {"foot": at(1.0, 0.0)}, "until": {"load_above": 5.0}}]
                },
                "analysis": {"max_increments": 60}
            }))
        };
        let ends = [2, 3].map(|dimension| {
            let (increments, report) = trace(&tied(dimension));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{stiffness:e} in {dimension}D");
            let last = increments.last().expect("an end");
            (last.displacements["foot"][0], last.contacts[0].normal_reaction)
        });
        let [(plane, pressed), (space, also)] = ends;
        assert!(plane > 0.0 && (plane - space).abs() <= 1e-6 * plane, "{stiffness:e}: {plane:e} and {space:e}");
        assert!((pressed - also).abs() <= 1e-6 * pressed, "{stiffness:e}: {pressed:e} and {also:e}");
    }
}

/// A node on springs (k = 1) slips along `x` and is lifted off, while the load along `x` falls more slowly than the
/// friction. The direction of slip moves away from `x` as a power of the normal reaction: by how much it has turned at
/// lift-off hangs on angles of any size, and the turn there has no bound. The node is at `f/k` in any case.
#[test]
fn a_slip_that_lifts_off_while_its_direction_moves_away() {
    for aside in [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 2.0] {
        let request = typed(json!({
            "model": {
                "dimension": 3, "nodes": {"node": [0, 0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
                "obstacles": {"floor": {"kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
                "contacts": [{"node": "node", "obstacle": "floor", "friction": 0.4}],
                "stages": [
                    {"name": "press", "forces": {"node": [0, 0, -1]}, "until": {"load_above": 1}},
                    {"name": "push", "forces": {"node": [1, 0, 0]}, "until": {"load_above": 1}},
                    {"name": "lift", "forces": {"node": [-0.1, 0.1 * aside, 1]}, "until": {"load_above": 2}}
                ]
            },
            "analysis": {"max_increments": 200}
        }));
        let traced = judged(&request);
        let stop = traced.report.stop_reason;
        let what = format!("aside {aside:e}, {stop:?} after {} increments", traced.increments.len());
        println!("{what}");
        assert!(matches!(stop, StopReason::StagesCompleted | StopReason::MaxIncrements), "{what}");
        assert_states(&traced, &what);
        for increment in traced.increments.iter().filter(|increment| &*increment.stage == "lift") {
            close(increment.contacts[0].normal_reaction, (1.0 - increment.load_factor).max(0.0), 1e-10, &what);
        }
        // Where it lifts off the path may also go back, with the node held: the rule decides.
        let lifted = traced.increments.iter().find(|increment| {
            &*increment.stage == "lift" && increment.point.event.is_some() && increment.load_factor > 0.5
        });
        let lifted = lifted.expect("a lift-off");
        close(lifted.load_factor, 1.0, 1e-9, &what);
        for (found, exact) in lifted.displacements["node"].iter().zip([0.9, 0.1 * aside, 0.0]) {
            close(*found, exact, 1e-9, &what);
        }
        let found = lifted.directions.as_ref().expect("directions");
        assert!(found.iter().any(|direction| *direction.contacts == [Status::Free]), "{what}");
    }
}
