//! A path that is a closed curve stops where it began.
//!
//! Two bars with Green strain (EA = 1, pins at (±1, 0), apex from (0, h), h = 1/2, L0² = 1 + h²) snap through sideways
//! under a held weight p. With the apex at (x, y) and `A = x² + y² - h²`:
//!
//! ```text
//! ∂W/∂y = y A/L0³ = -p,      s = ∂W/∂x = x (A + 2)/L0³
//! ```
//!
//! so `x² = h² - y² - q/y` with `q = p L0³`: closed around (0, h/√3) for `0 < q < 2 h³/(3√3)`. The path starts at the
//! top, x = 0, and comes back to it; no bar dissipates and the load's work around the curve is nothing.

use crate::common::paths::{close, place, scene_file, trace};
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;

#[test]
fn a_closed_path_ends_where_it_began() {
    let request = scene_file("closed-loop");
    let (increments, report) = trace(&request);
    let cube = 1.25_f64.powf(1.5);
    let q = 0.018 * cube;
    let begun = increments.iter().rfind(|increment| &*increment.stage == "press").expect("a pressed state");
    let pushed: Vec<&Increment> = increments.iter().filter(|increment| &*increment.stage == "push").collect();
    let (mut left, mut right, mut low) = (0.0_f64, 0.0_f64, 1.0_f64);
    for increment in &pushed {
        let at = place(&request, increment, "apex");
        let (x, y) = (at[0], at[1]);
        close(x * x, 0.25 - y * y - q / y, 1e-12, "place");
        close(increment.load_factor, x * (2.0 - q / y) / cube, 1e-11, "load");
        (left, right, low) = (left.min(x), right.max(x), low.min(y));
    }
    // Both sides, and the lower end of the curve: the smaller root of y (h² - y²) = q.
    let root = |mut y: f64| {
        (0..60).for_each(|_| y -= (y * (0.25 - y * y) - q) / (0.25 - 3.0 * y * y));
        y
    };
    let most = (0.25 - (0.5 * q).powf(2.0 / 3.0) * 3.0).sqrt();
    assert!(right > 0.95 * most && left < -0.95 * most, "from {left} to {right}");
    assert!(low < root(0.1) + 1e-2, "down to {low}");
    assert_eq!(report.stop_reason, StopReason::Cycle, "{report:?}");
    let last = pushed.last().expect("an end");
    assert_eq!(last.point.kind, PointKind::End);
    close(last.load_factor, 0.0, 1e-8, "load at the end");
    for (a, b) in last.displacements["apex"].iter().zip(&begun.displacements["apex"]) {
        close(*a, *b, 1e-8, "the state that was left");
    }
    close(last.energy.external_work, begun.energy.external_work, 1e-8, "work around the curve");
}

/// A block that its floor drags to and fro comes back to places it has been in, in other states: no cycle.
#[test]
fn a_return_to_a_place_in_another_state_is_no_cycle() {
    let mut request = scene_file("dragged-block");
    let mut back = request.model.stages[1].clone();
    back.name = "back".into();
    back.obstacle_motion.insert("floor".into(), vec![-1.0, 0.0]);
    request.model.stages.push(back);
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    close(increments.last().expect("an end").displacements["block"][0], -0.15, 1e-12, "dragged back");
}
