//! Chains over a drum at the ends of the scale of friction, against calculations by hand.

mod common;

use arcslip::path::StopReason;
use common::generators::capstan;
use common::paths::{close, trace};

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
