//! The regularised method: right in the limit of stiff penalties and short steps, and no nearer than that.

use crate::common::paths::{judge, request, scene, scene_file};
use arcslip::continuation::method_dispatch::TracedPath;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{LoadSign, Method, Regularised};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::report::Report;
use arcslip::result::stop_reason::StopReason;
use serde_json::json;

fn trace(request: &JobRequest) -> (Vec<Increment>, Report) {
    let scene = Scene::new(request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut path = TracedPath::new(&scene, CancelFlag::default());
    let increments: Vec<Increment> = path.by_ref().collect();
    (increments, path.report().expect("an ended path has a report"))
}

/// The scene by the rival, with one penalty for both directions and steps up to a length.
fn regularised(mut request: JobRequest, penalty: f64, step: f64) -> JobRequest {
    request.analysis.method = Method::Regularised;
    request.analysis.arc_length.max = step;
    request.analysis.arc_length.initial = step;
    request.analysis.regularised = Some(Regularised {
        normal_penalty: penalty,
        tangential_penalty: penalty,
        tolerance: 1e-10,
        ..Regularised::default()
    });
    request
}

/// The slipping branch of the one-bar truss (see `exact_scenes`).
fn one_bar_load(friction: f64, x: f64) -> f64 {
    let (length, rest) = (x.hypot(1.0), 1.5_f64.hypot(1.0));
    (1.0 - length / rest) * (friction - x) / length
}

/// The largest error of the load along the slipping branch of the one-bar truss, up to the mechanism.
fn load_error(friction: f64, increments: &[Increment]) -> f64 {
    let place = |increment: &Increment| increment.displacements["tip"][0] - 1.5;
    let on_branch = increments[1..].iter().filter(|increment| place(increment) < 1.45);
    on_branch
        .map(|increment| (increment.load_factor - one_bar_load(friction, place(increment))).abs())
        .fold(0.0, f64::max)
}

#[test]
fn the_load_error_is_of_first_order_in_the_inverse_penalty() {
    for friction in [0.0, 0.3, 1.0] {
        let errors = [1e3, 1e4, 1e5].map(|penalty| {
            let mut request = regularised(scene("one-bar-truss"), penalty, 0.02);
            request.model.contacts[0].friction = friction;
            let (increments, _) = trace(&request);
            assert!(increments.len() > 50);
            load_error(friction, &increments)
        });
        println!("friction {friction}: {errors:?}");
        for pair in errors.windows(2) {
            assert!((8.0..12.5).contains(&(pair[0] / pair[1])), "friction {friction}: {errors:?}");
        }
    }
}

#[test]
fn on_the_one_bar_truss_the_error_exceeds_that_of_auto_by_orders() {
    for (name, friction) in [("one-bar-truss", 0.3), ("one-bar-truss-rough", 1.0)] {
        let (by_auto, _) = trace(&scene(name));
        assert!(load_error(friction, &by_auto) <= 1e-10);
        let (by_rival, report) = trace(&regularised(scene(name), 1e4, 0.02));
        assert!(load_error(friction, &by_rival) >= 1e-6);
        // It passes the mechanism and finds it only from within, off the floor.
        assert_eq!(report.stop_reason, StopReason::Mechanism);
        let last = by_rival.last().expect("an end");
        assert_eq!(last.contacts[0].status, Status::Free);
        assert!(last.contacts[0].gap > 1e-4 && last.displacements["tip"][0] > 3.0);
        // Both limit points are passed, neither is a point of its path.
        let limits: Vec<&Increment> = by_rival.iter().filter(|i| i.point.kind == PointKind::SmoothLimit).collect();
        let exact = by_auto.iter().filter(|increment| increment.point.kind == PointKind::SmoothLimit);
        assert_eq!(limits.len(), 2);
        for (limit, exact) in limits.iter().zip(exact) {
            let apart = (limit.displacements["tip"][0] - exact.displacements["tip"][0]).abs();
            assert!((1e-5..0.04).contains(&apart), "{name}: {apart}");
        }
        assert!(by_rival.iter().all(|increment| increment.directions.is_none() && !increment.point.bifurcation));
    }
}

/// Judged by the measure that stands apart from the solver: equilibrium and cone hold, penetration is what the penalty
/// says, shown as it is.
#[test]
fn equilibrium_and_the_cone_hold_at_every_point_of_every_scene() {
    let files = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/src/check/scenes")).expect("the scenes");
    let mut names: Vec<String> =
        files.filter_map(|file| Some(file.ok()?.file_name().to_str()?.strip_suffix(".json")?.to_owned())).collect();
    names.sort();
    assert!(names.len() >= arcslip::check::scenes::ALL.len());
    for name in &names {
        for sign in [LoadSign::Determinant, LoadSign::PreviousIncrement] {
            for load_weight in [0.0, 1.0] {
                let mut request = regularised(scene_file(name), 1e4, 0.05);
                let parameters = request.analysis.regularised.as_mut().expect("parameters");
                (parameters.load_sign, parameters.load_weight) = (sign, load_weight);
                request.analysis.max_increments = 400;
                let scene = Scene::new(&request).expect("a scene");
                let plan = scene.plan();
                let stiffness = 1e4 * plan.force_scale / plan.displacement_scale;
                let (increments, report) = trace(&request);
                let mut judge = judge(&request, plan);
                assert!(increments.len() > 1, "{name}: {report:?}");
                for increment in &increments {
                    let errors = judge.judge(increment);
                    let place = format!("{name}, increment {}: {errors:?}", increment.index);
                    assert!(errors.equilibrium <= 2e-10 && errors.cone <= 1e-12, "{place}");
                    assert!(errors.strain_energy <= 1e-10, "{place}");
                    for contact in &increment.contacts {
                        assert_eq!(contact.status == Status::Free, contact.gap > 0.0, "{place}");
                        if name == "doubled-floor" {
                            // Coincident contacts share one reaction.
                            continue;
                        }
                        let penetration = (-contact.gap).max(0.0);
                        assert!(
                            (contact.normal_reaction - stiffness * penetration).abs() <= 1e-12 * stiffness,
                            "{place}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn without_contact_it_finds_the_path_of_the_others() {
    let (increments, report) = trace(&regularised(scene("von-mises-truss"), 1e4, 0.02));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let (by_auto, _) = trace(&scene("von-mises-truss"));
    let highest = |path: &[Increment]| path.iter().map(|increment| increment.load_factor).fold(0.0, f64::max);
    let (rival, auto) = (highest(&increments), highest(&by_auto));
    // A maximum that is stepped over is off by the square of the step.
    assert!(rival <= auto * (1.0 + 1e-12) && rival > 0.99 * auto, "{rival} {auto}");
    assert_eq!(increments.last().map(|i| i.displacements["apex"][1]), Some(-1.2), "the stage ends exactly there");
}

/// Klarbring's node and the arch: through nonsmooth limit points, stages ending at exactly the loads asked for.
#[test]
fn stages_end_exactly_and_nonsmooth_limits_are_passed() {
    let (increments, report) = trace(&regularised(scene("klarbring"), 1e4, 0.02));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let held = increments.iter().rfind(|increment| &*increment.stage == "press").expect("a first stage");
    assert_eq!((held.load_factor, held.point.kind), (1.0, PointKind::End));
    let last = increments.last().expect("an end");
    assert_eq!(last.load_factor, 3.0);
    // u = K⁻¹ (s, -1) with K = [[1, -0.8], [-0.8, 1]]
    for (found, exact) in last.displacements["node"].iter().zip([2.2 / 0.36, 1.4 / 0.36]) {
        assert!((found - exact).abs() < 1e-9);
    }
    let lowest = increments.iter().filter(|i| &*i.stage == "pull").skip(1).map(|i| i.load_factor).fold(9.0, f64::min);
    assert!(lowest > 1.25 && lowest < 1.27, "{lowest}");
    let (increments, report) = trace(&regularised(scene("arch-type-truss"), 1e4, 0.02));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    assert_eq!(increments.last().map(|increment| increment.load_factor), Some(0.02));
}

#[test]
fn stages_end_by_counts() {
    for (until, kind) in [
        (json!({"limit_points": 1}), PointKind::SmoothLimit),
        (json!({"contact_change": 1}), PointKind::ContactChange),
        (json!({"increments": 7}), PointKind::End),
    ] {
        let mut model: serde_json::Value =
            serde_json::from_str(arcslip::check::scenes::find("one-bar-truss").expect("a scene").request)
                .expect("JSON");
        model["model"]["stages"][0]["until"] = until;
        let (increments, report) = trace(&regularised(request(&model.to_string()), 1e4, 0.05));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        assert_eq!(increments.last().map(|increment| increment.point.kind), Some(kind));
    }
}

/// Penalties are dimensionless: a change of units changes nothing but round-off. The first predictor, from a contact
/// held by its penalty alone, has a load of a hundred times the true one: its round-off is that much larger.
#[test]
fn units_do_not_matter() {
    let (reference, _) = trace(&regularised(scene("one-bar-truss"), 1e4, 0.05));
    let mut model: serde_json::Value =
        serde_json::from_str(arcslip::check::scenes::find("one-bar-truss").expect("a scene").request).expect("JSON");
    model["model"]["nodes"] = json!({"pin": [0, 1000], "tip": [-1500, 0]});
    model["model"]["elements"][0]["axial_stiffness"] = json!(1e6);
    model["model"]["stages"][0]["forces"]["tip"] = json!([1e6, 0]);
    let (scaled, _) = trace(&regularised(request(&model.to_string()), 1e4, 0.05));
    assert_eq!(reference.len(), scaled.len());
    // In the mechanism, at the end, places are undetermined.
    for (a, b) in reference.iter().zip(&scaled).filter(|(a, _)| a.contacts[0].status != Status::Free) {
        assert!((a.load_factor - b.load_factor).abs() < 1e-8);
        let apart = (a.displacements["tip"][0] - 1e-3 * b.displacements["tip"][0]).abs();
        assert!(apart < 1e-7, "increment {}: {apart:e}", a.index);
    }
}

#[test]
fn the_same_request_gives_the_same_bits_and_a_flag_stops_it() {
    let request = regularised(scene("three-snapping-bars"), 1e4, 0.05);
    let bits = |increments: Vec<Increment>| -> Vec<u64> {
        let values = increments.iter().flat_map(|i| i.displacements.values().flatten().chain([&i.load_factor]));
        values.map(|value| value.to_bits()).collect()
    };
    assert_eq!(bits(trace(&request).0), bits(trace(&request).0));
    let scene = Scene::new(&request).expect("a scene");
    let cancel = CancelFlag::default();
    let mut path = TracedPath::new(&scene, cancel.clone());
    assert!(path.nth(5).is_some());
    cancel.cancel();
    assert!(path.next().is_none());
    assert_eq!(path.report().map(|report| report.stop_reason), Some(StopReason::Cancelled));
}

/// Penalties out of all proportion: steps fail or the path is wrong, but it ends, with finite numbers.
#[test]
fn absurd_parameters_end_with_a_reason() {
    for (penalty, tolerance, desired_iterations) in
        [(1e-12, 1e-10, 5), (1e30, 1e-10, 5), (1e60, 1e-70, 1), (1e4, 0.9, 1), (1e4, 1e-70, 3)]
    {
        for name in ["one-bar-truss", "klarbring", "arch-type-truss"] {
            let mut request = regularised(scene(name), penalty, 0.1);
            let parameters = request.analysis.regularised.as_mut().expect("parameters");
            (parameters.tolerance, parameters.desired_iterations) = (tolerance, desired_iterations);
            request.analysis.max_increments = 300;
            let (increments, report) = trace(&request);
            println!("{name} {penalty:e}: {} {:?}", increments.len(), report.stop_reason);
            assert!(!increments.is_empty());
            for increment in increments {
                assert!(increment.load_factor.is_finite());
                assert!(increment.displacements.values().flatten().all(|value| value.is_finite()));
            }
        }
    }
}
