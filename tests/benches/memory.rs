//! Memory and time of long paths: each increment is judged, written out as a line, and dropped. What is allocated at once,
//! and what the process takes, must not grow with the increments.
//!
//! `cargo bench --bench memory` (10,000 and 100,000 increments), `cargo bench --bench memory -- 1000000` (a million)

#[path = "../common/long_paths.rs"]
mod long_paths;
#[allow(dead_code)]
#[path = "../common/paths.rs"]
mod paths;
mod resident;

use allocation_counter::measure;
use arcslip::check::judged::JudgedPath;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use long_paths::one_bar_in_short_steps;
use std::io::Write;
use std::time::Instant;

fn main() {
    let asked: Vec<u64> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let lengths = if asked.is_empty() { vec![10_000, 100_000] } else { asked };
    println!(
        "{:>10} {:>10} {:>9} {:>16} {:>12} {:>12}  end",
        "increments", "written MB", "time s", "allocated kB", "resident MB", "us/increment"
    );
    for increments in lengths {
        let request = one_bar_in_short_steps(increments, 1);
        let scene = Scene::new(&request).unwrap_or_else(|errors| panic!("{errors}"));
        let (mut written, mut end, mut time) = (0, String::new(), 0.0);
        let allocated = measure(|| {
            let mut sink = std::io::sink();
            let began = Instant::now();
            let mut path = JudgedPath::new(&request, &scene, CancelFlag::default());
            for judged in path.by_ref() {
                let line = arcslip::output::json_line(&judged).unwrap_or_default();
                written += line.len() + 1;
                let _ = sink.write_all(line.as_bytes());
            }
            time = began.elapsed().as_secs_f64();
            end = path.report().map_or_else(String::new, |judged| format!("{:?}", judged.report.stop_reason));
        });
        println!(
            "{:>10} {:>10.1} {:>9.2} {:>16.1} {:>12.1} {:>12.2}  {end}",
            increments,
            written as f64 / 1e6,
            time,
            allocated.bytes_max as f64 / 1e3,
            resident::most().unwrap_or(f64::NAN),
            time / increments as f64 * 1e6
        );
    }
}
