//! Capstan: the tension of a chain over a drum, node by node, and its limit `exp(μ θ)`.
//!
//! A node at full slip, with the bars (or end forces) on its two sides at the angles `α1`, `α2` below its tangent:
//! `r_n = T1 sin α1 + T2 sin α2` and `T2 cos α2 - T1 cos α1 = μ r_n`, so
//!
//! ```text
//! T2/T1 = (cos α1 + μ sin α1)/(cos α2 - μ sin α2)
//! ```
//!
//! which is the formulation's ratio for `α1 = α2 = δ/2`. Angles are taken from the streamed places, as bars stretch.
//! The end forces keep their directions, so all angles add up to `π` however the chain moves, and for even spacing the
//! logarithm of the whole ratio is `Σ 2 artanh(μ tan δ/2) = μ π + μ (1 + μ²) π³/(12 n²) + O(n⁻⁴)`.

use crate::common::generators::capstan;
use crate::common::paths::{close, place, trace};
use arcslip::model::JobRequest;
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;

const STIFFNESS: f64 = 1e4;

/// Tensions from the hold to the pull (n + 1 of them) and unit directions of bars and end forces, hold to pull.
fn tensions(request: &JobRequest, increment: &Increment) -> (Vec<f64>, Vec<[f64; 2]>) {
    let n = request.model.nodes.len();
    let (mut tensions, mut directions) = (vec![1.0], vec![[0.0, 1.0]]);
    for i in 1..n {
        let names = [format!("node{}", i - 1), format!("node{i}")];
        let rest = [0, 1].map(|k| request.model.nodes[&names[1]][k] - request.model.nodes[&names[0]][k]);
        let moved = [&names[0], &names[1]].map(|name| &increment.displacements[name.as_str()]);
        let change = [0, 1].map(|k| moved[1][k] - moved[0][k]);
        let now = [rest[0] + change[0], rest[1] + change[1]];
        let (length, unstressed) = (now[0].hypot(now[1]), rest[0].hypot(rest[1]));
        // L - L0 from L² - L0², which keeps its digits in a stiff bar.
        let elongation: f64 =
            (0..2).map(|k| (2.0 * rest[k] + change[k]) * change[k]).sum::<f64>() / (length + unstressed);
        tensions.push(STIFFNESS * elongation / unstressed);
        directions.push(now.map(|value| value / length));
    }
    tensions.push(1.0 + increment.load_factor);
    directions.push([0.0, -1.0]);
    (tensions, directions)
}

/// Every node's ratio at every point of full slip; the logarithm of the whole ratio where full slip begins.
fn full_slip(n: usize, friction: f64) -> f64 {
    let request = capstan(n, friction, STIFFNESS, 1e-3);
    let (increments, report) = trace(&request);
    assert_eq!(report.stop_reason, StopReason::StagesCompleted, "n {n}, friction {friction}");
    let slides = |increment: &&Increment| {
        &*increment.stage == "pull" && increment.contacts.iter().all(|contact| contact.status == Status::Slip)
    };
    let sliding: Vec<&Increment> = increments.iter().filter(slides).collect();
    let first = sliding.first().unwrap_or_else(|| panic!("no full slip at n {n}, friction {friction}"));
    let begins = &increments[first.index as usize - 1];
    for increment in sliding.iter().copied().chain([begins]) {
        let (tensions, directions) = tensions(&request, increment);
        for i in 0..n {
            let at = place(&request, increment, &format!("node{i}"));
            let radius = at[0].hypot(at[1]);
            let (normal, tangent) = ([at[0] / radius, at[1] / radius], [at[1] / radius, -at[0] / radius]);
            let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
            let before = dot(directions[i], normal).atan2(dot(directions[i], tangent));
            let after = (-dot(directions[i + 1], normal)).atan2(dot(directions[i + 1], tangent));
            let exact = (before.cos() + friction * before.sin()) / (after.cos() - friction * after.sin());
            let what = format!("n {n}, friction {friction}, increment {}, node {i}", increment.index);
            close(tensions[i + 1] / tensions[i] / exact, 1.0, 1e-9, &what);
        }
    }
    (1.0 + begins.load_factor).ln()
}

fn check(n: usize, friction: f64) -> f64 {
    let spacing = std::f64::consts::PI / n as f64;
    let exact = 2.0 * n as f64 * (friction * (0.5 * spacing).tan()).atanh();
    let found = full_slip(n, friction);
    // The chain has stretched by up to exp(μ π)/EA where full slip begins.
    close(
        found,
        exact,
        (friction * std::f64::consts::PI).exp() / STIFFNESS,
        &format!("n {n}, friction {friction}: the evenly spaced chain"),
    );
    (found - friction * std::f64::consts::PI).abs()
}

#[test]
fn eight_and_sixteen_nodes() {
    for friction in [0.1, 0.3, 1.0] {
        let (coarse, fine) = (check(8, friction), check(16, friction));
        let order = (coarse / fine).log2();
        assert!((1.8..2.2).contains(&order), "friction {friction}: order {order} of the convergence to exp(μθ)");
    }
}

#[test]
fn thirty_two_nodes() {
    for friction in [0.1, 0.3, 1.0] {
        check(32, friction);
    }
}

/// So many contacts that touch at once at the start are more than the search can exhaust, and the points say so; the
/// way on is found.
#[test]
#[ignore = "a minute in a release build: cargo test --release --test solver capstan -- --ignored"]
fn sixty_four_nodes() {
    for friction in [0.1, 0.3, 1.0] {
        let exponent = check(64, friction);
        let bound = friction * (1.0 + friction * friction) * std::f64::consts::PI.powi(3) / (12.0 * 64.0 * 64.0);
        assert!(exponent < 1.1 * bound, "friction {friction}: {exponent:e} from exp(μθ), expected {bound:e}");
    }
}

/// The built-in scene is the generator's, in a softer chain.
#[test]
fn the_built_in_scene_slides_as_a_whole() {
    let (increments, report) = trace(&crate::common::paths::scene_file("capstan"));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let last = increments.last().expect("an end");
    assert!(last.contacts.iter().all(|contact| contact.status == Status::Slip));
}
