//! Chains over a drum at the ends of the scale of friction, against calculations by hand.

use crate::common::generators::capstan;
use crate::common::paths::{close, trace};
use arcslip::result::stop_reason::StopReason;

const STIFFNESS: f64 = 1e4;

/// Where all nodes slide the pull exceeds the frictionless one by `exp(Σ 2 artanh(μ tan δ/2)) - 1`, to first order
/// `2 n μ tan(π/2n)`, however small μ is.
#[test]
fn the_pull_is_proportional_to_a_small_friction() {
    for n in [3, 5] {
        let pull = |friction: f64| {
            let (increments, report) = trace(&capstan(n, friction, STIFFNESS, 1e-3));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "n {n}, friction {friction}");
            increments.last().expect("an end").load_factor
        };
        // Without friction the unstressed chain is a mechanism.
        let least = 1e-11;
        let without = pull(least);
        let exact = 2.0 * n as f64 * (0.5 * std::f64::consts::PI / n as f64).tan();
        for friction in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
            // The chain has moved by 1e-3, and the exponent bends.
            let bar = exact * (2e-3 + exact * friction) + 1e-13 / friction;
            close((pull(friction) - without) / (friction - least), exact, bar, &format!("n {n}, friction {friction}"));
        }
    }
}

/// Two nodes: with the first one sliding down by `u` (of radius 1) the traction of the other, which sticks, goes from one
/// side of its cone at `u = 0` to the other at `u = 4 μ` (to first order); there it would have to slide up, which
/// unloads the chain and pushes the first node over its bound: the chain slides off.
#[test]
fn a_chain_of_two_slides_off_where_its_friction_is_used_up() {
    for friction in [1e-5, 1e-6, 1e-7, 1e-8] {
        let (increments, report) = trace(&capstan(2, friction, STIFFNESS, 1e-3));
        assert_eq!(report.stop_reason, StopReason::NoDirection, "{friction}");
        let last = increments.last().expect("an end");
        let moved = ["node0", "node1"].map(|node| last.displacements[node][0].hypot(last.displacements[node][1]));
        let (first, other) = (moved[0].max(moved[1]), moved[0].min(moved[1]));
        assert_eq!(other, 0.0, "{friction}");
        close(first / friction, 4.0, 40.0 * friction + 1e-5, &format!("{friction}"));
    }
}

/// Close to jamming (μ near `cot δ/2`) from a start that touches without reaction: behind the first node the tension is
/// `(cos δ/2 - μ sin δ/2)/(cos δ/2 + μ sin δ/2)` of the pull, and as much less again behind the next.
#[test]
fn chains_close_to_jamming_are_held() {
    for (n, parts) in [(6, vec![0.9, 0.99, 0.998, 0.9995, 0.9999, 0.999999]), (8, vec![0.99, 0.998, 0.999, 0.9995])] {
        let half = 0.5 * std::f64::consts::PI / f64::from(n);
        for part in parts {
            let friction = part / half.tan();
            let what = format!("n {n}, {part} of the friction that jams it");
            let mut request = capstan(n as usize, friction, STIFFNESS, 1e-3);
            request.model.stages.truncate(1);
            let (increments, report) = trace(&request);
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}");
            let last = increments.last().expect("an end");
            let [first, second] = ["node0", "node1"].map(|node| &request.model.nodes[node]);
            let moved = ["node0", "node1"].map(|node| &last.displacements[node]);
            let rest = [second[0] - first[0], second[1] - first[1]];
            let change = [moved[1][0] - moved[0][0], moved[1][1] - moved[0][1]];
            let squared = rest[0] * rest[0] + rest[1] * rest[1];
            let strain = (0..2).map(|k| (rest[k] + 0.5 * change[k]) * change[k]).sum::<f64>() / squared;
            // The nodes have moved by up to 1e-4, which turns the end forces against their tangents.
            close(STIFFNESS * strain, (1.0 - part) / (1.0 + part), 2e-4 * (1.0 - part).max(1e-5), &what);
        }
    }
}
