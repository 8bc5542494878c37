//! The regularised method beside `auto`: errors, work and time of both, as a table.
//!
//! `cargo bench --bench rivals`

use arcslip::continuation::method_dispatch::TracedPath;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Method, Regularised};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::Increment;
use arcslip::result::report::Report;
use arcslip::result::stop_reason::StopReason;
use std::time::Instant;

/// Whole paths traced by each; the median is printed.
const REPEATS: usize = 41;

/// A path and what it took.
struct Run {
    increments: Vec<Increment>,
    report: Report,
    /// Median, in seconds.
    time: f64,
}

/// Scenes, and the friction of those with a closed form.
const SCENES: [(&str, Option<f64>); 5] = [
    ("one-bar-truss", Some(0.3)),
    ("one-bar-truss-rough", Some(1.0)),
    ("klarbring", None),
    ("arch-type-truss", None),
    ("two-snapping-bars", None),
];
/// Penalties and longest steps.
const RIVALS: [(f64, f64); 6] = [(1e2, 0.05), (1e3, 0.05), (1e4, 0.05), (1e6, 0.05), (1e8, 0.05), (1e4, 0.005)];

fn main() {
    println!("| scene | method | increments | LU | time | load error | turns | their error | last point |");
    println!("|---|---|--:|--:|--:|--:|--:|--:|---|");
    for (name, friction) in SCENES {
        let Some(built_in) = arcslip::check::scenes::find(name) else { continue };
        let request = match arcslip::model::decode::decode(built_in.request.as_bytes()) {
            Ok(request) => request,
            Err(errors) => panic!("{errors}"),
        };
        let auto = run(&request);
        print_row(name, "`auto`", &auto, &auto, friction);
        for (penalty, step) in RIVALS {
            let rival = run(&regularised(&request, penalty, step));
            print_row("", &format!("{penalty:.0e}, steps to {step}"), &rival, &auto, friction);
        }
    }
}

fn regularised(request: &JobRequest, penalty: f64, step: f64) -> JobRequest {
    let mut request = request.clone();
    request.analysis.method = Method::Regularised;
    request.analysis.max_increments = 3_000;
    request.analysis.arc_length.max = step;
    request.analysis.arc_length.initial = request.analysis.arc_length.initial.min(step);
    request.analysis.regularised =
        Some(Regularised { normal_penalty: penalty, tangential_penalty: penalty, ..Regularised::default() });
    request
}

fn run(request: &JobRequest) -> Run {
    let scene = match Scene::new(request) {
        Ok(scene) => scene,
        Err(errors) => panic!("{errors}"),
    };
    let mut times = Vec::with_capacity(REPEATS);
    let mut last = None;
    for _ in 0..REPEATS {
        let mut path = TracedPath::new(&scene, CancelFlag::default());
        let began = Instant::now();
        let increments: Vec<Increment> = path.by_ref().collect();
        times.push(began.elapsed().as_secs_f64());
        last = path.report().map(|report| (increments, report));
    }
    times.sort_by(f64::total_cmp);
    match last {
        Some((increments, report)) => Run { increments, report, time: times[REPEATS / 2] },
        None => panic!("a path without a report"),
    }
}

fn print_row(scene: &str, method: &str, run: &Run, auto: &Run, friction: Option<f64>) {
    let report = &run.report;
    let branch = friction.map_or(String::new(), |friction| format!("{:.0e}", branch_error(friction, run, auto)));
    let (found, exact) = (turns(run), turns(auto));
    let errors = found.iter().zip(&exact).map(|(found, exact)| (found - exact).abs() / largest_load(auto));
    // Counted differently, they cannot be compared one by one.
    let worst = if found.len() == exact.len() { format!("{:.0e}", errors.fold(0.0, f64::max)) } else { String::new() };
    println!(
        "| {scene} | {method} | {} | {} | {:.2} | {branch} | {} of {} | {worst} | {} |",
        report.increments,
        report.factorisations,
        run.time / auto.time,
        found.len(),
        exact.len(),
        last_point(run)
    );
}

/// The largest error of the one-bar truss' load against `s = P (μ h - x)/L`, while it is on the floor.
fn branch_error(friction: f64, run: &Run, auto: &Run) -> f64 {
    let exact = |x: f64| {
        let (length, rest) = (x.hypot(1.0), 1.5_f64.hypot(1.0));
        (1.0 - length / rest) * (friction - x) / length
    };
    let on_floor = run.increments[1..].iter().take_while(|increment| increment.contacts[0].gap <= 1e-9);
    let places = on_floor.map(|increment| (increment.displacements["tip"][0] - 1.5, increment.load_factor));
    places.map(|(x, load)| (load - exact(x)).abs()).fold(0.0, f64::max) / largest_load(auto)
}

fn largest_load(run: &Run) -> f64 {
    run.increments.iter().fold(0.0, |largest, increment| increment.load_factor.abs().max(largest))
}

/// Loads of the last stage, its start included, from which the load turns back by more than round-off.
fn turns(run: &Run) -> Vec<f64> {
    let Some(last) = run.increments.last() else { return Vec::new() };
    let of_stage = run.increments.iter().filter(|increment| increment.index > 0 && increment.stage == last.stage);
    let mut loads = vec![0.0];
    loads.extend(of_stage.map(|increment| increment.load_factor));
    let round_off = 1e-9 * largest_load(run);
    loads.dedup_by(|next, load| (*next - *load).abs() <= round_off);
    loads.windows(3).filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0).map(|w| w[1]).collect()
}

/// Why the path ended, and where: the displacement that went farthest, the load, and how far off its obstacle a node is.
fn last_point(run: &Run) -> String {
    let Some(last) = run.increments.last() else { return String::new() };
    let reason = match run.report.stop_reason {
        StopReason::StagesCompleted => "completed",
        StopReason::Mechanism => "mechanism",
        StopReason::StepUnderflow => "step underflow",
        StopReason::MaxIncrements => "goes on",
        _ => "other",
    };
    let gap = last.contacts.iter().map(|contact| contact.gap).fold(0.0, f64::max);
    let farthest = |far: f64, u: &f64| if u.abs() > far.abs() { *u } else { far };
    let place = last.displacements.values().flatten().fold(0.0, farthest);
    // A load of round-off shows no sign.
    let load = (last.load_factor * 1e4).round() / 1e4 + 0.0;
    format!("{reason}: u = {place:.4}, s = {load:.4}, gap {gap:.4}")
}
