//! Limit points followed in a parameter, beside closed forms and beside paths of their own.

use crate::common::paths::{close, scene_file, typed};
use crate::common::random::random_scene;
use crate::common::round_arch::round_arch;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::request::{Events, StageControl};
use arcslip::model::{InputErrors, JobRequest, ParameterCurve};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind};
use arcslip::studies::critical_curves::{self, CurveFound, CurveRow, CurveSummary};
use serde_json::{Value, json};
use std::ops::ControlFlow;

pub fn curve_of(request: &JobRequest, settings: &Value) -> Result<ParameterCurve, InputErrors> {
    let mut document = serde_json::to_value(request).expect("JSON");
    document["curve"] = settings.clone();
    ParameterCurve::read(document.to_string().as_bytes())
}

pub fn followed(curve: &ParameterCurve) -> Result<CurveFound, InputErrors> {
    let mut rows = Vec::new();
    let accept = &mut |row| {
        rows.push(row);
        ControlFlow::Continue(())
    };
    let summary = critical_curves::run(curve, &CancelFlag::default(), accept)?;
    let found = CurveFound::begun(None, curve.settings.clone(), curve.dimension).with(rows, Some(summary));
    for row in &found.rows {
        assert!(row.measure.largest_of_state() <= 1e-9, "{}: {:?}", row.value, row.measure);
    }
    assert!(found.rows.windows(2).all(|pair| pair[0].place < pair[1].place));
    Ok(found)
}

/// The summary of a curve that was followed to both ends of its range, or to where it is lost.
pub fn ended(found: &CurveFound) -> &CurveSummary {
    let summary = found.summary.as_ref().expect("a summary");
    assert!(summary.complete, "{summary:?}");
    summary
}

fn is_limit(kind: PointKind) -> bool {
    matches!(kind, PointKind::SmoothLimit | PointKind::NonsmoothLimit)
}

/// The distance between a point of a curve and the nearest limit point of a path of its own, in load and displacements.
fn off_path(curve: &ParameterCurve, row: &CurveRow) -> Option<f64> {
    off_points_of_path(curve, row, &is_limit)
}

/// As [`off_path`], of points of other kinds.
pub fn off_points_of_path(curve: &ParameterCurve, row: &CurveRow, is_meant: &dyn Fn(PointKind) -> bool) -> Option<f64> {
    let mut request = curve.request(row.value).expect("a model");
    request.analysis.events = Events::All;
    // The limit point may come later on it than on the first path.
    request.analysis.max_increments = 1_000;
    let scene = Scene::new(&request).expect("a scene");
    let load = scene.plan().load_scales[0];
    let distance = |one: &Increment| {
        let pairs = one.displacements.values().flatten().zip(row.displacements.values().flatten());
        let moved = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scene.plan().displacement_scale;
        moved.max((one.load_factor - row.load_factor).abs() / load)
    };
    let points = Path::new(&scene, CancelFlag::default()).filter(|one| is_meant(one.point.kind));
    points.filter(|one| one.stage == row.stage).map(|one| distance(&one)).min_by(f64::total_cmp)
}

/// The largest distance of ordinary points from paths of their own.
fn worst(curve: &ParameterCurve, found: &CurveFound) -> f64 {
    let ordinary = found.rows.iter().filter(|row| !row.codimension_two);
    ordinary.map(|row| off_path(curve, row).unwrap_or(f64::INFINITY)).fold(0.0, f64::max)
}

#[test]
fn the_limit_load_of_the_arch_type_truss_grows_with_friction() {
    let settings = json!({"parameter": "/model/contacts/*/friction", "range": [0, 2], "step": 0.1});
    let curve = curve_of(&scene_file("arch-type-truss"), &settings).expect("a curve");
    let found = followed(&curve).expect("a curve");
    let summary = ended(&found);
    // The first path, and one that is compared with the curve at each end.
    assert_eq!(summary.paths, 3);
    assert_eq!(found.rows.len(), 21);
    assert!(found.rows.iter().all(|row| row.kind == PointKind::SmoothLimit));
    assert!(found.rows.windows(2).all(|pair| pair[0].load_factor < pair[1].load_factor));
    let known = found.rows.iter().find(|row| row.value == 0.4).expect("the model's own value");
    close(known.load_factor, 0.009_567_590_7, 1e-10, "as published");
    let off = worst(&curve, &found);
    println!("{off:e} from paths of their own; {} Newton iterations", summary.newton_iterations);
    assert!(off <= 1e-8, "{off:e}");
}

#[test]
fn the_limit_point_of_the_arch_becomes_smooth_at_its_critical_friction() {
    for (start, step) in [(0.8, 0.05), (1.2, 0.037)] {
        let settings = json!({"parameter": "/model/contacts/0/friction", "range": [0.65, 1.3], "step": step});
        let curve = curve_of(&round_arch(start), &settings).expect("a curve");
        let found = followed(&curve).expect("a curve");
        assert_eq!(ended(&found).paths, 4);
        let changes: Vec<&CurveRow> = found.rows.iter().filter(|row| row.codimension_two).collect();
        let [change] = changes[..] else { panic!("{changes:?}") };
        println!("from {start}: {:.9} at {:.9}", change.value, change.load_factor);
        close(change.value, 1.0370, 1e-4, "as published");
        for row in found.rows.iter().filter(|row| !row.codimension_two) {
            let kind = if row.value < change.value { PointKind::NonsmoothLimit } else { PointKind::SmoothLimit };
            assert_eq!(row.kind, kind, "{}", row.value);
        }
        let off = worst(&curve, &found);
        println!("{off:e} from paths of their own");
        assert!(off <= 1e-8, "{off:e}");
    }
}

/// The path is traced anew past the change however many increments it takes to its limit point.
#[test]
fn a_change_is_passed_by_a_path_of_many_short_steps() {
    let mut request = round_arch(1.05);
    (request.analysis.arc_length.initial, request.analysis.arc_length.max) = (0.01, 0.01);
    request.analysis.max_increments = 5_000;
    let settings = json!({"parameter": "/model/contacts/0/friction", "range": [1, 1.1], "step": 0.05});
    let found = followed(&curve_of(&request, &settings).expect("a curve")).expect("a curve");
    assert_eq!(ended(&found).ends_below.as_deref(), Some("the end of the range is reached"));
    let first = found.rows.first().expect("a row");
    assert_eq!((first.value, first.kind), (1.0, PointKind::NonsmoothLimit));
}

/// A curve that is cancelled, at a point or while a path is compared with it, says nothing of its ends.
#[test]
fn a_range_with_an_end_that_makes_no_model_is_refused_at_once() {
    let request = scene_file("arch-type-truss");
    for (parameter, range, found) in [
        ("/model/contacts/0/friction", [-1.0, 1.0], "with -1 the model is refused"),
        ("/model/dimension", [1.0, 3.0], "with 1 the model is refused"),
        ("/model/elements/0/axial_stiffness", [0.0, 1.0], "with 0 the model is refused"),
    ] {
        let refused = curve_of(&request, &json!({"parameter": parameter, "range": range}));
        let errors = refused.expect_err(parameter).0;
        assert_eq!(errors[0].pointer, "/curve/range");
        assert!(errors[0].detail.starts_with(found), "{}", errors[0].detail);
    }
}

/// The limit load of the truss of `one-bar-truss` comes to nothing at `mu = 1.5`, where its bar is horizontal from the start.
#[test]
fn a_point_off_the_measure_ends_the_curve_and_leaves_the_points_before() {
    let request = scene_file("one-bar-truss");
    let settings =
        json!({"parameter": "/model/contacts/0/friction", "range": [0.0, 1.5], "step": 0.1, "limit_point": 2});
    let found = followed(&curve_of(&request, &settings).expect("a curve")).expect("points");
    assert!(found.rows.len() >= 15 && found.rows.iter().all(|row| row.value < 1.5), "{}", found.rows.len());
    let above = ended(&found).ends_above.clone().expect("an end");
    assert!(above.contains("off the measure"), "{above}");
}

/// Over an imperfection the tall truss buckles before its symmetric limit point: points that continue it are on no path, and
/// say so.
#[test]
fn points_past_one_that_a_path_does_not_have_are_marked() {
    let bar = |end: &str| json!({"kind": "bar", "nodes": [end, "apex"], "axial_stiffness": 1.0, "strain": "green"});
    let request = typed(json!({"model": {
        "dimension": 2, "nodes": {"left": [-1, 0], "right": [1, 0], "apex": [0, 2]},
        "supports": {"left": ["x", "y"], "right": ["x", "y"]}, "elements": [bar("left"), bar("right")],
        "stages": [{"name": "press", "forces": {"apex": [0, -1]},
                    "until": {"displacement": {"node": "apex", "component": "y", "below": -4}}}],
    }}));
    let settings = json!({"parameter": "/model/nodes/apex/0", "range": [-0.1, 0.1], "step": 0.02});
    let found = followed(&curve_of(&request, &settings).expect("a curve")).expect("points");
    let summary = ended(&found);
    let on_path: Vec<f64> = found.known_on_path().rows.iter().map(|row| row.value).collect();
    assert_eq!(on_path, [0.0]);
    assert!(found.rows.iter().all(|row| summary.is_off_path(row) == (row.value != 0.0)));
    let table = critical_curves::table::csv(&found).expect("a table");
    assert_eq!(table.matches(",true,").count() + 1, found.rows.len() + 1, "{table}");
}

/// The curve is lost by short steps, and all points between the last long step and there are on no path.
#[test]
fn points_up_to_where_a_curve_is_lost_are_marked() {
    let request = crate::common::paths::request(include_str!("models/three-bars-on-a-rough-foot.json"));
    let settings = json!({
        "parameter": "/model/nodes/n0/1", "range": [0.233, 0.875], "step": 0.08, "increment": 66,
    });
    let curve = curve_of(&request, &settings).expect("a curve");
    let found = followed(&curve).expect("a curve");
    let summary = ended(&found);
    let [marked, others]: [Vec<&CurveRow>; 2] =
        [true, false].map(|is_off| found.rows.iter().filter(|row| summary.is_off_path(row) == is_off).collect());
    assert!(marked.len() > 3 && marked.iter().all(|row| row.value < 0.44), "{marked:?}");
    for row in others.iter().filter(|row| !row.codimension_two) {
        close(off_path(&curve, row).unwrap_or(f64::INFINITY), 0.0, 1e-7, "a limit point of a path");
    }
}

#[test]
fn a_cancelled_curve_claims_no_end() {
    let settings = json!({"parameter": "/model/contacts/*/friction", "range": [0, 2], "step": 0.1});
    let curve = curve_of(&scene_file("arch-type-truss"), &settings).expect("a curve");
    for last in [0, 3, 16, 20] {
        let (cancel, mut count) = (CancelFlag::default(), 0);
        let summary = critical_curves::run(&curve, &cancel, &mut |row| {
            count += 1;
            if row.index == last {
                cancel.cancel();
            }
            ControlFlow::Continue(())
        });
        let summary = summary.expect("a curve");
        assert!(!summary.complete && summary.ends_above.is_none() && count == last + 1, "{last}: {summary:?}");
    }
}

/// The thrust ratio of the stuck arch is 2/π at the first load. With less friction the foot slides from the start, sticks and
/// slips again, with still less it slides throughout: then the load no longer turns there.
#[test]
fn the_limit_point_of_the_arch_is_lost_where_its_foot_slides_all_the_way() {
    let settings = json!({"parameter": "/model/contacts/0/friction", "range": [0.5, 0.8]});
    let found = followed(&curve_of(&round_arch(0.8), &settings).expect("a curve")).expect("a curve");
    let changes: Vec<&CurveRow> = found.rows.iter().filter(|row| row.codimension_two).collect();
    let slides = changes.iter().find(|row| row.event.as_ref().is_some_and(|event| event.contains("begins to slip")));
    close(slides.expect("a change").value, std::f64::consts::FRAC_2_PI, 1e-5, "the thrust ratio");
    let end = ended(&found).ends_below.clone().expect("an end");
    assert!(end.contains("does not go on past 0.635"), "{end}");
}

/// `L³ = L0` at the limit point: its load over the height of the truss in closed form, and no limit point without height.
#[test]
fn the_limit_load_of_von_mises_truss_over_its_height() {
    let settings = json!({"parameter": "/model/nodes/apex/1", "range": [0.05, 0.9]});
    let curve = curve_of(&scene_file("von-mises-truss"), &settings).expect("a curve");
    let found = followed(&curve).expect("a curve");
    assert!(ended(&found).complete && found.rows.len() > 30);
    for row in &found.rows {
        let rest = row.value.hypot(1.0);
        let height = (rest.powf(2.0 / 3.0) - 1.0).sqrt();
        let length = height.hypot(1.0);
        close(row.load_factor, 2.0 * (1.0 - length / rest) * height / length, 1e-13, "load");
        close(row.value + row.displacements["apex"][1], height, 1e-9, "height");
    }
}

/// With a spring `k` under the apex `1/L³ = 1/L0 + k/2` at both limit points, which meet at `L = 1`: there the curve turns back.
#[test]
fn the_curve_turns_back_where_maximum_and_minimum_of_the_load_meet() {
    let mut request = serde_json::to_value(scene_file("von-mises-truss")).expect("JSON");
    let spring = json!({"kind": "spring", "nodes": ["apex"], "stiffness": [[0, 0], [0, 0.02]]});
    request["model"]["elements"].as_array_mut().expect("elements").push(spring);
    let request: JobRequest = serde_json::from_value(request).expect("a request");
    let settings = json!({"parameter": "/model/elements/2/stiffness/1/1", "range": [0.01, 0.3], "step": 0.02});
    let found = followed(&curve_of(&request, &settings).expect("a curve")).expect("a curve");
    assert_eq!(ended(&found).paths, 3);
    let rest = 1.25_f64.sqrt();
    let turns: Vec<&CurveRow> = found.rows.iter().filter(|row| row.codimension_two).collect();
    let [turn] = turns[..] else { panic!("{turns:?}") };
    close(turn.value, 2.0 * (1.0 - 1.0 / rest), 1e-9, "the stiffness without snap-through");
    close(turn.displacements["apex"][1], -0.5, 1e-4, "flat");
    for row in &found.rows {
        // The maximum before the turn, the minimum past it.
        let sign = if row.place < turn.place { 1.0 } else { -1.0 };
        let length = (1.0 / rest + 0.5 * row.value).powf(-1.0 / 3.0);
        let height = sign * (length * length - 1.0).max(0.0).sqrt();
        let load = -2.0 * (1.0 / rest - 1.0 / length) * height + row.value * (0.5 - height);
        close(row.load_factor, load, 1e-10, "load");
    }
    let ends = [found.rows.first(), found.rows.last()].map(|row| row.expect("a row").value);
    assert_eq!(ends, [0.01, 0.01], "once at the maximum, once at the minimum");
    assert!(found.rows.len() < 60, "{}", found.rows.len());
}

/// Klarbring's node is pressed in one stage and pulled in the next: the limit points at which it slips and leaves the floor.
/// A contact begins to slip just before the load turns, where it stops again: past the last friction at which it does, it sticks
/// all the way, and the load turns smoothly.
#[test]
fn the_curve_goes_on_where_a_change_before_the_limit_point_vanishes() {
    for step in [0.01, 0.1] {
        a_change_before_the_limit_point_vanishes(step);
    }
}

fn a_change_before_the_limit_point_vanishes(step: f64) {
    let settings =
        json!({"parameter": "/model/contacts/*/friction", "range": [0.25, 0.7], "step": step, "limit_point": 2});
    let curve = curve_of(&scene_file("three-snapping-bars"), &settings).expect("a curve");
    let found = followed(&curve).expect("a curve");
    ended(&found);
    let changes: Vec<&CurveRow> = found.rows.iter().filter(|row| row.codimension_two).collect();
    let [other, change] = changes[..] else { panic!("{changes:?}, {:?}", found.summary) };
    let event = other.event.as_deref().expect("an event");
    assert!(event.starts_with("the path leaves the nonsmooth limit point along another direction"), "{event}");
    the_direction_changes_at(&curve, other);
    let event = change.event.as_deref().expect("an event");
    assert!(event.ends_with("the nonsmooth limit point becomes a smooth limit point"), "{event}");
    assert!((0.3068..0.3069).contains(&change.value), "{}", change.value);
    for row in found.rows.iter().filter(|row| !row.codimension_two) {
        let kind = if row.value <= change.value { PointKind::NonsmoothLimit } else { PointKind::SmoothLimit };
        assert_eq!(row.kind, kind, "{}", row.value);
    }
    // From there to the change the path leaves the limit point along its other direction: the curve goes on along its own.
    let clear = found.rows.iter().filter(|row| !(other.value..=change.value).contains(&row.value));
    let off = clear.map(|row| off_path(&curve, row).unwrap_or(f64::INFINITY)).fold(0.0, f64::max);
    println!("{off:e} from paths of their own");
    assert!(off <= 1e-8, "{off:e}");
}

/// A path just before has this limit point; one just past it leaves the same state along a direction in which the load goes on.
fn the_direction_changes_at(curve: &ParameterCurve, row: &CurveRow) {
    let off = |shift: f64| {
        let beside = CurveRow { value: row.value + shift, ..row.clone() };
        off_path(curve, &beside).unwrap_or(f64::INFINITY)
    };
    let (before, past) = (off(-1e-6), off(1e-6));
    println!("the path prefers another direction at {}: off by {before:e} before, {past:e} past it", row.value);
    assert!(before < 1e-4 && past > 1e-3, "{before:e}, {past:e}");
}

#[test]
fn limit_points_of_later_stages_are_followed_with_what_the_stages_before_left() {
    let request = scene_file("klarbring");
    for limit in [1, 2] {
        let settings = json!({"parameter": "/model/contacts/0/friction", "range": [1.3, 1.9], "limit_point": limit});
        let curve = curve_of(&request, &settings).expect("a curve");
        let found = followed(&curve).expect("a curve");
        assert!(ended(&found).complete);
        assert!(found.rows.iter().all(|row| row.stage == request.model.stages[1].name.as_str().into()));
        let off = worst(&curve, &found);
        println!("limit point {limit}: {off:e}, {} rows", found.rows.len());
        assert!(off <= 1e-8, "{off:e}");
    }
}

/// Random scenes: every point of a curve is a limit point of a path of its own.
#[test]
fn curves_of_random_scenes_agree_with_paths() {
    let (mut curves, mut points, mut changes, mut lost) = (0, 0, 0, 0);
    let mut faults = Vec::new();
    for seed in 0..200 {
        let mut request = random_scene(seed);
        request.model.stages.iter_mut().for_each(|stage| stage.control = StageControl::Path);
        let own = request.model.contacts.first().map_or(0.0, |contact| contact.friction);
        if own <= 0.0 {
            continue;
        }
        let settings = json!({
            "parameter": "/model/contacts/0/friction", "range": [0.8 * own, 1.2 * own], "step": 0.05 * own,
        });
        let Ok(curve) = curve_of(&request, &settings) else { continue };
        let Ok(found) = followed(&curve) else { continue };
        curves += 1;
        points += found.rows.len();
        changes += found.rows.iter().filter(|row| row.codimension_two).count();
        for (end, value) in [(&ended(&found).ends_below, 0.8 * own), (&ended(&found).ends_above, 1.2 * own)] {
            if let Some(end) = end.as_ref().filter(|end| end.contains("does not go on")) {
                println!("{seed}, to {value}: {end}");
                lost += 1;
            }
        }
        // Where limit points are about to vanish, the steps of a path pass over them.
        let is_crowded = |row: &CurveRow| {
            let beside = found.rows.iter().filter(|other| other.place != row.place);
            beside.map(|other| (other.value - row.value).abs()).any(|width| width < 1e-3 * own)
        };
        for row in found.rows.iter().filter(|row| !row.codimension_two && !is_crowded(row)) {
            let off = off_path(&curve, row).unwrap_or(f64::INFINITY);
            if off > 1e-8 {
                faults.push((seed, row.value, off));
            }
        }
    }
    println!("{curves} curves, {points} points, {changes} changes, {lost} lost; off: {faults:?}");
    assert!(curves > 20, "{curves}");
    assert!(faults.is_empty(), "{faults:?}");
}
