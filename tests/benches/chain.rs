//! The chain of n sliders to its end, by size: every block's first slip at its exact load, every block at its exact place,
//! and how time and memory grow with n. Beside the time of the pull stands that of the start, where the directions of all
//! blocks that touch without reaction are searched. Times are the processor's, of short paths the mean of several.
//!
//! `cargo bench --bench chain` (100, 316 and 1,000 blocks), `cargo bench --bench chain -- 10000` (others)

mod processor_time;
mod resident;

use arcslip::check::scenes::of_any_size::slider_chain;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Record, RecordedContacts};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind};
use processor_time::Stopwatch;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const FRICTION: f64 = 0.3;
const WEIGHT: f64 = 1.0;
const STIFFNESS: f64 = 1.0;
/// Loads, and displacements over the largest one, may be off their exact values by this.
const BAR: f64 = 1e-9;

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![100, 316, 1_000] } else { asked };
    println!(
        "{:>6} {:>11} {:>7} {:>9} {:>10} {:>11} {:>10} {:>10} {:>9} {:>12} {:>13} {:>10}  end",
        "blocks",
        "increments",
        "events",
        "start s",
        "pull s",
        "ms/event",
        "exponent",
        "from first",
        "LU/event",
        "load error",
        "place error",
        "peak MB"
    );
    // Sizes with their times.
    let mut first: Option<(usize, f64)> = None;
    let mut before = first;
    for size in sizes {
        let traced = timed(size).unwrap_or_else(|reason| panic!("{size} blocks: {reason}"));
        let exponent_from = |other: Option<(usize, f64)>| {
            other.map_or(String::new(), |(smaller, time)| {
                format!("{:.2}", (traced.pull_s / time).ln() / (size as f64 / smaller as f64).ln())
            })
        };
        let (exponent, from_first) = (exponent_from(before), exponent_from(first));
        before = Some((size, traced.pull_s));
        first = first.or(before);
        println!(
            "{:>6} {:>11} {:>7} {:>9.3} {:>10.4} {:>11.4} {:>10} {:>10} {:>9.1} {:>12.1e} {:>13.1e} {:>10.1}  {}",
            size,
            traced.increments,
            traced.events,
            traced.start_s,
            traced.pull_s,
            traced.pull_s / traced.events.max(1) as f64 * 1e3,
            exponent,
            from_first,
            traced.factorisations as f64 / traced.events.max(1) as f64,
            traced.load_error,
            traced.place_error,
            resident::most().unwrap_or(f64::NAN),
            traced.end
        );
        assert_eq!(traced.events, size, "one event a block");
        assert!(traced.load_error <= BAR && traced.place_error <= BAR, "{size} blocks are off their exact path");
    }
}

struct Traced {
    increments: u64,
    events: usize,
    start_s: f64,
    pull_s: f64,
    factorisations: u64,
    /// Largest, of any event, over its load.
    load_error: f64,
    /// Largest of any block at any event, over the first block's displacement.
    place_error: f64,
    end: String,
}

/// Time of the pull (s) that is measured at the least: the processor's clock is coarse.
const MEASURED: f64 = 1.0;

/// As often as it takes to measure it, with the mean of the times.
fn timed(size: usize) -> Result<Traced, String> {
    let mut first = trace(size)?;
    let (mut times, mut pull_s, mut start_s) = (1, first.pull_s, first.start_s);
    while pull_s < MEASURED {
        let again = trace(size)?;
        (times, pull_s, start_s) = (times + 1, pull_s + again.pull_s, start_s + again.start_s);
    }
    (first.pull_s, first.start_s) = (pull_s / f64::from(times), start_s / f64::from(times));
    Ok(first)
}

fn trace(size: usize) -> Result<Traced, String> {
    let document = slider_chain(size, FRICTION, WEIGHT, STIFFNESS);
    let mut request: JobRequest = serde_json::from_value(document).map_err(|error| error.to_string())?;
    request.analysis.max_increments = 10 * size as u64 + 100;
    // Rows of all contacts at all events would be read by nobody.
    request.analysis.record =
        Some(Record { contacts: Some(RecordedContacts::Named(Vec::new())), directions: false, ..Record::default() });
    let scene = Scene::new(&request).map_err(|errors| errors.to_string())?;
    let mut path = Path::new(&scene, CancelFlag::default());
    let watch = Stopwatch::start();
    let (mut increments, mut events, mut start_s) = (0, 0, 0.0);
    let (mut load_error, mut place_error) = (0.0_f64, 0.0_f64);
    for increment in path.by_ref() {
        increments += 1;
        if &*increment.stage != "pull" {
            start_s = watch.seconds();
            continue;
        }
        if matches!(increment.point.kind, PointKind::ContactChange | PointKind::End) {
            events += 1;
            let exact = events as f64 * FRICTION * WEIGHT;
            load_error = load_error.max((increment.load_factor / exact - 1.0).abs());
            place_error = place_error.max(error_of_places(&increment, events));
        }
    }
    let pull_s = watch.seconds() - start_s;
    let report = path.report().ok_or("a path without a report")?;
    let (factorisations, end) = (report.factorisations, format!("{:?}", report.stop_reason));
    Ok(Traced { increments, events, start_s, pull_s, factorisations, load_error, place_error, end })
}

/// When block `m = events - 1` begins to slip, spring `j` carries what blocks `j + 1` to `m` hold back less the last:
/// `k (u_j - u_{j+1}) = (m - j) μ W`.
fn error_of_places(increment: &Increment, events: usize) -> f64 {
    let mut exact = (events * (events - 1) / 2) as f64 * FRICTION * WEIGHT / STIFFNESS;
    let largest = exact.max(FRICTION * WEIGHT / STIFFNESS);
    let mut error = 0.0_f64;
    for (block, place) in increment.displacements.values().enumerate() {
        error = error.max((place[0] - exact).abs() / largest);
        exact -= (events - 1).saturating_sub(block) as f64 * FRICTION * WEIGHT / STIFFNESS;
    }
    error
}
