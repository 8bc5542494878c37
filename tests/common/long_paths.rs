//! Paths of as many increments as are asked for.

use arcslip::model::JobRequest;

use super::paths::scene_file;

/// The one-bar truss with steps so short that it does not come to its end before, and a row of every `every`-th increment
/// only.
pub fn one_bar_in_short_steps(increments: u64, every: u64) -> JobRequest {
    let mut request = scene_file("one-bar-truss");
    // Its whole way is longer.
    let step = 1.0 / increments as f64;
    let arc_length = &mut request.analysis.arc_length;
    (arc_length.initial, arc_length.max, arc_length.min) = (step, step, arc_length.min.min(1e-3 * step));
    request.analysis.max_increments = increments;
    let record = request.analysis.record.get_or_insert_default();
    (record.every, record.directions) = (every, false);
    request
}
