//! Contact changes that are taken together where none of them leaves a choice: the same path as when each is a point.

use crate::common::generators::row_of_bars;
use crate::common::paths::{close, trace, typed};
use arcslip::check::measure::Judge;
use arcslip::check::scenes::lattice::LatticeArch;
use arcslip::continuation::path::checkpoint::Checkpoint;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::Events;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind, Status};
use serde_json::json;

/// Every so many of a row of trusses stands over a floor: the others go on when these have landed.
const OVER_A_FLOOR: usize = 4;

/// Shallow trusses of two bars side by side, some of which are pressed onto smooth floors that are hardly lower from one to
/// the next, and released again.
fn trusses(landing: usize, events: Events) -> JobRequest {
    let number = OVER_A_FLOOR * landing;
    let mut model = json!({
        "name": "trusses over smooth floors", "dimension": 2, "nodes": {}, "supports": {}, "elements": [],
        "obstacles": {}, "contacts": [],
        "stages": [
            {"name": "press", "forces": {}, "until": {"load_above": 0.6}},
            {"name": "release", "forces": {}, "until": {"load_above": 0.6}}
        ]
    });
    let mut elements = Vec::new();
    let mut contacts = Vec::new();
    for index in 0..number {
        let [left, right, tip] = ["left", "right", "tip"].map(|name| format!("{name}{index}"));
        let (floor, x) = (format!("floor{index}"), 4.0 * index as f64);
        for (name, place) in [(&left, [x - 1.0, 0.0]), (&right, [x + 1.0, 0.0]), (&tip, [x, 0.5])] {
            model["nodes"][name] = json!(place);
        }
        for pin in [&left, &right] {
            model["supports"][pin] = json!(["x", "y"]);
            elements.push(json!({"kind": "bar", "nodes": [pin, tip], "axial_stiffness": 1}));
        }
        if index > 0 {
            let before = format!("tip{}", index - 1);
            elements.push(json!({"kind": "spring", "nodes": [before, tip], "stiffness": [[0.01, 0], [0, 0.01]]}));
        }
        if index % OVER_A_FLOOR == 0 {
            let height = 0.45 - 0.002 * (index / OVER_A_FLOOR * 3 % landing) as f64;
            model["obstacles"][&floor] = json!({"kind": "plane", "point": [x, height], "normal": [0, 1]});
            contacts.push(json!({"node": tip, "obstacle": floor, "friction": 0}));
        }
        model["stages"][0]["forces"][&tip] = json!([0, -0.05]);
        model["stages"][1]["forces"][&tip] = json!([0, 0.05]);
    }
    (model["elements"], model["contacts"]) = (json!(elements), json!(contacts));
    let mut request = typed(json!({"model": model, "analysis": {"arc_length": {"initial": 0.02, "max": 0.1}}}));
    request.analysis.events = events;
    request
}

/// An arch whose crown and neighbours land on a smooth floor, traced in long steps.
fn arch(events: Events) -> JobRequest {
    let arch = LatticeArch { contacts: 12, friction: 0.0, increments: 400, ..LatticeArch::of_unknowns(200) };
    let mut request = arch.request().expect("a request");
    request.model.stages[0].until = serde_json::from_value(json!({"load_above": 400})).expect("an end");
    request.analysis.record = None;
    request.analysis.arc_length.max *= 8.0;
    request.analysis.events = events;
    request
}

/// Changes that the events name.
fn named(increments: &[Increment]) -> usize {
    let events = increments.iter().filter_map(|row| row.point.event.as_deref());
    events.map(|event| event.matches(" on floor").count()).sum()
}

fn closed(increment: &Increment) -> usize {
    increment.contacts.iter().filter(|contact| contact.status == Status::Slip).count()
}

/// Each point is in equilibrium and keeps the laws of contact, by the measure's own account.
fn assert_lawful(request: &JobRequest, increments: &[Increment]) {
    let scene = Scene::new(request).expect("a scene");
    let mut judge = Judge::new(request, scene.plan().displacement_scale, &scene.plan().load_scales);
    for increment in increments {
        let errors = judge.judge(increment);
        assert!(errors.largest_of_state() <= 1e-10, "{} {errors:?}", increment.index);
        assert!(errors.energy.max(errors.strain_energy) <= 1e-6, "{} {errors:?}", increment.index);
    }
}

fn assert_same_end(one: &[Increment], other: &[Increment]) {
    let [one, other] = [one, other].map(|path| path.last().expect("an end"));
    close(other.load_factor, one.load_factor, 1e-9 * one.load_factor.abs(), "load");
    for (a, b) in one.displacements.values().flatten().zip(other.displacements.values().flatten()) {
        close(*b, *a, 1e-9, "displacement");
    }
    for (a, b) in one.contacts.iter().zip(&other.contacts) {
        assert_eq!(a.status, b.status);
        close(b.normal_reaction, a.normal_reaction, 1e-9, "reaction");
    }
}

#[test]
fn changes_taken_together_lead_to_the_same_state() {
    let (all, _) = trace(&trusses(8, Events::All));
    let (together, report) = trace(&trusses(8, Events::Auto));
    println!("{} and {} increments, {} factorisations", all.len(), together.len(), report.factorisations);
    assert_eq!((named(&all), named(&together)), (16, 16), "each truss lands and leaves");
    assert!(together.len() + 4 <= all.len(), "{} {}", together.len(), all.len());
    assert_same_end(&all, &together);
    assert_lawful(&trusses(8, Events::Auto), &together);
    let pressed = |rows: &[Increment]| rows.iter().rposition(|row| row.stage.as_ref() == "press").expect("pressed");
    let [one, other] = [&all, &together].map(|rows| &rows[..=pressed(rows)]);
    assert_eq!(closed(&one[one.len() - 1]), 8);
    assert_same_end(one, other);
    let several = |row: &&Increment| row.point.event.as_deref().is_some_and(|event| event.contains("; tip"));
    let joined: Vec<&Increment> = together.iter().filter(several).collect();
    assert!(!joined.is_empty());
    for row in joined {
        assert_eq!(row.point.kind, PointKind::ContactChange);
        // What is named has another status than in the row before.
        let before = &together[row.index as usize - 1];
        for (was, is) in before.contacts.iter().zip(&row.contacts) {
            let event = row.point.event.as_deref().unwrap_or_default();
            let told = event.contains(&format!("{} on floor", is.node));
            assert!(!told || was.status != is.status, "{event}");
        }
    }
}

#[test]
fn an_arch_that_lands_ends_where_it_does() {
    let (all, _) = trace(&arch(Events::All));
    let (together, _) = trace(&arch(Events::Auto));
    println!("{} and {} increments, {} closed", all.len(), together.len(), closed(&all[all.len() - 1]));
    assert!(closed(&all[all.len() - 1]) >= 3);
    assert!(together.len() <= all.len());
    assert_same_end(&all, &together);
}

#[test]
fn changes_that_are_counted_are_points_each() {
    let counted = |events| {
        let mut request = trusses(8, events);
        request.model.stages[0].until = serde_json::from_value(json!({"contact_change": 4})).expect("an end");
        request.model.stages.truncate(1);
        trace(&request).0
    };
    let (all, auto) = (counted(Events::All), counted(Events::Auto));
    assert_eq!((all.len(), named(&all)), (auto.len(), 4));
    assert_eq!(all.last().expect("an end").displacements, auto.last().expect("an end").displacements);
}

/// An arch of some 1,000 unknowns that rolls onto a floor: it leaves it where it first touched.
fn rolling(friction: f64) -> JobRequest {
    let plain = LatticeArch { friction, increments: 50, spread: 0.3, ..LatticeArch::of_unknowns(1_000) };
    LatticeArch { contacts: 22, ..plain }.request().expect("a request")
}

/// The increments of a path that is put down and taken up again at each, beside those of one that is not; and how many
/// steps were left to wait at each.
fn assert_same_bits(request: &JobRequest) -> Vec<u64> {
    let scene = Scene::new(request).expect("a scene");
    let line = |mut increment: Increment| {
        increment.diagnostics.elapsed_s = 0.0;
        serde_json::to_string(&increment).expect("written")
    };
    let whole: Vec<String> = Path::new(&scene, CancelFlag::default()).map(line).collect();
    let mut path = Path::new(&scene, CancelFlag::default());
    let (mut rows, mut left) = (Vec::new(), Vec::new());
    while let Some(row) = path.next() {
        rows.push(line(row));
        let text = serde_json::to_string(&path.checkpoint()).expect("written");
        let value: serde_json::Value = serde_json::from_str(&text).expect("read");
        left.push(value["at"]["waiting"]["steps"].as_u64().expect("steps"));
        let checkpoint: Checkpoint = serde_json::from_str(&text).expect("read");
        path = Path::resume(&scene, checkpoint, CancelFlag::default()).expect("resumed");
    }
    assert_eq!(rows, whole);
    left
}

#[test]
fn a_path_with_changes_taken_together_is_taken_up_again_with_the_same_bits() {
    assert_same_bits(&trusses(8, Events::Auto));
}

#[test]
fn a_path_that_waits_after_a_failure_is_taken_up_again_with_the_same_bits() {
    let left = assert_same_bits(&rolling(0.0));
    let begun: Vec<u64> = left.windows(2).filter(|two| two[1] > two[0]).map(|two| two[1]).collect();
    assert!(begun.len() >= 2 && begun.is_sorted(), "each wait is longer: {begun:?}");
    assert!(left.windows(2).all(|two| two[1] > two[0] || two[1] == two[0].saturating_sub(1)), "{left:?}");
}

/// Without friction the changes taken together fail here, with friction none may be; a step to just past the change that
/// comes next spares what was solved further on.
#[test]
fn changes_that_are_foreseen_take_few_factorisations() {
    for friction in [0.0, 0.3] {
        let request = rolling(friction);
        let (increments, _) = trace(&request);
        assert_lawful(&request, &increments);
        let of = |row: &Increment| row.point.kind == PointKind::ContactChange;
        let made = |row: &Increment| {
            row.diagnostics.factorisations - increments[row.index as usize - 1].diagnostics.factorisations
        };
        let mut changes: Vec<u64> = increments.iter().filter(|row| of(row)).map(made).collect();
        changes.sort_unstable();
        println!("friction {friction}: {changes:?}");
        assert!(changes.len() >= 8, "{}", changes.len());
        // One or two to just past it; the last serves at the change itself as a rule.
        assert!(changes[changes.len() / 2] <= 5, "{changes:?}");
        // What a change cuts short is not taken for the length of the steps to come.
        let longest = request.analysis.arc_length.max;
        assert!(increments.iter().any(|row| row.step > 0.9 * longest));
    }
}

/// Friction remembers where a node came to rest: its changes are points, whatever is asked.
#[test]
fn changes_with_friction_are_points_each() {
    let mut request = typed(row_of_bars(5));
    request.analysis.events = Events::All;
    let (all, _) = trace(&request);
    request.analysis.events = Events::Auto;
    let (auto, _) = trace(&request);
    let point = |row: &Increment| (row.load_factor, row.point.clone());
    assert!(all.iter().map(point).eq(auto.iter().map(point)));
}

/// Springs alone, whose tangent is the same everywhere: smooth floors that they land on within one step are taken together
/// here as well.
#[test]
fn springs_land_together() {
    let landed = |events: &str| {
        let count = 60;
        let mut model = json!({
            "name": "a row of springs over floors", "dimension": 2, "nodes": {}, "elements": [], "obstacles": {},
            "contacts": [], "stages": [{"name": "press", "forces": {}, "until": {"load_above": 0.8}}]
        });
        let (mut elements, mut contacts) = (Vec::new(), Vec::new());
        for index in 0..count {
            let (name, floor) = (format!("node{index}"), format!("floor{index}"));
            model["nodes"][&name] = json!([index as f64, 0]);
            elements.push(json!({"kind": "spring", "nodes": [name], "stiffness": [[1, 0], [0, 1]]}));
            if index > 0 {
                let nodes = [format!("node{}", index - 1), name.clone()];
                elements.push(json!({"kind": "spring", "nodes": nodes, "stiffness": [[0.1, 0], [0, 0.1]]}));
            }
            if index % 3 == 0 {
                let height = -0.1 - 0.01 / 60.0 * f64::from(index * 7 % count);
                model["obstacles"][&floor] = json!({"kind": "plane", "point": [0, height], "normal": [0, 1]});
                contacts.push(json!({"node": name, "obstacle": floor, "friction": 0}));
            }
            model["stages"][0]["forces"][&name] = json!([0, -1]);
        }
        (model["elements"], model["contacts"]) = (json!(elements), json!(contacts));
        let arc_length = json!({"initial": 0.1, "max": 0.3, "displacement_scale": 1.0, "load_scale": 0.1});
        trace(&typed(json!({"model": model, "analysis": {"events": events, "arc_length": arc_length}})))
    };
    let ((joined, report), (single, reference)) = (landed("auto"), landed("all"));
    assert_same_end(&joined, &single);
    assert!(joined.len() < single.len(), "{} rows, one a change {}", joined.len(), single.len());
    assert!(report.factorisations < reference.factorisations, "{report:?}, {reference:?}");
}
