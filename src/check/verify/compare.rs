//! Comparison of results with exact values.

use crate::result::increment::{Increment, PointKind};

/// The larger error; NaN counts as infinite.
pub fn worse(error: f64, other: f64) -> f64 {
    if other.is_nan() { f64::INFINITY } else { error.max(other) }
}

/// Absolute difference, over the larger of the exact magnitude and a given size.
pub fn relative(found: f64, exact: f64, size: f64) -> f64 {
    worse(0.0, (found - exact).abs() / exact.abs().max(size))
}

/// The largest of the errors; infinite if there are none.
pub fn worst(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(None, |all: Option<f64>, error| Some(worse(all.unwrap_or(0.0), error))).unwrap_or(f64::INFINITY)
}

/// A displacement component of a node; NaN if the increment does not contain the component.
pub fn moved(increment: &Increment, node: &str, component: usize) -> f64 {
    increment.displacements.get(node).and_then(|values| values.get(component)).copied().unwrap_or(f64::NAN)
}

/// The increments of a stage, without the end of the previous stage.
pub fn of_stage<'a>(increments: &'a [Increment], stage: &'a str) -> impl Iterator<Item = &'a Increment> {
    increments.iter().filter(move |increment| &*increment.stage == stage)
}

/// The points with contact changes, including nonsmooth limit points.
pub fn changes(increments: &[Increment]) -> impl Iterator<Item = &Increment> {
    let changes =
        |increment: &&Increment| matches!(increment.point.kind, PointKind::ContactChange | PointKind::NonsmoothLimit);
    increments.iter().filter(changes)
}

/// Points of one kind.
pub fn points(increments: &[Increment], kind: PointKind) -> impl Iterator<Item = &Increment> {
    increments.iter().filter(move |increment| increment.point.kind == kind)
}

/// A root between two points with values of different sign, by bisection to machine precision.
pub fn bisected(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rises = function(low) < 0.0;
    for _ in 0..2000 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (function(middle) < 0.0) == rises { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
