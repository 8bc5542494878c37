//! Scenes with many contacts at once: every event, every direction.

use crate::common::generators::{row_of_bars, slider_chain};
use crate::common::paths::{trace, typed};
use arcslip::model::JobRequest;
use arcslip::result::increment::{Increment, PointKind};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// A document with room for every event.
fn long(mut document: Value, arc_length: &Value) -> JobRequest {
    document["analysis"] = json!({"max_increments": 20000, "arc_length": arc_length});
    typed(document)
}

/// Block `m` starts to slip exactly at `s = m μ W`; the first block has then moved `μ W/k Σ_{i<m} i`. At the last one the
/// whole chain slides: a mechanism.
#[test]
fn slider_chains() {
    for (n, weight, stiffness, friction) in [(5, 1.0, 1.0, 0.3), (30, 2.5, 40.0, 0.7), (100, 1.0, 1.0, 0.3)] {
        let (increments, report) = trace(&long(slider_chain(n, friction, weight, stiffness), &json!({"max": 1000.0})));
        assert_eq!(report.stop_reason, StopReason::Mechanism, "n = {n}");
        let events: Vec<&Increment> = increments
            .iter()
            .filter(|i| &*i.stage == "pull" && matches!(i.point.kind, PointKind::ContactChange | PointKind::End))
            .collect();
        assert_eq!(events.len(), n);
        for (index, event) in events.iter().enumerate() {
            let exact = (index + 1) as f64 * friction * weight;
            assert!((event.load_factor - exact).abs() <= 1e-10 * exact, "{n}: {} for {exact}", event.load_factor);
            let travel = friction * weight / stiffness * (index * (index + 1) / 2) as f64;
            let found = event.displacements["block0"][0];
            assert!((found - travel).abs() <= 1e-9 * travel.max(weight / stiffness), "{n}: {found} for {travel}");
            assert_eq!(event.point.unexplored_modes, 0);
        }
    }
}

/// Past the limit the tips stick one after another from the far end, many within 1e-9 of one load, until one bar snaps
/// alone; the push of its tie makes the far tips slip again, and there the path ends. (That the last point has no
/// direction is confirmed by plain enumeration where the solver's own parts are tested.)
#[test]
fn a_row_of_twenty_bars_to_its_end() {
    let n = 20;
    let (increments, report) = trace(&long(row_of_bars(n), &json!({})));
    assert_eq!(report.stop_reason, StopReason::NoDirection);
    let events: Vec<&Increment> = increments.iter().filter(|i| i.point.kind != PointKind::Regular).skip(1).collect();
    assert_eq!(events[0].point.kind, PointKind::SmoothLimit);
    for (event, tip) in events[1..n].iter().zip((1..n).rev()) {
        assert_eq!(event.point.event.as_deref(), Some(&*format!("tip{tip} on floor: slip to stick")));
    }
    let close = events[1..n].iter().filter(|event| (event.load_factor - events[0].load_factor).abs() < 1e-9).count();
    assert!(close >= 7, "{close}");
    for (event, tip) in events[n..n + 2].iter().zip([19, 18]) {
        assert_eq!(event.point.event.as_deref(), Some(&*format!("tip{tip} on floor: stick to slip")));
    }
    assert_eq!(events.len(), n + 3);
    let last = events[n + 2];
    assert_eq!(last.point.kind, PointKind::End);
    assert!((last.load_factor - 0.124697214719).abs() < 1e-10, "{}", last.load_factor);
    for increment in &increments {
        assert_eq!(increment.point.unexplored_modes, 0);
        assert!(!increment.point.degenerate);
    }
}

/// Past the limit the far tips stick one after another, most of them within round-off of the limit itself: velocities
/// die away along the row, and those of the tips from the thirtieth on are too small to be told from none. Long: to be
/// run in a release build.
#[test]
#[ignore = "half a minute in a release build: cargo test --release --test solver many_contacts -- --ignored"]
fn a_row_of_a_hundred_bars_to_its_end() {
    let n = 100;
    let (increments, report) = trace(&long(row_of_bars(n), &json!({})));
    assert_eq!(report.stop_reason, StopReason::NoDirection);
    let events: Vec<&Increment> = increments.iter().filter(|i| i.point.kind != PointKind::Regular).skip(1).collect();
    let described = |event: &Increment| event.point.event.clone().unwrap_or_default();
    // At the limit all tips beyond some one stick together; then one after another down to the second.
    let together: Vec<String> = described(events[0]).split("; ").map(str::to_owned).collect();
    let first = n - together.len();
    assert!((15..40).contains(&first), "{together:?}");
    assert!((events[0].load_factor - 0.273971790955).abs() < 1e-11, "{}", events[0].load_factor);
    for (text, tip) in together.iter().zip(first..n) {
        assert_eq!(*text, format!("tip{tip} on floor: slip to stick"));
    }
    for (event, tip) in events[1..first].iter().zip((1..first).rev()) {
        assert_eq!(described(event), format!("tip{tip} on floor: slip to stick"));
        assert!(event.load_factor <= events[0].load_factor);
    }
    for (event, tip) in events[first..first + 2].iter().zip([99, 98]) {
        assert_eq!(described(event), format!("tip{tip} on floor: stick to slip"));
    }
    assert_eq!(events.len(), first + 3);
    let last = events[first + 2];
    assert_eq!(last.point.kind, PointKind::End);
    assert!((last.load_factor - 0.125923376763).abs() < 1e-10, "{}", last.load_factor);
    // A hundred contacts without reaction at the start, and a hundred on the cone at the limit, are more than the search
    // can exhaust; it says so. That nothing goes on from the end is certain.
    let not_exhausted: Vec<u64> =
        increments.iter().filter(|i| i.point.unexplored_modes > 0).map(|increment| increment.index).collect();
    assert!(not_exhausted.iter().all(|index| [0, events[0].index].contains(index)), "{not_exhausted:?}");
}
