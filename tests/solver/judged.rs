//! Every increment carries what the measure says of it; the report its maxima; nothing is lost where a path is put down.

use crate::common::paths::{judge, scene, scene_file};
use arcslip::check::judged::{JudgedCheckpoint, JudgedCheckpointError, JudgedIncrement, JudgedPath, JudgedReport};
use arcslip::check::measure::{Errors, HistoryError};
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Method, Record, Regularised};
use arcslip::resources::cancel::CancelFlag;

/// A whole judged path.
fn whole(request: &JobRequest) -> (Vec<JudgedIncrement>, JudgedReport) {
    let scene = Scene::new(request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut path = JudgedPath::new(request, &scene, CancelFlag::default());
    let increments: Vec<JudgedIncrement> = path.by_ref().collect();
    (increments, path.report().expect("an ended path has a report"))
}

/// The report's maxima are those of the increments, the first of each.
fn assert_maxima(increments: &[JudgedIncrement], report: &JudgedReport, place: &str) {
    let maxima = serde_json::to_value(report.measure.largest).expect("written");
    for (figure, name) in Errors::NAMES.iter().enumerate() {
        let mut largest = (0.0, None);
        for judged in increments {
            let value = judged.measure.values()[figure];
            if value > largest.0 {
                largest = (value, Some(judged.increment.index));
            }
        }
        assert_eq!(maxima[name]["value"].as_f64(), Some(largest.0), "{place}: {name}");
        assert_eq!(maxima[name]["index"].as_u64(), largest.1, "{place}: {name}");
    }
}

#[test]
fn every_increment_of_every_scene_carries_it_and_holds_the_bars() {
    for built_in in arcslip::check::scenes::ALL {
        let request = scene(built_in.name);
        let (increments, report) = whole(&request);
        assert!(increments.len() > 2, "{}", built_in.name);
        for judged in &increments {
            let place = format!("{}, increment {}: {:?}", built_in.name, judged.increment.index, judged.measure);
            assert!(judged.measure.largest_of_state() <= 1e-10, "{place}");
            assert!(judged.measure.strain_energy <= 1e-10 && judged.measure.energy <= 1e-6, "{place}");
            let line = serde_json::to_string(judged).expect("written");
            let read: JudgedIncrement = serde_json::from_str(&line).expect("read");
            assert_eq!(&read, judged, "{place}");
            let value: serde_json::Value = serde_json::from_str(&line).expect("read");
            let names: Vec<&String> = value["measure"].as_object().expect("an object").keys().collect();
            assert_eq!(names, Errors::NAMES, "{place}");
        }
        assert_eq!((report.measure.bar, report.measure.off_measure), (Some(1e-9), 0), "{}", built_in.name);
        assert_maxima(&increments, &report, built_in.name);
        println!("{:<24} {}", built_in.name, serde_json::to_string(&report.measure.largest).expect("written"));
    }
}

/// The rival has no bar; its penetration is in the figures, as large as the penalty lets it be.
#[test]
fn the_rival_is_judged_too() {
    let mut request = scene_file("one-bar-truss");
    request.analysis.method = Method::Regularised;
    let contact = |penalty: f64| {
        let mut request = request.clone();
        let parameters = Regularised { normal_penalty: penalty, tangential_penalty: penalty, ..Regularised::default() };
        request.analysis.regularised = Some(parameters);
        let (increments, report) = whole(&request);
        assert_eq!((report.measure.bar, report.measure.off_measure), (None, 0));
        assert_maxima(&increments, &report, "regularised");
        for judged in &increments {
            let errors = judged.measure;
            assert!(errors.equilibrium <= 1e-9 && errors.cone <= 1e-12 && errors.arc_length <= 1e-10, "{errors:?}");
        }
        report.measure.largest.contact.value
    };
    let (soft, hard) = (contact(1e3), contact(1e5));
    assert!(soft > 1e-5 && (50.0..200.0).contains(&(soft / hard)), "{soft:e} {hard:e}");
}

/// A checkpoint as it comes back from where it was stored.
fn stored(path: &JudgedPath<'_>) -> JudgedCheckpoint {
    let text = serde_json::to_string(&path.checkpoint().expect("a checkpoint")).expect("written");
    serde_json::from_str(&text).expect("read")
}

fn without_time(mut judged: JudgedIncrement) -> JudgedIncrement {
    judged.increment.diagnostics.elapsed_s = 0.0;
    judged
}

const CUT: [(&str, u64); 5] =
    [("klarbring", 1), ("one-bar-truss", 9), ("arch-type-truss", 5), ("two-snapping-bars", 23), ("curving-slip", 3)];

#[test]
fn a_path_that_is_taken_up_again_is_judged_to_the_same_bits() {
    for (name, every) in CUT {
        let request = scene(name);
        let scene = Scene::new(&request).expect("a scene");
        let mut path = JudgedPath::new(&request, &scene, CancelFlag::default());
        let (mut increments, mut cuts) = (Vec::new(), Vec::new());
        while let Some(judged) = path.next() {
            if judged.increment.index % every == 0 {
                cuts.push((increments.len() + 1, stored(&path)));
            }
            increments.push(without_time(judged));
        }
        let report = path.report().expect("a report");
        for (place, checkpoint) in cuts {
            let mut resumed = JudgedPath::resume(&request, &scene, checkpoint, CancelFlag::default()).expect("resumed");
            let rest: Vec<JudgedIncrement> = resumed.by_ref().map(without_time).collect();
            assert!(rest == increments[place..], "{name}, cut at {place}");
            assert_eq!(resumed.report().expect("a report").measure, report.measure, "{name}, cut at {place}");
        }
    }
}

/// Put down at increments that are not recorded, the last ones of the path among them.
#[test]
fn a_path_of_which_little_is_recorded_is_taken_up_between_its_rows() {
    for (name, every) in CUT {
        let mut request = scene(name);
        request.analysis.record = Some(Record { every: 1_000_000, ..Record::default() });
        let scene = Scene::new(&request).expect("a scene");
        let whole = JudgedPath::new(&request, &scene, CancelFlag::default()).count() as u64;
        // One more than the events: an increment that is recorded as it is the last.
        request.analysis.max_increments = request.analysis.max_increments.min(whole + every + 1);
        let scene = Scene::new(&request).expect("a scene");
        let mut path = JudgedPath::new(&request, &scene, CancelFlag::default());
        let (mut increments, mut cuts) = (Vec::new(), Vec::new());
        while let Some(step) = path.step() {
            if step.given.is_none() {
                cuts.push((increments.len(), stored(&path), path.open_directions()));
            }
            increments.extend(step.given.map(without_time));
        }
        assert!(cuts.len() > 3, "{name}");
        let last = (path.checkpoint().expect("a checkpoint").path.index(), path.open_directions());
        let report = path.report().expect("a report");
        for (place, checkpoint, open) in cuts {
            let mut resumed = JudgedPath::resume(&request, &scene, checkpoint, CancelFlag::default()).expect("resumed");
            assert_eq!(resumed.open_directions(), open, "{name}");
            let rest: Vec<JudgedIncrement> = resumed.by_ref().map(without_time).collect();
            assert!(rest == increments[place..], "{name}, cut after {place} rows");
            assert_eq!(resumed.report().expect("a report").measure, report.measure, "{name}, cut after {place} rows");
            let end = (resumed.checkpoint().expect("a checkpoint").path.index(), resumed.open_directions());
            assert_eq!(end, last, "{name}");
        }
    }
}

/// Along the direction taken, the measure of the followed path is that of the path that goes on.
#[test]
fn a_followed_path_is_judged_as_the_path_that_goes_on() {
    for (name, every) in CUT {
        let request = scene(name);
        let scene = Scene::new(&request).expect("a scene");
        let mut path = JudgedPath::new(&request, &scene, CancelFlag::default());
        let (mut increments, mut cuts) = (Vec::new(), Vec::new());
        while let Some(judged) = path.next() {
            let directions = judged.increment.directions.as_deref().unwrap_or_default();
            let taken = directions.iter().position(|direction| direction.taken);
            if let Some(taken) = taken.filter(|taken| path.open_directions()[*taken])
                && judged.increment.index % every == 0
            {
                cuts.push((increments.len() + 1, taken, stored(&path)));
            }
            increments.push(judged);
        }
        assert!(name == "curving-slip" || cuts.len() > 1, "{name}");
        for (place, taken, checkpoint) in cuts {
            let event = "follows".to_owned();
            let mut followed = JudgedPath::follow(&request, &scene, checkpoint, taken, event, CancelFlag::default())
                .expect("followed");
            let found: Vec<JudgedIncrement> = followed.by_ref().take(increments.len() - place + 1).collect();
            assert!(found[0].measure.largest_of_state() <= 1e-10, "{name} at {place}: {:?}", found[0].measure);
            for (judged, parent) in found[1..].iter().zip(&increments[place..]) {
                assert_eq!(judged.measure, parent.measure, "{name}, followed from {place}");
            }
            let report = followed.by_ref().count();
            let measure = followed.report().expect("a report").measure;
            assert_eq!((measure.off_measure, measure.largest.equilibrium.value > 1e-10), (0, false), "{report}");
        }
    }
}

/// What the judge remembers is needed: one that sees the followed path alone knows nothing of what earlier stages hold.
#[test]
fn a_judge_without_the_history_finds_errors_that_are_none() {
    let request = scene("klarbring");
    let scene = Scene::new(&request).expect("a scene");
    let mut path = JudgedPath::new(&request, &scene, CancelFlag::default());
    let judged = path.by_ref().find(|judged| judged.increment.stage.as_ref() != request.model.stages[0].name);
    assert!(judged.is_some_and(|judged| judged.measure.largest_of_state() <= 1e-10));
    let last = path.next().expect("an increment");
    let errors = judge(&request, scene.plan()).judge(&last.increment);
    assert!(errors.equilibrium > 1e-2 && errors.arc_length > 1e-2, "{errors:?}");
}

#[test]
fn a_history_that_does_not_fit_is_refused() {
    let request = scene("klarbring");
    let scene = Scene::new(&request).expect("a scene");
    let mut path = JudgedPath::new(&request, &scene, CancelFlag::default());
    assert!(path.next().is_some());
    let text = serde_json::to_string(&path.checkpoint().expect("a checkpoint")).expect("written");
    let resume = |from: &str, to: &str| {
        let (before, after) = text.split_once("\"history\"").expect("a history");
        let changed = format!("{before}\"history\"{}", after.replacen(from, to, 1));
        assert_ne!(changed, text);
        let checkpoint: JudgedCheckpoint = serde_json::from_str(&changed).expect("read");
        JudgedPath::resume(&request, &scene, checkpoint, CancelFlag::default()).err()
    };
    let refused = |error: HistoryError| Some(JudgedCheckpointError::History(error));
    assert_eq!(resume("\"version\":5", "\"version\":7"), refused(HistoryError::Version { found: 7 }));
    let other = |what, found, expected| refused(HistoryError::OtherModel { what, found, expected });
    assert_eq!(resume("\"reached\":[", "\"reached\":[1.0,1.0,1.0"), other("finished stages", 3, 1));
    assert_eq!(resume("\"directions\":[", "\"directions\":[[1,[0.0,0.0,1.0]]"), other("contacts", 2, 1));
    assert_eq!(resume("\"displacements\":[", "\"displacements\":[[0.0,0.0,0.0],"), other("nodes", 2, 1));
}
