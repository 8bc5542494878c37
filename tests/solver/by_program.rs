//! `method: "mpec"` without the certificate: every increment is found by its program alone, and the path is that of `auto`.

use crate::common::paths::{judged, request, scene};
use crate::common::random::{random_scene, random_space};
use arcslip::model::JobRequest;
use arcslip::model::request::{Certificate, Method, Mpec};
use arcslip::result::increment::Increment;
use arcslip::result::report::Report;

/// Largest difference of loads and displacements from those of `auto`.
const SAME: f64 = 1e-8;
/// Largest error of the state: past it an increment would be said to be off the measure.
const STATE: f64 = 1e-10;
/// Random scenes of a default run, and of the whole one: `random_scene`, then `random_space`.
const SOME: [u64; 2] = [16, 4];
const ALL: [u64; 2] = [140, 60];
/// Increments of a path that is not traced to its end.
const MOST_INCREMENTS: u64 = 15;

fn by(request: &JobRequest, method: Method, mpec: Option<Mpec>) -> JobRequest {
    let mut request = request.clone();
    (request.analysis.method, request.analysis.mpec) = (method, mpec);
    request
}

fn skipping(request: &JobRequest) -> JobRequest {
    by(request, Method::Mpec, Some(Mpec { certificate: Certificate::Skip }))
}

fn using(request: &JobRequest) -> JobRequest {
    by(request, Method::Mpec, None)
}

/// What differs from the path of `auto`.
fn differs(auto: &[Increment], other: &[Increment]) -> Option<String> {
    if auto.len() != other.len() {
        return Some(format!("{} increments, then {}", auto.len(), other.len()));
    }
    auto.iter().zip(other).find_map(|(one, other)| {
        let moved = one.displacements.values().flatten().zip(other.displacements.values().flatten());
        let apart = moved.fold((one.load_factor - other.load_factor).abs(), |most, (a, b)| most.max((a - b).abs()));
        let is_same = apart <= SAME && one.point.kind == other.point.kind && one.point.event == other.point.event;
        (!is_same).then(|| format!("increment {}: {apart:e} apart, {:?}, {:?}", one.index, one.point, other.point))
    })
}

/// What is wrong with a path whose increments are found by their programs.
fn faults(increments: &[Increment], report: &Report) -> Vec<String> {
    let mut faults = Vec::new();
    let mut fault = |what: String| faults.push(what);
    if report.certificates != 0 {
        fault(format!("{} certificates", report.certificates));
    }
    for pair in increments.windows(2) {
        let (before, now) = (&pair[0].diagnostics, &pair[1].diagnostics);
        let index = pair[1].index;
        let is_solved = now.mpec_solves > before.mpec_solves && now.sqp_iterations > before.sqp_iterations;
        // A stage begins, or two changes are at one point: there is no way to go.
        if pair[1].step > 0.0 && !(is_solved && now.qp_solves > before.qp_solves) {
            fault(format!("increment {index}: no program was solved"));
        }
        let is_counted = now.mpec_fallbacks > before.mpec_fallbacks;
        if now.mode_named_by_mpec == Some(false) && !is_counted {
            fault(format!("increment {index}: a fall-back that is not counted"));
        }
    }
    faults
}

/// Every way of a request's path beside `auto`; the increments that no program found, and those in all.
fn compare(name: &str, request: &JobRequest, faulty: &mut Vec<String>) -> [u64; 2] {
    let auto = judged(&by(request, Method::Auto, None));
    let mut counted = [0, 0];
    for (way, request) in [("certificate used", using(request)), ("certificate skipped", skipping(request))] {
        let traced = judged(&request);
        let mut found: Vec<String> = differs(&auto.increments, &traced.increments).into_iter().collect();
        let broken = traced.errors.iter().zip(&traced.increments).find(|(errors, _)| errors.largest_of_state() > STATE);
        if let Some((errors, increment)) = broken {
            found.push(format!("increment {} breaks the laws: {errors:?}", increment.index));
        }
        if request.analysis.skips_certificate() {
            found.extend(faults(&traced.increments, &traced.report));
            counted = [traced.report.mpec_fallbacks, traced.report.increments];
            println!(
                "{name}: {} increments, {} programs, {} quadratic programs, {} not found; {:.3} s, `auto` {:.3} s",
                traced.report.increments,
                traced.report.mpec_solves,
                traced.report.qp_solves,
                traced.report.mpec_fallbacks,
                traced.report.elapsed_s,
                auto.report.elapsed_s
            );
        }
        faulty.extend(found.first().map(|first| format!("{name}, {way}: {first}")));
    }
    counted
}

fn compare_random([plane, space]: [u64; 2]) {
    let (mut faulty, mut not_found, mut increments) = (Vec::new(), 0, 0);
    let scenes = (0..plane).map(|seed| (format!("scene {seed}"), random_scene(seed)));
    let scenes = scenes.chain((0..space).map(|seed| (format!("scene in space {seed}"), random_space(seed))));
    for (name, mut request) in scenes {
        request.analysis.max_increments = MOST_INCREMENTS;
        let counted = compare(&name, &request, &mut faulty);
        not_found += counted[0];
        increments += counted[1];
    }
    println!("{not_found} of {increments} increments not found by their programs");
    assert!(faulty.is_empty(), "{}:\n{}", faulty.len(), faulty.join("\n"));
    assert!(increments > 0 && 100 * not_found <= increments, "{not_found} of {increments} increments");
}

/// The chain of the capstan takes longer than all the others together: its programs are large and ill-conditioned.
const LONG: &str = "capstan";

fn compare_built_in(most_increments: u64, with_long: bool) {
    let (mut faulty, mut not_found, mut all) = (Vec::new(), 0, 0);
    for built_in in arcslip::check::scenes::ALL {
        let mut request = scene(built_in.name);
        request.analysis.max_increments = request.analysis.max_increments.min(most_increments);
        if request.model.contacts.is_empty() || built_in.name == LONG && !with_long {
            continue;
        }
        let [count, increments] = compare(built_in.name, &request, &mut faulty);
        not_found += count;
        all += increments;
    }
    println!("{not_found} of {all} increments not found by their programs");
    assert!(faulty.is_empty(), "{}", faulty.join("\n"));
    // They are the capstan's: its chain is so stiff beside what it slides that the program tells little of its end.
    assert!(25 * not_found <= all, "{not_found} of {all} increments");
}

#[test]
fn built_in_scenes_by_their_programs_alone() {
    compare_built_in(MOST_INCREMENTS, false);
}

/// To their ends.
#[test]
#[ignore = "minutes"]
fn whole_built_in_scenes_by_their_programs_alone() {
    compare_built_in(u64::MAX, true);
}

#[test]
fn random_scenes_by_their_programs_alone() {
    compare_random(SOME);
}

/// Two hundred of them.
#[test]
#[ignore = "minutes"]
fn many_random_scenes_by_their_programs_alone() {
    compare_random(ALL);
}

/// A certificate is no program solved, the plan names the saving, and `keep_all` does without.
#[test]
fn certificates_are_a_saving_with_a_name() {
    let names_it =
        |plan: &arcslip::result::plan::Plan| plan.left_out.iter().any(|one| one.what.contains("certificate shows"));
    let request = scene("one-bar-truss");
    let used = judged(&using(&request));
    assert!(names_it(&used.plan));
    assert_eq!(
        (used.report.mpec_solves, used.report.qp_solves, used.report.certificates),
        (0, 0, used.report.increments)
    );
    let mut kept = using(&request);
    kept.analysis.keep_all = true;
    for request in [skipping(&request), kept] {
        let skipped = judged(&request);
        assert!(!names_it(&skipped.plan));
        assert_eq!(skipped.report.certificates, 0);
        assert_eq!(skipped.report.mpec_solves, skipped.report.increments);
        // ε = 1e-2, ..., 1e-8: more than one quadratic program each.
        assert!(skipped.report.qp_solves > 8 * skipped.report.increments);
        let last = skipped.increments.last().and_then(|increment| increment.diagnostics.last_relaxation);
        assert_eq!(last, Some(1e-8));
    }
}

#[test]
fn the_setting_is_of_the_method_alone() {
    let model = serde_json::to_value(&scene("klarbring").model).expect("JSON");
    let with = |analysis: serde_json::Value| {
        serde_json::to_vec(&serde_json::json!({"model": model, "analysis": analysis})).expect("JSON")
    };
    let text = with(serde_json::json!({"method": "mpec", "mpec": {"certificate": "skip"}}));
    let asked = request(std::str::from_utf8(&text).expect("text"));
    assert!(asked.analysis.skips_certificate());
    let errors = [
        serde_json::json!({"mpec": {"certificate": "skip"}}),
        serde_json::json!({"method": "mpec", "mpec": {"certificate": "never"}}),
    ];
    for analysis in errors {
        let outcome = arcslip::model::decode::decode(&with(analysis)).map(|request| {
            arcslip::continuation::scene::Scene::new(&request).map(drop).map_err(|errors| errors.to_string())
        });
        assert!(!matches!(outcome, Ok(Ok(()))));
    }
}
