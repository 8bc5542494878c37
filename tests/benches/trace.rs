//! One path of a scene and nothing else, for a profiler: the increments, and the time where that says something.
//!
//! `cargo bench --no-default-features --bench trace -- row 100`; the manual's chapter on performance has the commands for
//! callgrind. `-- row 1 2000` takes the path 2000 times and says the median and the least time.

use arcslip::check::scenes::lattice::LatticeArch;
use arcslip::check::scenes::of_any_size::row_of_bars;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::resources::cancel::CancelFlag;
use std::time::Instant;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let size = words.get(1).and_then(|size| size.parse().ok());
    let asked = match (words.first().map(String::as_str), size) {
        (Some("row"), Some(size)) => serde_json::from_value(row_of_bars(size)).map_err(|error| error.to_string()),
        (Some("lattice"), Some(size)) => lattice(size),
        _ => Err("say which: `row 100` (bars) or `lattice 1000` (unknowns)".to_owned()),
    };
    let paths = words.get(2).and_then(|paths| paths.parse().ok()).unwrap_or(1);
    let traced = asked.and_then(|request| trace(&request, paths));
    println!("{}", traced.unwrap_or_else(|why| why));
}

/// An arch that snaps onto a floor, with friction, to its hundredth increment.
fn lattice(unknowns: usize) -> Result<JobRequest, String> {
    let arch = LatticeArch { increments: 100, friction: 0.3, ..LatticeArch::of_unknowns(unknowns) };
    arch.landing(unknowns / 45).request().map_err(|error| error.to_string())
}

fn trace(request: &JobRequest, paths: usize) -> Result<String, String> {
    let scene = Scene::new(request).map_err(|errors| errors.to_string())?;
    let mut times = Vec::new();
    let mut increments = 0;
    for _ in 0..paths.max(1) {
        let began = Instant::now();
        increments = Path::new(&scene, CancelFlag::default()).count();
        times.push(began.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    Ok(format!("{increments} increments in {:.4} ms, at the least {:.4}", times[times.len() / 2], times[0]))
}
