//! How paths end: each reason by a scene, with the last good point.

use crate::common::generators::row_of_bars as row;
use crate::common::paths::{request, scene, trace};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

/// One bar snaps alone and the path truly ends: exhaustive enumeration finds no direction at s = 0.104818.
#[test]
fn the_row_of_four_ends_without_a_direction() {
    let (increments, report) = trace(&request(&row(4).to_string()));
    assert_eq!(report.stop_reason, StopReason::NoDirection);
    let last = increments.last().expect("an end");
    assert_eq!(last.point.kind, PointKind::End);
    assert!((last.load_factor - 0.104818).abs() < 1e-6);
    for (tip, x) in [1.912378, 1.043896, 0.916531, 0.791225].iter().enumerate() {
        assert!((last.displacements[format!("tip{tip}").as_str()][0] - x).abs() < 1e-6);
    }
}

/// Both bars of a flat frame fold onto one another: the distance of their free ends falls to nothing.
#[test]
fn a_bar_that_shrinks_to_a_point_is_named() {
    let model = json!({"model": {
        "name": "two nodes pressed together", "dimension": 2,
        "nodes": {"wall": [0, 0], "ram": [1, 0]}, "supports": {"wall": ["x", "y"], "ram": ["y"]},
        "elements": [{"kind": "bar", "nodes": ["wall", "ram"], "axial_stiffness": 1}],
        "stages": [{"name": "press", "forces": {"ram": [-1, 0]}}]
    }});
    let (_, report) = trace(&request(&model.to_string()));
    assert_eq!(report.stop_reason, StopReason::CollapsedBar, "{report:?}");
}

#[test]
fn the_number_of_increments_is_kept() {
    let mut request = scene("one-bar-truss");
    request.analysis.max_increments = 17;
    let (increments, report) = trace(&request);
    assert_eq!((increments.len(), report.stop_reason), (18, StopReason::MaxIncrements));
}

#[test]
fn stages_end_by_counts() {
    for (until, kind, count) in [
        (json!({"limit_points": 1}), PointKind::SmoothLimit, 1),
        (json!({"contact_change": 2}), PointKind::ContactChange, 2),
    ] {
        let mut model = row(3);
        model["model"]["stages"][0]["until"] = until;
        let (increments, report) = trace(&request(&model.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        assert_eq!(increments.iter().filter(|i| i.point.kind == kind).count(), count);
        assert_eq!(increments.last().map(|i| i.point.kind), Some(kind));
    }
}

#[test]
fn cancelling_stops_within_one_increment() {
    let request = scene("three-snapping-bars");
    let scene = Scene::new(&request).expect("a scene");
    let cancel = CancelFlag::default();
    let mut path = Path::new(&scene, cancel.clone());
    assert!(path.nth(5).is_some());
    cancel.cancel();
    assert!(path.next().is_none());
    assert_eq!(path.report().map(|report| report.stop_reason), Some(StopReason::Cancelled));
}

/// A square of four bars without a diagonal shears freely.
#[test]
fn an_unsupported_mechanism_is_bad_input() {
    let bar = |a: &str, b: &str| json!({"kind": "bar", "nodes": [a, b], "axial_stiffness": 1});
    let model = json!({"model": {
        "dimension": 2,
        "nodes": {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]}, "supports": {"a": ["x", "y"], "b": ["x", "y"]},
        "elements": [bar("b", "c"), bar("c", "d"), bar("d", "a")],
        "stages": [{"name": "push", "forces": {"c": [1, 0]}}]
    }});
    let errors = Scene::new(&request(&model.to_string())).expect_err("a mechanism");
    assert_eq!(errors.0.len(), 1);
    assert!(errors.0[0].pointer.starts_with("/model/nodes/"), "{errors}");
    assert!(errors.0[0].detail.contains("mechanism"), "{errors}");
}

/// Prestress that nothing balances is not a state of rest.
#[test]
fn unbalanced_prestress_is_bad_input() {
    let model = json!({"model": {
        "dimension": 2, "nodes": {"p": [0, 0], "q": [1, 0]}, "supports": {"p": ["x", "y"]},
        "elements": [
            {"kind": "bar", "nodes": ["p", "q"], "axial_stiffness": 1, "prestress": 0.1},
            {"kind": "spring", "nodes": ["q"], "stiffness": [[1, 0], [0, 1]]}
        ],
        "stages": [{"name": "push", "forces": {"q": [0, 1]}, "until": {"load_above": 1}}]
    }});
    let errors = Scene::new(&request(&model.to_string())).expect_err("out of balance");
    assert_eq!(errors.0[0].pointer, "/model/nodes/q");
    assert!(errors.0[0].detail.contains("prestress"), "{errors}");
}

/// A search that is cut before it has found anything says so, and complementary pivoting finds the way on: the same path.
#[test]
fn a_limit_on_modes_is_told_and_the_way_on_found() {
    let mut model = row(3);
    let (whole, _) = trace(&request(&model.to_string()));
    model["analysis"] = json!({"max_modes": 2});
    let (increments, _) = trace(&request(&model.to_string()));
    assert!(increments[0].point.unexplored_modes > 0);
    let status = |increment: &Increment| increment.contacts.iter().map(|contact| contact.status).collect::<Vec<_>>();
    assert_eq!(status(&increments[1]), status(&whole[1]));
    assert!((increments[1].load_factor - whole[1].load_factor).abs() < 1e-12);
}

/// A flag raised inside a long enumeration ends it.
#[test]
fn cancelling_ends_an_enumeration() {
    let mut model = row(80);
    // What a proof would spare is searched, too: for longer than any flag takes to be raised.
    model["analysis"] = json!({"max_modes": 10_000_000, "keep_all": true});
    let request = request(&model.to_string());
    let scene = Scene::new(&request).expect("a scene");
    let cancel = CancelFlag::default();
    let raised = cancel.clone();
    let timer = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(100));
        raised.cancel();
    });
    let mut path = Path::new(&scene, cancel);
    path.by_ref().for_each(drop);
    assert_eq!(path.report().map(|report| report.stop_reason), Some(StopReason::Cancelled));
    timer.join().expect("the timer ends");
}

/// A bar at an angle, pressed along itself, with nothing or a floor beneath the node that goes: near its end the rounding of the
/// displacements alone turns it. No point is kept that misses the measure's bar, and the program of the increments
/// takes no longer there than elsewhere.
#[test]
fn a_bar_about_to_collapse_keeps_to_the_bar_of_the_measure() {
    for angle in [0.3_f64, 1.1, 2.5] {
        let (sine, cosine) = angle.sin_cos();
        let across = 10.0 * sine * cosine;
        let guide = json!([[10.0 * sine * sine, -across], [-across, 10.0 * cosine * cosine]]);
        for (has_floor, is_guided) in [(false, true), (true, true), (true, false)] {
            for method in ["auto", "mpec"] {
                let mut model = json!({"model": {
                    "name": "pressed to a point", "dimension": 2,
                    "nodes": {"wall": [0.3, 0.7], "ram": [0.3 + cosine, 0.7 + sine]}, "supports": {"wall": ["x", "y"]},
                    "elements": [{"kind": "bar", "nodes": ["wall", "ram"], "axial_stiffness": 1}],
                    "stages": [{"name": "press", "forces": {"ram": [-cosine, -sine]}}]
                }, "analysis": {"method": method}});
                let parts = &mut model["model"];
                if is_guided {
                    let guide = json!({"kind": "spring", "nodes": ["ram"], "stiffness": guide});
                    parts["elements"].as_array_mut().expect("elements").push(guide);
                }
                if has_floor {
                    let normal = json!([-sine, cosine]);
                    parts["obstacles"] = json!({"floor": {"kind": "plane", "point": [0.3, 0.7], "normal": normal}});
                    parts["contacts"] = json!([{"node": "ram", "obstacle": "floor", "friction": 0.3}]);
                    parts["stages"][0]["forces"]["ram"] = json!([-cosine + 0.1 * sine, -sine - 0.1 * cosine]);
                }
                let (increments, report) = trace(&request(&model.to_string()));
                let what = format!("angle {angle}, floor {has_floor}, guide {is_guided}, {method}");
                assert_eq!(report.stop_reason, StopReason::CollapsedBar, "{what}");
                let last = increments.last().expect("an end");
                let ram = [cosine + last.displacements["ram"][0], sine + last.displacements["ram"][1]];
                assert!(ram[0].hypot(ram[1]) < 1e-4, "{what}: {ram:?}");
                assert!(report.qp_solves < 20 * report.increments, "{what}: {} programs", report.qp_solves);
            }
        }
    }
}

/// A truss under the load that pulls a block over a floor: at the truss's maximum the block, no longer pulled on, comes to
/// rest. The load turns there, whatever the step.
#[test]
fn the_load_turns_where_a_slipping_block_comes_to_rest() {
    let rest = 1.0_f64.hypot(0.3);
    // Height y of the apex, bars of length l: s = 2 y (1/l - 1/l0), stationary where l³ = l0.
    let length = rest.cbrt();
    let maximum = 2.0 * (length * length - 1.0).sqrt() * (1.0 / length - 1.0 / rest);
    for longest in [0.2, 0.05, 0.013] {
        let model = json!({"model": {
            "name": "truss and block", "dimension": 2,
            "nodes": {"left": [-1, 0], "right": [1, 0], "apex": [0, 0.3], "block": [3, 0]},
            "supports": {"left": ["x", "y"], "right": ["x", "y"], "apex": ["x"]},
            "elements": [
                {"kind": "bar", "nodes": ["left", "apex"], "axial_stiffness": 1},
                {"kind": "bar", "nodes": ["right", "apex"], "axial_stiffness": 1},
                {"kind": "spring", "nodes": ["block"], "stiffness": [[0.1, 0], [0, 0.1]]}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.1}],
            "stages": [
                {"name": "press", "forces": {"block": [0, -1]}, "until": {"load_above": 0.05}},
                {"name": "load", "forces": {"apex": [0, -1], "block": [1, 0]}, "until": {"limit_points": 1}}]
        }, "analysis": {"max_increments": 200, "arc_length": {"max": longest}}});
        let (increments, report) = trace(&request(&model.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "steps of {longest}");
        let last = increments.last().expect("an end");
        assert!((last.load_factor - maximum).abs() < 1e-12, "{} {maximum}", last.load_factor);
        assert_eq!(last.point.kind, PointKind::NonsmoothLimit);
        assert!(!last.point.bifurcation);
    }
}

/// Two nodes on a floor that they reach from different heights are pushed together: the direction of the bar between them is
/// a difference of rounded places.
#[test]
fn nodes_that_meet_end_the_path_before_their_bar_has_no_direction() {
    for method in ["auto", "mpec"] {
        let ground = |node: &str| json!({"kind": "spring", "nodes": [node], "stiffness": [[0.5, 0], [0, 0.5]]});
        let model = json!({"model": {
            "name": "two nodes meet", "dimension": 2,
            "nodes": {"a": [0, 0.4436110578680075], "b": [1, 0.7205299882651125]},
            "elements": [ground("a"), ground("b"), {"kind": "bar", "nodes": ["a", "b"], "axial_stiffness": 0.1}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0.24006814741196636], "normal": [0, 1]}},
            "contacts": [{"node": "a", "obstacle": "floor"}, {"node": "b", "obstacle": "floor"}],
            "stages": [
                {"name": "press", "forces": {"a": [0, -1], "b": [0, -1]}, "until": {"load_above": 1}},
                {"name": "meet", "forces": {"a": [1, 0], "b": [-1, 0]}, "until": {"load_above": 2}},
            ],
        }, "analysis": {"method": method}});
        let (increments, report) = trace(&request(&model.to_string()));
        assert_eq!(report.stop_reason, StopReason::CollapsedBar, "{method}");
        let last = increments.last().expect("an end");
        let length = 1.0 + last.displacements["b"][0] - last.displacements["a"][0];
        assert!(length > 0.0 && length < 1e-4, "{method}: {length}");
    }
}

/// A square panel with both diagonals, pinned at a corner: pressed on a floor and lifted off it at the load zero, where it
/// turns freely. Its bars balance one another with or without prestress, and nothing resists the turn in either case.
#[test]
fn a_part_under_self_stress_that_turns_freely_is_a_mechanism() {
    let panel = |prestress: f64| {
        let bar = |from: &str, to: &str, prestress: f64| json!({"kind": "bar", "nodes": [from, to], "axial_stiffness": 100, "prestress": prestress});
        let mut elements: Vec<_> =
            [("a", "b"), ("b", "c"), ("c", "d"), ("d", "a")].map(|(from, to)| bar(from, to, prestress)).into();
        elements.extend([("a", "c"), ("b", "d")].map(|(from, to)| bar(from, to, -2_f64.sqrt() * prestress)));
        json!({"model": {
            "dimension": 2, "nodes": {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]}, "elements": elements,
            "supports": {"a": ["x", "y"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "b", "obstacle": "floor", "friction": 0.3}],
            "stages": [
                {"name": "press", "forces": {"c": [0, -1]}, "until": {"load_above": 1}},
                {"name": "lift", "forces": {"c": [0, 1]}}
            ]
        }, "analysis": {"max_increments": 50}})
    };
    for prestress in [0.0, 1.0, -3.0] {
        let (increments, report) = trace(&request(&panel(prestress).to_string()));
        assert_eq!(report.stop_reason, StopReason::Mechanism, "prestress {prestress}");
        let motion = "it moves `b` along y, `c` along x and y, `d` along x";
        assert!(report.sentence.ends_with(motion), "prestress {prestress}: {}", report.sentence);
        let last = increments.last().expect("an end");
        assert_eq!(last.point.event.as_deref(), Some("b on floor: reaction zero"), "prestress {prestress}");
        assert!((last.load_factor - 1.0).abs() < 1e-9 && last.displacements["c"].iter().all(|u| u.abs() < 1e-9));
    }
}
