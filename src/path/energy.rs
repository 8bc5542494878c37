//! External work and dissipation along an increment.
//!
//! ```text
//! ΔW = f_held·Δu + ∫ s d(f·u),      ΔD = -Σ ∫ r_t·dx_t
//! ```
//!
//! Both integrands are products along a curve whose ends and end directions are known: cubic Hermite interpolants of
//! both factors, integrated exactly, give an error of fourth order in the step. The interpolants' parameter is arc
//! length; the chord `S` between directions that differ by an angle `θ` spans `S (1 + θ²/24)` of it.

use super::mode_system::Loading;
use super::state::{Rate, State, dot};
use crate::contact::Mode;

/// A scalar at both ends of an increment with its derivatives by arc length.
#[derive(Clone, Copy)]
struct Ends {
    first: f64,
    first_rate: f64,
    last: f64,
    last_rate: f64,
}

/// A point and the direction of the path there.
pub type Placed<'a> = (&'a State, &'a Rate);

/// `(ΔW, ΔD)` of an increment in one mode.
pub fn work_and_dissipation(loading: Loading<'_>, modes: &[Mode], start: Placed<'_>, end: Placed<'_>) -> (f64, f64) {
    let chord = start.0.distance(end.0);
    let angle = start.1.product(end.1).clamp(-1.0, 1.0).acos();
    let length = chord * (1.0 + angle * angle / 24.0);
    let load = Ends { first: start.0.load, first_rate: start.1.load, last: end.0.load, last_rate: end.1.load };
    // Motions are measured from the start, so that large displacements cost no digits.
    let change: Vec<f64> = end.0.displacement.iter().zip(&start.0.displacement).map(|(a, b)| a - b).collect();
    let path = Ends {
        first: 0.0,
        first_rate: dot(loading.pattern, &start.1.displacement),
        last: dot(loading.pattern, &change),
        last_rate: dot(loading.pattern, &end.1.displacement),
    };
    let work = dot(loading.held, &change) + integral(load, path, length);
    let mut dissipation = 0.0;
    let dimension = loading.structure.dimension;
    for (index, (mode, contact)) in modes.iter().zip(loading.contacts).enumerate() {
        if !matches!(mode, Mode::Slip { .. }) || contact.friction == 0.0 {
            continue;
        }
        let node = contact.node * dimension..(contact.node + 1) * dimension;
        for (k, tangent) in contact.obstacle.tangents(dimension).iter().enumerate().take(dimension - 1) {
            let along = |values: &[f64]| super::state::along(&values[node.clone()], tangent);
            let traction = Ends {
                first: start.0.reactions[index].tangential[k],
                first_rate: start.1.reactions[index].tangential[k],
                last: end.0.reactions[index].tangential[k],
                last_rate: end.1.reactions[index].tangential[k],
            };
            let slip = Ends {
                first: 0.0,
                first_rate: along(&start.1.displacement),
                last: along(&change),
                last_rate: along(&end.1.displacement),
            };
            dissipation -= integral(traction, slip, length);
        }
    }
    (work, dissipation)
}

/// `∫ a db` over the length; the integrand is of degree five, so that Gauss's three points are exact.
fn integral(a: Ends, b: Ends, length: f64) -> f64 {
    let offset = 0.6_f64.sqrt() / 2.0;
    [(0.5 - offset, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.5 + offset, 5.0 / 18.0)]
        .iter()
        .map(|&(x, weight)| weight * value(a, length, x) * slope(b, length, x))
        .sum()
}

fn value(ends: Ends, length: f64, x: f64) -> f64 {
    let y = 1.0 - x;
    y * y * ((1.0 + 2.0 * x) * ends.first + x * length * ends.first_rate)
        + x * x * ((1.0 + 2.0 * y) * ends.last - y * length * ends.last_rate)
}

/// Derivative by `x`, that is by arc length over the length.
fn slope(ends: Ends, length: f64, x: f64) -> f64 {
    let y = 1.0 - x;
    6.0 * x * y * (ends.last - ends.first)
        + length * (y * (1.0 - 3.0 * x) * ends.first_rate + x * (3.0 * x - 2.0) * ends.last_rate)
}
