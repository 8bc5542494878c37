//! What a path takes does not grow with its increments: a million of them can be streamed. (Ten times as many, and what the
//! process takes: `cargo bench --bench memory`. The states kept for telling a cycle: `continuation/path_state/visited_states`.)

use crate::common::long_paths::one_bar_in_short_steps;
use allocation_counter::measure;
use arcslip::check::judged::JudgedPath;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::stop_reason::StopReason;

/// Most bytes at once of a judged path of so many increments, none of which is held.
fn most_bytes(increments: u64) -> u64 {
    let request = one_bar_in_short_steps(increments, 1);
    let scene = Scene::new(&request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut report = None;
    let allocated = measure(|| {
        let mut path = JudgedPath::new(&request, &scene, CancelFlag::default());
        path.by_ref().for_each(drop);
        report = path.report();
    });
    let report = report.expect("a report").report;
    assert_eq!((report.stop_reason, report.increments), (StopReason::MaxIncrements, increments));
    allocated.bytes_max
}

#[test]
fn ten_times_the_increments_take_the_same_memory() {
    let (few, many) = (most_bytes(1_000), most_bytes(10_000));
    assert!(many <= few + few / 50, "{few} bytes, then {many}");
}
