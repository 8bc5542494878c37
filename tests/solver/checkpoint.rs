//! A path that is put down and taken up again is the same path; a direction that is followed carries everything over.

use crate::common::paths::{judge, scene, trace};
use arcslip::check::scenes::of_any_size::slider_chain;
use arcslip::continuation::path::checkpoint::{Checkpoint, CheckpointError};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Method, Until};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Diagnostics, Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

/// A checkpoint as it comes back from where it was stored.
fn stored(checkpoint: &Checkpoint) -> Checkpoint {
    let text = serde_json::to_string(checkpoint).expect("written");
    let read: Checkpoint = serde_json::from_str(&text).expect("read");
    assert_eq!(serde_json::to_string(&read).expect("written"), text);
    read
}

fn line(mut increment: Increment) -> String {
    increment.diagnostics.elapsed_s = 0.0;
    serde_json::to_string(&increment).expect("written")
}

/// Increments up to an index, and the checkpoint there.
fn until(scene: &Scene, index: u64) -> (Vec<Increment>, Checkpoint) {
    let mut path = Path::new(scene, CancelFlag::default());
    let increments: Vec<Increment> = path.by_ref().take(index as usize + 1).collect();
    assert_eq!(increments.last().map(|increment| increment.index), Some(index));
    (increments, stored(&path.checkpoint()))
}

/// The direction that is listed and neither taken nor the way back.
fn other_direction(increment: &Increment) -> usize {
    let directions = increment.directions.as_ref().expect("directions");
    directions.iter().position(|direction| !direction.taken && !direction.retrace).expect("an alternative")
}

/// A path along a direction, with its increments judged after those that lead to it.
fn follow(request: &JobRequest, before: &[Increment], checkpoint: Checkpoint, direction: usize) -> Vec<Increment> {
    let scene = Scene::new(request).expect("a scene");
    let path = Path::follow(&scene, checkpoint, direction, "follows".to_owned(), CancelFlag::default());
    let increments: Vec<Increment> = path.unwrap_or_else(|error| panic!("{error}")).collect();
    let mut judge = judge(request, scene.plan());
    for increment in before.iter().chain(&increments) {
        let errors = judge.judge(increment);
        assert!(errors.largest_of_state() <= 1e-10, "increment {}: {errors:?}", increment.index);
        assert!(errors.strain_energy <= 1e-10 && errors.energy <= 1e-6, "increment {}: {errors:?}", increment.index);
    }
    for (index, increment) in increments.iter().enumerate() {
        assert_eq!(increment.index, index as u64);
    }
    increments
}

/// Every increment of every scene is a place to cut the path; each of the small scenes is cut at all of them.
#[test]
fn a_path_that_is_taken_up_again_has_the_same_bits() {
    for (name, method, every) in [
        ("klarbring", Method::Auto, 1),
        ("klarbring", Method::Mpec, 7),
        ("one-bar-truss", Method::Auto, 5),
        ("arch-type-truss", Method::Auto, 3),
        ("two-snapping-bars", Method::Auto, 11),
        ("three-snapping-bars", Method::Auto, 37),
        ("von-mises-truss", Method::Auto, 4),
    ] {
        let mut request = scene(name);
        request.analysis.method = method;
        is_the_same_wherever_it_is_cut(name, &request, every);
    }
}

/// Sliders of different weights, springs and friction, pulled until most slip, and pushed back: where nothing bends the
/// path a factorisation is passed on from point to point, and a path that is taken up again has none.
#[test]
fn a_straight_path_that_is_taken_up_again_has_the_same_bits() {
    let mut document = slider_chain(40, 0.3, 1.0, 1.0);
    let model = &mut document["model"];
    for block in 0..40 {
        let part = |by: usize| 1.0 + (block * by % 17) as f64 / 23.0;
        model["contacts"][block]["friction"] = json!(0.2 * part(5));
        model["stages"][0]["forces"][format!("block{block}")] = json!([0, -part(7)]);
        if block > 0 {
            model["elements"][block - 1]["stiffness"] = json!([[part(3), 0], [0, 0]]);
        }
    }
    model["stages"][1]["until"] = json!({"load_above": 9});
    let back = json!({"name": "back", "forces": {"block0": [-1, 0]}, "until": {"load_above": 18}});
    model["stages"].as_array_mut().expect("stages").push(back);
    let request: JobRequest = serde_json::from_value(document).expect("a request");
    let increments = is_the_same_wherever_it_is_cut("chain", &request, 1);
    let changes = increments.iter().filter(|increment| increment.point.kind == PointKind::ContactChange).count();
    let factorisations = increments.last().map_or(0, |increment| increment.diagnostics.factorisations);
    assert!(changes > 40, "{changes}");
    // Each would take one at the least.
    assert!(factorisations < changes as u64 - 10, "{factorisations} for {changes} changes");
}

/// The path's increments; one of so many is a place at which it is cut.
fn is_the_same_wherever_it_is_cut(name: &str, request: &JobRequest, every: u64) -> Vec<Increment> {
    let scene = Scene::new(request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let (mut increments, mut cuts) = (Vec::new(), Vec::new());
    while let Some(increment) = path.next() {
        if increment.index % every == 0 {
            cuts.push((increment.index, stored(&path.checkpoint())));
        }
        increments.push(increment);
    }
    let lines: Vec<String> = increments.iter().cloned().map(line).collect();
    let report = path.report().expect("a report");
    for (index, checkpoint) in cuts {
        let mut resumed = Path::resume(&scene, checkpoint, CancelFlag::default()).expect("resumed");
        let rest: Vec<String> = resumed.by_ref().map(line).collect();
        assert!(rest == lines[index as usize + 1..], "{name}, cut at {index}");
        let mut again = resumed.report().expect("a report");
        assert!(again.elapsed_s > 0.0);
        again.elapsed_s = report.elapsed_s;
        assert_eq!(again, report, "{name}, cut at {index}");
    }
    increments
}

/// The direction that was taken leads along the same points; indices, work and time are the new path's own.
#[test]
fn following_the_direction_taken_gives_the_same_points() {
    for (name, every) in [("klarbring", 1), ("one-bar-truss", 9), ("arch-type-truss", 4), ("two-snapping-bars", 17)] {
        let request = scene(name);
        let (whole, _) = trace(&request);
        let scene = Scene::new(&request).expect("a scene");
        let mut cuts = 0;
        for increment in whole.iter().filter(|increment| increment.directions.is_some()).step_by(every) {
            let taken = increment.directions.as_ref().and_then(|list| list.iter().position(|way| way.taken));
            let Some(taken) = taken else { continue };
            let (before, checkpoint) = until(&scene, increment.index);
            if Path::follow(&scene, checkpoint.clone(), taken, String::new(), CancelFlag::default()).is_err() {
                assert!(increment.point.event.as_deref().is_some_and(|event| event.contains("ends")));
                continue;
            }
            cuts += 1;
            let followed = follow(&request, &before, checkpoint, taken);
            let bare = |increment: &Increment, shift: u64| {
                let mut increment = increment.clone();
                increment.index += shift;
                increment.diagnostics =
                    Diagnostics { energy_error: increment.diagnostics.energy_error, ..Diagnostics::default() };
                serde_json::to_string(&increment).expect("written")
            };
            let expected: Vec<String> =
                whole[increment.index as usize + 1..].iter().map(|increment| bare(increment, 0)).collect();
            let found: Vec<String> =
                followed[1..].iter().map(|increment| bare(increment, before.len() as u64 - 1)).collect();
            assert!(found == expected, "{name}, from {}", increment.index);
        }
        assert!(cuts > 0, "{name}");
    }
}

/// From a falling stretch of the one-bar truss, every point of which is a bifurcation: the tip sticks, the load falls
/// with nothing moving, and the friction of the other side is reached at `s = P (-μ h - x)/L`. From there the tip slips
/// back the way it came, along the path of friction `-μ`.
#[test]
fn the_stuck_alternative_of_the_one_bar_truss() {
    let request = scene("one-bar-truss");
    let scene = Scene::new(&request).expect("a scene");
    let (whole, _) = trace(&request);
    let place =
        whole.iter().position(|increment| increment.point.bifurcation && increment.displacements["tip"][0] > 1.2);
    let (before, checkpoint) = until(&scene, place.expect("a bifurcation point") as u64);
    let from = before.last().expect("a point");
    assert_eq!(from.point.kind, PointKind::Regular);
    let direction = other_direction(from);
    assert_eq!(from.directions.as_ref().expect("directions")[direction].contacts, [Status::Stick]);
    let followed = follow(&request, &before, checkpoint.clone(), direction);

    let start = &followed[0];
    assert_eq!((start.point.kind, start.point.event.as_deref()), (PointKind::Start, Some("follows")));
    assert_eq!((start.load_factor, start.arc_length, start.energy), (from.load_factor, from.arc_length, from.energy));
    assert_eq!((&start.displacements, start.step), (&from.displacements, 0.0));
    assert_eq!(start.contacts[0].status, Status::Stick);
    assert!(start.point.bifurcation && start.directions.as_ref().expect("directions")[direction].taken);

    let load = |x: f64, friction: f64| {
        let (length, rest) = (x.hypot(1.0), 1.5_f64.hypot(1.0));
        (1.0 - length / rest) * (friction - x) / length
    };
    let x = from.displacements["tip"][0] - 1.5;
    let corner =
        followed.iter().position(|increment| increment.index > 0 && increment.point.event.is_some()).expect("an event");
    for pair in followed[..=corner].windows(2) {
        assert!(pair[1].load_factor < pair[0].load_factor);
        assert!((pair[1].displacements["tip"][0] - from.displacements["tip"][0]).abs() < 1e-13);
        // Nothing moves: no work, no dissipation.
        assert!((pair[1].energy.external_work - from.energy.external_work).abs() < 1e-13);
        assert!((pair[1].energy.dissipated - from.energy.dissipated).abs() < 1e-13);
    }
    // Slipping back, the load rises: the corner is a limit point.
    assert_eq!(followed[corner].point.kind, PointKind::NonsmoothLimit);
    assert!((followed[corner].load_factor - load(x, -0.3)).abs() < 1e-12);
    let (mut slips, mut dissipated) = (0, from.energy.dissipated);
    for increment in &followed[corner + 1..] {
        let x = increment.displacements["tip"][0] - 1.5;
        if increment.contacts[0].status == Status::Slip && increment.contacts[0].slip[0] < 0.0 {
            slips += 1;
            assert!((increment.load_factor - load(x, -0.3)).abs() < 1e-10);
            assert!(increment.energy.dissipated > dissipated);
        }
        dissipated = increment.energy.dissipated;
    }
    assert!(slips > 3, "the tip slips back");

    // A second generation, from a point of the first: the tip sticks again and the load rises.
    let scene = Scene::new(&request).expect("a scene");
    let mut path = Path::follow(&scene, checkpoint, direction, String::new(), CancelFlag::default()).expect("followed");
    let first: Vec<Increment> = path.by_ref().take(corner + 3).collect();
    let second_from = first.last().expect("a point");
    let again = stored(&path.checkpoint());
    let leading: Vec<Increment> = before.iter().chain(&first).cloned().collect();
    let second = follow(&request, &leading, again, other_direction(second_from));
    let x = second_from.displacements["tip"][0] - 1.5;
    let corner =
        second.iter().position(|increment| increment.index > 0 && increment.point.event.is_some()).expect("an event");
    assert!((second[corner].load_factor - load(x, 0.3)).abs() < 1e-12);
    assert_eq!(second[0].energy, second_from.energy);
}

/// The counts of a stage are those of the whole path that leads here, with this point counted as it is left.
#[test]
fn counts_of_the_stage_go_on() {
    let mut request = scene("one-bar-truss");
    request.model.stages[0].until = Some(Until { limit_points: Some(2), ..Until::default() });
    let (whole, _) = trace(&request);
    let scene = Scene::new(&request).expect("a scene");
    // Leaving the falling stretch by sticking is no limit point: one has passed, and the next one ends the stage.
    let falling =
        whole.iter().position(|increment| increment.point.bifurcation && increment.point.kind == PointKind::Regular);
    let (before, checkpoint) = until(&scene, falling.expect("a bifurcation point") as u64);
    let followed = follow(&request, &before, checkpoint, other_direction(before.last().expect("a point")));
    let limits = |path: &[Increment]| {
        let kinds = path[1..].iter().map(|increment| increment.point.kind);
        kinds.filter(|kind| matches!(kind, PointKind::SmoothLimit | PointKind::NonsmoothLimit)).count()
    };
    assert_eq!(limits(&followed), 1);
    assert!(followed.last().and_then(|last| last.point.event.clone()).is_some_and(|event| event.contains("ends")));
    // Leaving the rising stretch by sticking is one, and ends a stage that ends with the first.
    request.model.stages[0].until = Some(Until { limit_points: Some(1), ..Until::default() });
    let scene = Scene::new(&request).expect("a scene");
    let rising = whole
        .iter()
        .find(|increment| increment.index > 3 && increment.directions.is_some() && !increment.point.bifurcation)
        .expect("a rising point");
    let (_, checkpoint) = until(&scene, rising.index);
    let direction = other_direction(rising);
    let refused = Path::follow(&scene, checkpoint, direction, String::new(), CancelFlag::default()).err();
    assert_eq!(refused, Some(CheckpointError::StageEnds { stage: "push".to_owned(), direction }));
}

#[test]
fn what_cannot_be_followed_is_refused_with_the_reason() {
    let request = scene("klarbring");
    let scene = Scene::new(&request).expect("a scene");
    let (whole, _) = trace(&request);
    let plain = whole.iter().find(|increment| increment.directions.is_none()).expect("a point with one way on");
    let (_, checkpoint) = until(&scene, plain.index);
    let follow = |checkpoint: Checkpoint, direction: usize| {
        Path::follow(&scene, checkpoint, direction, String::new(), CancelFlag::default()).err()
    };
    assert_eq!(follow(checkpoint, 0), Some(CheckpointError::NothingListed));
    let listing = whole.iter().find(|increment| increment.directions.is_some()).expect("a point with directions");
    let listed = listing.directions.as_ref().expect("directions").len();
    let (_, checkpoint) = until(&scene, listing.index);
    assert_eq!(follow(checkpoint.clone(), listed), Some(CheckpointError::NoSuchDirection { found: listed, listed }));
    let other = crate::common::paths::scene("one-bar-truss");
    let other = Scene::new(&other).expect("a scene");
    let refused = Path::resume(&other, checkpoint.clone(), CancelFlag::default()).err();
    assert!(matches!(refused, Some(CheckpointError::OtherModel { .. })), "{refused:?}");
    let text = serde_json::to_string(&checkpoint).expect("written").replacen("\"version\":11", "\"version\":99", 1);
    let newer: Checkpoint = serde_json::from_str(&text).expect("read");
    assert_eq!(Path::resume(&scene, newer, CancelFlag::default()).err(), Some(CheckpointError::Version { found: 99 }));
}

/// A stage that ends at a point ends there along every direction that goes on past its end, and not along the others.
#[test]
fn the_end_of_a_stage_is_left_by_its_inner_side_only() {
    let mut request = scene("one-bar-truss");
    request.model.stages[0].until = Some(Until { load_above: Some(0.2), ..Until::default() });
    let (whole, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let last = whole.last().expect("an end");
    let directions = last.directions.as_ref().expect("directions");
    let taken = directions.iter().position(|direction| direction.taken).expect("a direction taken");
    let scene = Scene::new(&request).expect("a scene");
    let (before, checkpoint) = until(&scene, last.index);
    let refused = Path::follow(&scene, checkpoint.clone(), taken, String::new(), CancelFlag::default()).err();
    assert_eq!(refused, Some(CheckpointError::StageEnds { stage: "push".to_owned(), direction: taken }));
    let followed = follow(&request, &before, checkpoint, other_direction(last));
    assert!(followed.len() > 2 && followed[1].load_factor < 0.2);
}

/// A long trail is stored in parts, and comes back whole.
#[test]
fn a_trail_in_parts_is_the_trail() {
    let request = scene("three-snapping-bars");
    let scene = Scene::new(&request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let (mut parts, mut taken) = (Vec::new(), 0);
    while path.next().is_some() {
        let mut checkpoint = path.checkpoint();
        let whole = serde_json::to_string(&checkpoint).expect("written");
        let length = checkpoint.trail_length();
        parts.push(checkpoint.take_trail(taken));
        taken = length;
        assert!(checkpoint.take_trail(0).is_empty(), "taken out");
        checkpoint.put_trail(parts.clone());
        assert_eq!(serde_json::to_string(&checkpoint).expect("written"), whole);
    }
    assert!(parts.iter().filter(|part| !part.is_empty()).count() > 3);
}
