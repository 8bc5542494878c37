//! The uncertainty that is stated of a self-converged reference, beside its true error.

use crate::check::scenes;
use crate::model::decode;
use crate::model::request::study::{ReferenceChoice, Study, StudyRequest};
use crate::resources::cancel::CancelFlag;
use crate::studies::error_against_time::reference::{Standard, exact_of};
use crate::studies::error_against_time::trace::{StudyTrace, TracedStage};

/// Places at which each segment of a reference is compared.
const PARTS: usize = 10;
/// Where no exact path is known, a reference with arc lengths over this is taken for one.
const FINER: f64 = 8.0;
/// True errors up to this are round-off, which the largest estimate may exceed by more.
const ROUND_OFF: f64 = 1e-13;

fn request(name: &str, arc_length: f64, reference: ReferenceChoice) -> StudyRequest {
    let job = decode::decode(scenes::find(name).expect("a scene").request.as_bytes()).expect("a request");
    let study = Study { arc_lengths: Some(vec![arc_length]), repeats: 0, reference, ..Study::default() };
    let mut request = StudyRequest { model: job.model, analysis: job.analysis, study };
    request.analysis.max_increments *= 20;
    request
}

fn standard(request: &StudyRequest) -> Standard {
    Standard::new(request, &CancelFlag::default()).expect("a study").expect("a reference")
}

/// Stated uncertainty, and true error of the curve all along.
fn stated_and_true(name: &str, arc_length: f64) -> (f64, f64) {
    let own = standard(&request(name, arc_length, ReferenceChoice::SelfConverged));
    let stages = own.curves().iter().map(|curve| TracedStage {
        stage: curve.stage,
        points: (0..=curve.segments() * PARTS)
            .map(|part| (part / PARTS).min(curve.segments() - 1))
            .zip(0..)
            .map(|(segment, part)| curve.at(segment, (part - segment * PARTS) as f64 / PARTS as f64))
            .collect(),
        events: Vec::new(),
    });
    let trace = StudyTrace { stages: stages.collect() };
    let auto = request(name, arc_length, ReferenceChoice::Auto);
    let better = match exact_of(&auto, &auto.finer_job(1.0)).expect("a choice") {
        Some(_) => auto,
        None => request(name, arc_length / FINER, ReferenceChoice::SelfConverged),
    };
    let error = standard(&better).measure(&trace, &CancelFlag::default()).path_error.expect("an error");
    (own.reference.uncertainty.expect("an uncertainty"), error)
}

fn check(name: &str, arc_lengths: &[f64]) {
    for arc_length in arc_lengths {
        let (stated, error) = stated_and_true(name, *arc_length);
        println!("{name}, {arc_length}: stated {stated:.1e}, true {error:.1e}");
        assert!(error <= stated, "{name}, {arc_length}: stated {stated:e}, true {error:e}");
        let near = error <= ROUND_OFF || stated <= 30.0 * error;
        assert!(near, "{name}, {arc_length}: stated {stated:e}, true {error:e}");
    }
}

/// Every built-in scene, against its exact path or a much finer one.
#[test]
fn no_reference_is_worse_than_it_says() {
    for scene in scenes::ALL {
        check(scene.name, &[0.2, 0.1]);
    }
}

/// Where the path bends sharply between events, and where increments have an error of their own.
#[test]
fn bends_and_slips_in_space_are_seen_at_every_arc_length() {
    check("three-snapping-bars", &[0.4, 0.05, 0.025]);
    for scene in ["one-bar-truss", "curving-slip", "turning-drag", "hump", "closed-loop"] {
        check(scene, &[0.4, 0.05, 0.025, 0.01]);
    }
}
