//! A curve of limit points beside paths traced at as many values, each up to the limit point, one thread each: time, the
//! median of several taken in turn, and how far the points are apart.
//!
//! `cargo bench --bench curves`

#[allow(dead_code)]
#[path = "../common/paths.rs"]
mod paths;
#[path = "../common/round_arch.rs"]
mod round_arch;

use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::{JobRequest, ParameterCurve};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::PointKind;
use arcslip::studies::critical_curves::{self, CurveRow};
use paths::scene_file;
use round_arch::round_arch;
use serde_json::json;
use std::ops::ControlFlow;
use std::time::Instant;

/// Times that each is measured; the median is printed.
const REPEATS: usize = 5;

fn main() {
    println!(
        "{:<26} {:>9} {:>7} {:>10} {:>10} {:>7} {:>10}",
        "curve", "unknowns", "points", "curve ms", "paths ms", "ratio", "apart"
    );
    let all = "/model/contacts/*/friction";
    compare("arch-type-truss", &scene_file("arch-type-truss"), all, [0.0, 2.0], 0.1);
    compare("one-bar-truss", &scene_file("one-bar-truss"), all, [0.1, 0.6], 0.025);
    compare("arch on a rough floor", &round_arch(0.8), all, [0.65, 1.3], 0.05);
}

fn compare(name: &str, request: &JobRequest, parameter: &str, range: [f64; 2], step: f64) {
    let mut document = serde_json::to_value(request).expect("JSON");
    document["curve"] = json!({"parameter": parameter, "range": range, "step": step});
    let curve = ParameterCurve::read(document.to_string().as_bytes()).unwrap_or_else(|errors| panic!("{errors}"));
    let (mut by_curve, mut by_paths) = (Vec::new(), Vec::new());
    let (mut rows, mut apart) = (Vec::new(), 0.0_f64);
    for _ in 0..REPEATS {
        let began = Instant::now();
        rows = followed(&curve);
        by_curve.push(began.elapsed().as_secs_f64());
        let began = Instant::now();
        let loads: Vec<f64> = rows.iter().map(|row| limit_load(&curve, row)).collect();
        by_paths.push(began.elapsed().as_secs_f64());
        let off = rows.iter().zip(loads).filter(|(row, _)| !row.codimension_two);
        apart = off.map(|(row, load)| (row.load_factor - load).abs() / row.load_factor.abs()).fold(0.0, f64::max);
    }
    let unknowns = Scene::new(request).unwrap_or_else(|errors| panic!("{errors}")).plan().unknowns;
    let [curve, paths] = [by_curve, by_paths].map(median);
    println!(
        "{name:<26} {unknowns:>9} {:>7} {:>10.1} {:>10.1} {:>7.1} {apart:>10.1e}",
        rows.len(),
        curve * 1e3,
        paths * 1e3,
        paths / curve
    );
}

fn followed(curve: &ParameterCurve) -> Vec<CurveRow> {
    let mut rows = Vec::new();
    let mut accept = |row| {
        rows.push(row);
        ControlFlow::Continue(())
    };
    critical_curves::run(curve, &CancelFlag::default(), &mut accept).unwrap_or_else(|errors| panic!("{errors}"));
    rows
}

/// The load at the first limit point of a path at the value of a point.
fn limit_load(curve: &ParameterCurve, row: &CurveRow) -> f64 {
    let request = curve.request(row.value).unwrap_or_else(|errors| panic!("{errors}"));
    let scene = Scene::new(&request).unwrap_or_else(|errors| panic!("{errors}"));
    let is_limit = |kind: PointKind| matches!(kind, PointKind::SmoothLimit | PointKind::NonsmoothLimit);
    let limit = Path::new(&scene, CancelFlag::default()).find(|increment| is_limit(increment.point.kind));
    limit.map_or(f64::NAN, |increment| increment.load_factor)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
