//! Locating the point at which an eigenvalue crosses zero.
//!
//! Newton's method on the path's equations is singular at that very point, and near it may land on another branch. So the
//! point is found on cubic Hermite interpolants of the path between regular points on both sides: first between the
//! ends of the step, then between points a fiftieth of the step away, and closer. The interpolation's error falls
//! with the fourth power of their distance; the residual of the point found is judged like any other's.

use super::advance::{Reached, Start, Work};
use super::mode_system::ModeSystem;
use super::newton::ACCEPTED_RESIDUAL;
use super::root::find_root;
use super::singular::{Change, Signature, bordered_determinant, reduced_tangent, scaled_rows};
use super::state::{Rate, State};
use crate::linear_algebra::null_space_as_scaled;

/// A smooth bifurcation point at the end of a step.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Eigenvalues that are zero there.
    pub eigenvalues: usize,
    /// Signature just past it.
    pub after: Option<Signature>,
}

/// Distances of the regular points, over the step.
const WIDTHS: [f64; 4] = [2e-2, 4e-3, 1e-3, 2e-4];
/// Residual at which closer points gain nothing.
const GOOD: f64 = 2e-15;
/// Pivots of the singular equations up to this, relative, are zero.
pub(super) const SINGULAR: f64 = 1e-8;
/// How far past the point, over the step, the signature is taken.
const PAST: f64 = 1e-5;

/// A point on the path with its place: the distance from the start of the step.
#[derive(Clone)]
struct Placed {
    place: f64,
    state: State,
    /// Derivative by `place`.
    rate: Rate,
}

/// Finds the first crossing of a step. `None` where none can be made out.
pub fn locate(start: &Start<'_>, change: Change, reached: &Reached, work: &mut Work) -> Option<(Reached, Crossing)> {
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    let origin = Placed { place: 0.0, state: start.state.clone(), rate: start.rate.clone() };
    let end = placed(start, reached);
    let reference = bordered_determinant(&system, start.loading, &end.state, &unit(&end.rate))?;
    let value = |state: &State, rate: &Rate| -> Option<f64> {
        match change {
            Change::None => None,
            Change::Count { before, net } => {
                let tangent = reduced_tangent(&system, start.loading, start.modes, state)?;
                let mut values: Vec<f64> = tangent.symmetric_eigenvalues().iter().copied().collect();
                values.sort_by(f64::total_cmp);
                if net > 0 { values.get(before).copied() } else { values.get(before.checked_sub(1)?).map(|v| -v) }
            }
            Change::Odd => {
                // Negative on the far side, of the size of the determinant there.
                let here = bordered_determinant(&system, start.loading, state, rate)?;
                Some(-here.sign * reference.sign * (here.logarithm - reference.logarithm).min(300.0).exp())
            }
        }
    };
    let (mut left, mut right) = (origin.clone(), end.clone());
    let mut root = root_between(&left, &right, &value)?;
    let mut best: Option<(f64, Reached, Crossing)> = None;
    let mut previous: Option<State> = None;
    let mut error = end.place.powi(4);
    for width in WIDTHS {
        let width = width * end.place;
        let guess = |place: f64| between(&left, &right, place).0;
        let nearer = if root > width {
            start.reach_near(guess(root - width), root - width, work).map(|near| placed(start, &near)).ok()
        } else {
            Some(origin.clone())
        };
        let farther = start.reach_near(guess(root + width), root + width, work).map(|far| placed(start, &far)).ok();
        let (Some(nearer), Some(farther)) = (nearer, farther) else { break };
        let Some(place) = root_between(&nearer, &farther, &value) else { break };
        (left, right, root) = (nearer, farther, place);
        let (state, rate) = between(&left, &right, root);
        let rate = unit(&rate);
        let corrected = system.judged(state, start.force_scale);
        let residual = corrected.residual;
        if let Some(previous) = &previous {
            // Each round's points are at least four times closer.
            error = corrected.state.distance(previous) / 256.0;
        }
        previous = Some(corrected.state.clone());
        let (matrix, _) = scaled_rows(&system, start.loading, &corrected.state);
        let null = null_space_as_scaled(matrix, SINGULAR)?;
        if null.ncols() < 2 || best.as_ref().is_some_and(|(least, ..)| *least <= residual) {
            continue;
        }
        let (beyond, onward) = between(&left, &right, (root + PAST * end.place).min(right.place));
        let past = bordered_determinant(&system, start.loading, &beyond, &unit(&onward))?;
        let after = Signature::with_determinant(start.loading, start.modes, start.state, &beyond, past.sign);
        let crossing = Crossing { eigenvalues: null.ncols() - 1, after };
        let step = corrected.state.distance(start.state);
        let found =
            Reached { corrected, rate, step, error_estimate: error, drift: None, event: None, determinant: None };
        best = Some((residual, found, crossing));
        if residual <= GOOD {
            break;
        }
    }
    let (residual, found, crossing) = best?;
    (residual <= ACCEPTED_RESIDUAL).then_some((found, crossing))
}

fn root_between(left: &Placed, right: &Placed, value: &impl Fn(&State, &Rate) -> Option<f64>) -> Option<f64> {
    let evaluate = |place: f64| {
        let (state, rate) = between(left, right, place);
        value(&state, &unit(&rate))
    };
    let (first, last) = (evaluate(left.place)?, evaluate(right.place)?);
    (first > 0.0 && last < 0.0).then(|| find_root(evaluate, (left.place, first), (right.place, last), 0.0))?
}

fn placed(start: &Start<'_>, reached: &Reached) -> Placed {
    let place = reached.corrected.state.distance(start.state);
    let cosine = start.state.angle_of_chord(&reached.corrected.state, &reached.rate).cos();
    let mut rate = reached.rate.clone();
    rate.scale(1.0 / cosine);
    Placed { place, state: reached.corrected.state.clone(), rate }
}

fn unit(rate: &Rate) -> Rate {
    let mut rate = rate.clone();
    let size = rate.size();
    if size > 0.0 {
        rate.scale(1.0 / size);
    }
    rate
}

/// The cubic Hermite interpolant and its derivative.
fn between(left: &Placed, right: &Placed, place: f64) -> (State, Rate) {
    let width = right.place - left.place;
    if width <= 0.0 {
        return (left.state.clone(), left.rate.clone());
    }
    let x = (place - left.place) / width;
    let y = 1.0 - x;
    let chord = left.state.chord(&right.state);
    let state = left
        .state
        .advanced(&chord, x * x * (1.0 + 2.0 * y))
        .advanced(&left.rate, width * x * y * y)
        .advanced(&right.rate, -width * x * x * y);
    let mut rate = chord;
    rate.scale(6.0 * x * y / width);
    rate.add(&left.rate, y * (y - 2.0 * x));
    rate.add(&right.rate, x * (x - 2.0 * y));
    (state, rate)
}
