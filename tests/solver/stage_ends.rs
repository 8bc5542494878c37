//! A stage ends exactly where it says, however the step or an event falls.

use crate::common::generators::slider_chain;
use crate::common::paths::{request, scene, trace, typed};
use arcslip::continuation::method_dispatch::TracedPath;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Component, DisplacementBound, Method, Until};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

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

/// Klarbring's scene with a stage between the two whose bound is met by where the first one ends.
fn with_a_stage_that_has_no_way_to_go() -> JobRequest {
    let mut request = scene("klarbring");
    let again = request.model.stages[0].clone();
    request.model.stages.insert(1, again);
    request.model.stages[1].name = "no further".into();
    request.model.stages[1].until = Some(Until {
        displacement: Some(DisplacementBound {
            node: "node".into(),
            component: Component::Y,
            above: None,
            below: Some(1.0),
        }),
        ..Until::default()
    });
    request
}

/// It has one row, that says so, and changes nothing else.
#[test]
fn a_stage_whose_bound_is_met_before_it_begins_is_told_and_over() {
    let (increments, report) = trace(&with_a_stage_that_has_no_way_to_go());
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let place = increments.iter().position(|increment| &*increment.stage == "no further").expect("a row");
    let (before, row, after) = (&increments[place - 1], &increments[place], &increments[place + 1]);
    assert_eq!((row.point.kind, row.load_factor, row.step), (PointKind::Start, 0.0, 0.0));
    let event = "stage \"no further\" begins and ends at once: its bound is met already";
    assert_eq!(row.point.event.as_deref(), Some(event));
    assert_eq!(
        (&row.displacements, row.energy, row.arc_length),
        (&before.displacements, before.energy, before.arc_length)
    );
    assert!(row.directions.is_none());
    assert_eq!((&*after.stage, after.point.kind), ("pull", PointKind::Start));
    let (without, _) = trace(&scene("klarbring"));
    assert_eq!(increments.len(), without.len() + 1);
    for (with, without) in increments[place + 1..].iter().zip(&without[place..]) {
        assert_eq!((with.load_factor, &with.displacements), (without.load_factor, &without.displacements));
    }
}

/// It is told by the rival method, too, and where it is the last stage.
#[test]
fn a_stage_whose_bound_is_met_is_told_by_every_method_and_at_the_end() {
    for method in [Method::Auto, Method::Mpec, Method::Regularised] {
        let mut request = with_a_stage_that_has_no_way_to_go();
        request.model.stages.truncate(2);
        request.analysis.method = method;
        let scene = Scene::new(&request).expect("a scene");
        let mut path = TracedPath::new(&scene, CancelFlag::default());
        let last = path.by_ref().last().expect("increments");
        assert_eq!((&*last.stage, last.point.kind), ("no further", PointKind::Start), "{method:?}");
        assert!(last.point.event.is_some_and(|event| event.ends_with("its bound is met already")), "{method:?}");
        let report = path.report().expect("a report");
        assert_eq!((report.stop_reason, report.increments), (StopReason::StagesCompleted, last.index), "{method:?}");
    }
}

/// A node is pushed over a rough floor, then pulled back: it slips at once, and sticks where the pull begins.
#[test]
fn the_start_of_a_stage_names_the_contacts_that_change() {
    let request = typed(json!({"model": {
        "dimension": 2, "nodes": {"node": [0, 0]}, "supports": {},
        "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [{"node": "node", "obstacle": "floor", "friction": 0.3}],
        "stages": [
            {"name": "push", "forces": {"node": [1, -1]}, "until": {"load_above": 1}},
            {"name": "pull", "forces": {"node": [-1, 0]}, "until": {"load_above": 2}},
        ],
    }}));
    let (increments, _) = trace(&request);
    let starts = increments.iter().filter(|one| one.point.kind == PointKind::Start);
    let events: Vec<&str> = starts.filter_map(|one| one.point.event.as_deref()).collect();
    assert_eq!(
        events,
        ["stage \"push\" begins; node on floor: slip", "stage \"pull\" begins; node on floor: slip to stick"]
    );
}

/// Every stage begins with a row of its own, at the place where the one before it ended, at load factor 0.
#[test]
fn every_stage_begins_with_a_row_of_its_own() {
    for method in [Method::Auto, Method::Regularised] {
        for name in ["klarbring", "turning-drag", "capstan", "one-bar-truss"] {
            let mut request = scene(name);
            request.analysis.method = method;
            let scene = Scene::new(&request).expect("a scene");
            let increments: Vec<Increment> = TracedPath::new(&scene, CancelFlag::default()).collect();
            for (place, increment) in increments.iter().enumerate() {
                let first = place == 0 || increments[place - 1].stage != increment.stage;
                assert_eq!(increment.point.kind == PointKind::Start, first, "{name}, {method:?}, increment {place}");
                if first {
                    let event = format!("stage \"{}\" begins", increment.stage);
                    let found = increment.point.event.as_deref().expect("an event");
                    assert_eq!(found.split("; ").next(), Some(&*event));
                    assert_eq!((increment.load_factor, increment.step), (0.0, 0.0));
                    let before = &increments[place.saturating_sub(1)];
                    assert_eq!((&increment.displacements, increment.energy), (&before.displacements, before.energy));
                }
            }
        }
    }
}

/// A block that slips where a stage ends may slip on in the next, or stick: both ways on are listed where that begins, and
/// the one not taken can be followed.
#[test]
fn directions_at_the_start_of_a_later_stage_are_listed_and_can_be_followed() {
    let request = scene("turning-drag");
    let (increments, _) = trace(&request);
    let start = increments.iter().find(|i| &*i.stage == "across" && i.point.kind == PointKind::Start).expect("a start");
    let directions = start.directions.as_ref().expect("directions");
    let other = directions.iter().position(|direction| !direction.taken).expect("an alternative");
    assert_eq!(directions.iter().filter(|direction| direction.taken).count(), 1);
    let scene = Scene::new(&request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    assert_eq!(path.nth(start.index as usize).map(|increment| increment.index), Some(start.index));
    let followed = Path::follow(&scene, path.checkpoint(), other, "follows".to_owned(), CancelFlag::default());
    let followed: Vec<Increment> = followed.unwrap_or_else(|error| panic!("{error}")).collect();
    assert!(followed.len() > 1);
    assert_eq!((&followed[0].stage, &followed[0].displacements), (&start.stage, &start.displacements));
    let status = |increment: &Increment| increment.contacts[0].status;
    assert_eq!(status(&followed[1]), directions[other].contacts[0]);
    assert_eq!(followed[1].load_factor.signum(), directions[other].load_rate.signum());
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

/// Nodes on unit springs with a bar of EA = 1 between them, `s` along the bar: compression `s/3`, sideways stiffness
/// `1 - 2 (s/3)/(1 - s/3)`, which is zero at s = 1. Newton's method is singular where the stage ends.
fn pressed_bar(until: Value) -> Value {
    let spring = |node: &str| json!({"kind": "spring", "nodes": [node], "stiffness": [[1, 0], [0, 1]]});
    json!({"model": {
        "name": "pressed bar", "dimension": 2, "nodes": {"n0": [0, 0], "n1": [1, 0]},
        "elements": [{"kind": "bar", "nodes": ["n0", "n1"], "axial_stiffness": 1}, spring("n0"), spring("n1")],
        "stages": [{"name": "press", "forces": {"n0": [1, 0]}, "until": until}]
    }})
}

/// In space, straight up under a load; held sideways in the middle alike in all directions, two eigenvalues cross at
/// `s = k/(2 + k/10)` (`smooth_bifurcations`).
fn column(bound: f64) -> Value {
    json!({"model": {
        "name": "column", "dimension": 3, "nodes": {"base": [0, 0, 0], "mid": [0, 0, 1], "top": [0, 0, 2]},
        "supports": {"base": ["x", "y", "z"], "top": ["x", "y"]},
        "elements": [
            {"kind": "bar", "nodes": ["base", "mid"], "axial_stiffness": 10},
            {"kind": "bar", "nodes": ["mid", "top"], "axial_stiffness": 10},
            {"kind": "spring", "nodes": ["mid"], "stiffness": [[0.2, 0, 0], [0, 0.2, 0], [0, 0, 0]]}],
        "stages": [{"name": "press", "forces": {"top": [0, 0, -1]}, "until": {"load_above": bound}}]
    }})
}

/// A bound at a smooth bifurcation or beside it: the stage ends there exactly, and the bifurcation is a point of the path
/// unless the bound comes first.
#[test]
fn a_bound_at_a_smooth_bifurcation_ends_the_stage() {
    for distance in [0.0, 1e-15, 1e-13, 1e-12, 3e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6, 1e-4] {
        for past in [distance, -distance] {
            let bound = 1.0 + past;
            // The load is 3/2 of the first node's displacement.
            let by_displacement = json!({"displacement": {"node": "n0", "component": "x", "above": 2.0 / 3.0 * bound}});
            for (until, method) in [
                (json!({"load_above": bound}), "auto"),
                (json!({"load_above": bound}), "mpec"),
                (by_displacement, "auto"),
            ] {
                let what = format!("{past:e}, {until}, {method}");
                let by_load = until.get("load_above").is_some();
                let mut model = pressed_bar(until);
                model["analysis"] = json!({"method": method});
                let (increments, report) = trace(&request(&model.to_string()));
                assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}");
                let last = increments.last().expect("an end");
                assert!((last.load_factor - bound).abs() <= if by_load { 0.0 } else { 1e-14 }, "{what}");
                let found: Vec<_> =
                    increments.iter().filter(|i| i.point.kind == PointKind::SmoothBifurcation).collect();
                // What is within 1e-12 is one point.
                if past > -1e-13 {
                    assert_eq!(found.len(), 1, "{what}");
                    assert!((found[0].load_factor - 1.0).abs() <= 3e-12, "{what}: {}", found[0].load_factor);
                    assert_eq!(found[0].directions.as_ref().map(Vec::len), Some(4), "{what}");
                } else if past < -3e-12 {
                    assert!(found.is_empty(), "{what}");
                }
            }
        }
    }
}

#[test]
fn a_bound_at_a_double_bifurcation_ends_the_stage() {
    for past in [0.0, 1e-11, -1e-11, 1e-9, -1e-9] {
        let bound = 0.2 / 2.02 + past;
        let (increments, report) = trace(&request(&column(bound).to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{past:e}");
        assert_eq!(increments.last().map(|i| i.load_factor), Some(bound), "{past:e}");
        let found = increments.iter().filter(|i| i.point.kind == PointKind::SmoothBifurcation).count();
        assert_eq!(found, usize::from(past >= 0.0), "{past:e}");
    }
}
