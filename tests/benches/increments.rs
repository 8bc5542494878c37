//! Time per increment by both methods: the median of several whole paths, with its spread.
//!
//! `cargo bench --bench increments`

use arcslip::cancel::CancelFlag;
use arcslip::model::request::Method;
use arcslip::path::{Path, Scene};
use std::time::Instant;

/// Whole paths traced; the median is printed.
const REPEATS: usize = 41;

fn main() {
    println!(
        "{:<22} {:<6} {:>10} {:>12} {:>12} {:>12} {:>8} {:>8}",
        "scene", "method", "increments", "median us", "least us", "largest us", "LU/inc", "QP/inc"
    );
    for name in ["one-bar-truss", "one-bar-truss-rough", "klarbring", "arch-type-truss", "three-snapping-bars"] {
        let Some(built_in) = arcslip::scenes::find(name) else { continue };
        let mut medians = Vec::new();
        for method in [Method::Auto, Method::Mpec] {
            let mut request = match arcslip::model::decode::decode(built_in.request.as_bytes()) {
                Ok(request) => request,
                Err(errors) => panic!("{errors}"),
            };
            request.analysis.method = method;
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
            let each = |count: u64| count as f64 / report.increments as f64;
            println!(
                "{:<22} {:<6} {:>10} {:>12.2} {:>12.2} {:>12.2} {:>8.1} {:>8.1}",
                name,
                format!("{method:?}").to_lowercase(),
                report.increments,
                times[REPEATS / 2],
                times[0],
                times[REPEATS - 1],
                each(report.factorisations),
                each(report.qp_solves)
            );
            medians.push(times[REPEATS / 2]);
        }
        if let [auto, mpec] = medians[..] {
            println!("{:<22} mpec/auto {:.1}", name, mpec / auto);
        }
    }
}
