//! Random small pairs of bodies.

use super::{Sheet, count_within_the_measure, moved, pair, support};
use crate::common::paths::{judged, request};
use crate::common::random::Numbers;
use arcslip::JobRequest;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::request::Method;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::Increment;
use serde_json::json;

/// Two small bodies in the plane, all in turned axes.
fn random_pair(seed: u64, angle: f64) -> JobRequest {
    posted_pair(seed, angle, None)
}

/// Two small bodies of revolution.
pub fn revolved_pair(seed: u64) -> JobRequest {
    posted_pair(seed, 0.0, Some(0.4))
}

/// Two small bodies with an interface that leans and bulges a little, pressed and pushed, all in turned axes; or bodies of
/// revolution this far from the axis.
fn posted_pair(seed: u64, angle: f64, from_axis: Option<f64>) -> JobRequest {
    let mut numbers = Numbers(seed);
    let (slope, bulge) = (numbers.between(-0.2, 0.2), numbers.between(-0.02, 0.05));
    let cells = [1 + numbers.below(3), 1 + numbers.below(3)];
    let shift = numbers.between(-0.15, 0.15);
    let gap = if numbers.chance(0.5) { 0.0 } else { numbers.between(0.0, 0.1) };
    let (sine, cosine) = angle.sin_cos();
    let turned = move |[x, y]: [f64; 2]| [cosine * x - sine * y, sine * x + cosine * y];
    // The lower body is flat, so that no mesh overlaps the other.
    let below = move |x: f64| 1.0 + slope * x;
    let above = move |x: f64| below(x) + gap + bulge.max(0.0) * (2.0 * x - 1.0) * (2.0 * x - 1.0);
    let placed = move |place: [f64; 2]| {
        let [x, y] = turned(place);
        [x + from_axis.unwrap_or(0.0), y]
    };
    let lower = Sheet::new("l", [cells[0], 1], move |x, y| placed([1.4 * x - 0.2, y * below(1.4 * x - 0.2)]));
    let upper = Sheet::new("u", [cells[1], 1], move |x, y| {
        let x = x + shift;
        placed([x, above(x) + y * (2.2 - above(x))])
    });
    let kind = ["linear_elastic", "neo_hookean"][numbers.below(2)];
    let material = json!({"kind": kind, "young": 10, "poisson": numbers.between(0.0, 0.45)});
    let mut model = pair(&lower, &upper, &material, numbers.friction().min(1.0), numbers.chance(0.5));
    if numbers.chance(0.3) {
        model["contacts"][0]["discretisation"] = json!("node_to_surface");
    }
    if from_axis.is_some() {
        for element in model["elements"].as_array_mut().expect("elements") {
            element["plane"] = json!("axisymmetric");
        }
    }
    support(&mut model, &lower.lowest(), &["x", "y"]);
    support(&mut model, &upper.highest(), &["x", "y"]);
    let push = turned([numbers.between(-0.3, 0.3), numbers.between(-0.1, 0.02)]);
    model["stages"] = json!([
        {"name": "press", "displacements": moved(&upper.highest(), turned([0.0, -0.2])), "until": {"load_above": 1}},
        {"name": "push", "displacements": moved(&upper.highest(), push), "until": {"load_above": 1}},
    ]);
    let posted = json!({
        "model": model,
        "analysis": {
            "max_increments": 120, "arc_length": {"displacement_scale": 1, "initial": 0.05},
        },
    });
    request(&posted.to_string())
}

fn traced(request: &JobRequest) -> Vec<Increment> {
    let scene = Scene::new(request).expect("a scene");
    Path::new(&scene, CancelFlag::default()).collect()
}

fn events(increments: &[Increment]) -> Vec<(f64, String)> {
    let of = |increment: &Increment| Some((increment.load_factor, increment.point.event.clone()?));
    increments.iter().filter_map(of).collect()
}

fn same_events(one: &[Increment], other: &[Increment], what: &str) {
    let (one, other) = (events(one), events(other));
    assert_eq!(one.len(), other.len(), "{what}: {one:?} {other:?}");
    for ((load, words), (other_load, other_words)) in one.iter().zip(&other) {
        assert!((load - other_load).abs() <= 1e-7, "{what}: {load} {other_load} {words}");
        assert_eq!(words, other_words, "{what}");
    }
}

/// 100 pairs: the measure, the energy, and the same events in turned axes.
#[test]
fn random_pairs_keep_the_laws() {
    let mut statuses = [0; 3];
    for seed in 0..100 {
        let posted = random_pair(seed, 0.0);
        let traced_and_judged = judged(&posted);
        count_within_the_measure(&traced_and_judged, 1e-6, seed, &mut statuses);
        same_events(&traced_and_judged.increments, &traced(&random_pair(seed, 0.7)), &format!("seed {seed}, turned"));
    }
    assert!(statuses.iter().all(|count| *count > 500), "{statuses:?}");
}

/// The programs alone find the same events.
#[test]
fn programs_find_the_same_events_of_pairs() {
    for seed in 0..10 {
        let auto = random_pair(seed, 0.0);
        let mut by_program = auto.clone();
        by_program.analysis.method = Method::Mpec;
        same_events(&traced(&auto), &traced(&by_program), &format!("seed {seed}"));
    }
}
