//! Time per increment by both methods: the median of several whole paths, with its spread; and what the measure takes to
//! judge one, with its share in the two together.
//!
//! `cargo bench --bench increments`

use arcslip::check::measure::Judge;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Certificate, Method, Mpec};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::Increment;
use std::time::Instant;

/// Whole paths traced; the median is printed.
const REPEATS: usize = 41;
/// With the certificate, and by the programs alone.
const WAYS: [(&str, Method, Option<Certificate>); 3] = [
    ("auto", Method::Auto, None),
    ("mpec", Method::Mpec, Some(Certificate::Use)),
    ("mpec, skip", Method::Mpec, Some(Certificate::Skip)),
];

fn main() {
    println!(
        "{:<22} {:<10} {:>10} {:>12} {:>12} {:>12} {:>8} {:>8} {:>9} {:>7}",
        "scene", "method", "increments", "median us", "least us", "largest us", "LU/inc", "QP/inc", "judge us", "share"
    );
    for name in ["one-bar-truss", "one-bar-truss-rough", "klarbring", "arch-type-truss", "three-snapping-bars"] {
        let Some(built_in) = arcslip::check::scenes::find(name) else { continue };
        let mut medians = Vec::new();
        for (way, method, certificate) in WAYS {
            let mut request = match arcslip::model::decode::decode(built_in.request.as_bytes()) {
                Ok(request) => request,
                Err(errors) => panic!("{errors}"),
            };
            request.analysis.method = method;
            request.analysis.mpec = certificate.map(|certificate| Mpec { certificate });
            let scene = match Scene::new(&request) {
                Ok(scene) => scene,
                Err(errors) => panic!("{errors}"),
            };
            let mut times = Vec::with_capacity(REPEATS);
            let mut last = None;
            for _ in 0..REPEATS {
                let mut path = Path::new(&scene, CancelFlag::default());
                let began = Instant::now();
                let increments = path.by_ref().count();
                let elapsed = began.elapsed().as_secs_f64();
                times.push(elapsed / increments as f64 * 1e6);
                last = path.report();
            }
            times.sort_by(f64::total_cmp);
            let Some(report) = last else { continue };
            let judging = judging(&request, &scene);
            let share = 100.0 * judging / (judging + times[REPEATS / 2]);
            let each = |count: u64| count as f64 / report.increments as f64;
            println!(
                "{:<22} {:<10} {:>10} {:>12.2} {:>12.2} {:>12.2} {:>8.1} {:>8.1} {:>9.3} {:>5.1} %",
                name,
                way,
                report.increments,
                times[REPEATS / 2],
                times[0],
                times[REPEATS - 1],
                each(report.factorisations),
                each(report.qp_solves),
                judging,
                share
            );
            medians.push(times[REPEATS / 2]);
        }
        if let [auto, mpec, skip] = medians[..] {
            println!("{:<22} mpec/auto {:.1}, certificates skipped {:.0}", name, mpec / auto, skip / auto);
        }
    }
}

/// Microseconds that the measure takes for an increment: the median of whole paths.
fn judging(request: &JobRequest, scene: &Scene) -> f64 {
    let increments: Vec<Increment> = Path::new(scene, CancelFlag::default()).collect();
    let fresh = Judge::new(request, scene.plan().displacement_scale, &scene.plan().load_scales);
    let mut times: Vec<f64> = (0..REPEATS)
        .map(|_| {
            let mut judge = fresh.clone();
            let began = Instant::now();
            for increment in &increments {
                std::hint::black_box(judge.judge(increment));
            }
            began.elapsed().as_secs_f64() / increments.len() as f64 * 1e6
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[REPEATS / 2]
}
