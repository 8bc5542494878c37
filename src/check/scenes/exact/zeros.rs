//! Zeros of functions of one variable.

/// Number of intervals in which changes of sign are searched for.
const PARTS: u32 = 2000;
/// Largest number of bisections, more than the bits of a number.
const HALVINGS: u32 = 200;

/// A zero between two points with values of different sign, to machine precision; `to` if the signs are equal.
pub(super) fn zero(function: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let negative = function(from) < 0.0;
    let (mut from, mut to) = (from, to);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        if middle == from || middle == to {
            break;
        }
        if (function(middle) < 0.0) == negative { from = middle } else { to = middle }
    }
    to
}

/// The changes of sign between two points, in order, without those in the first and the last interval.
pub(super) fn zeros(function: impl Fn(f64) -> f64, from: f64, to: f64) -> Vec<f64> {
    let place = |part: u32| from + (to - from) * f64::from(part) / f64::from(PARTS);
    let mut found = Vec::new();
    for part in 1..PARTS - 1 {
        let (before, after) = (place(part), place(part + 1));
        if (function(before) < 0.0) != (function(after) < 0.0) {
            found.push(zero(&function, before, after));
        }
    }
    found
}
