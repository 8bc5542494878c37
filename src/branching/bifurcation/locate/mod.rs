//! Location of the point at which an eigenvalue crosses zero.
//!
//! Newton's method on the path's equations is singular at this point, and near it may converge to another branch. The
//! point is therefore found on cubic Hermite interpolants of the path between regular points on both sides: first
//! between the ends of the step, then between points a fiftieth of the step away, and closer. The interpolation error
//! decreases with the fourth power of their distance; the point is accepted by its residual as every other point is.
//!
//! `folded_singularity` locates a singular point of another kind, of the slip equations, at which a path may pass from
//! one sheet of slips to another (a canard-type point).
//!
//! The interpolation is the method for dense matrices. For many unknowns the equations are bordered, so that they are regular at the
//! point (`bordered_newton`, `singular_point`); where this finds no point, as where a crossing is not transversal, the dense method is
//! used.

pub(crate) mod bordered_newton;
pub(crate) mod folded_singularity;
pub(crate) mod singular_point;
pub(crate) mod tolerances;

use crate::algebra::scalar_root::find_root;
use crate::algebra::{Determinant, null_space_as_scaled};
use crate::branching::bifurcation::locate::tolerances::{COINCIDENT_EIGENVALUES, CONVERGED_RESIDUAL, START_DISTANCE};
use crate::branching::bifurcation::singularity::null_vectors::NullVectors;
use crate::branching::bifurcation::singularity::test_functions::{
    Signature, SignatureChange, bordered_determinant, counted_tangent,
};
use crate::branching::bifurcation::singularity::tolerances::SINGULAR_PIVOT;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tolerances::ACCEPTED_RESIDUAL;
use crate::step::interpolation::{PlacedPoint, between, placed, unit};
use crate::step::mode_step::{Reached, StepStart};
use std::sync::Arc;

/// A smooth bifurcation point at the end of a step.
#[derive(Debug, Clone)]
pub struct Crossing {
    /// Number of eigenvalues that are zero at the point; 0 where it is no bifurcation point, but one of indeterminate
    /// direction (`folded_singularity`).
    pub eigenvalues: usize,
    /// The point is a bifurcation only with the contacts that touch without reaction free.
    pub grazing: bool,
    /// Signature just past the point.
    pub after: Signature,
    /// Null vectors at the point, where the location determined them.
    pub nulls: Option<Arc<NullVectors>>,
}

/// Distances of the regular points from the crossing, relative to the step.
pub(crate) const WIDTHS: [f64; 4] = [2e-2, 4e-3, 1e-3, 2e-4];
/// Places in a bracket, relative to its length, from which the search may begin.
const AHEAD: [f64; 4] = [0.0, 1e-4, 1e-3, 1e-2];

/// A crossing with the regular points between which it was found, where the dense method found it.
pub(crate) struct Located {
    pub point: Box<Reached>,
    pub crossing: Crossing,
    pub between: Option<[PlacedPoint; 2]>,
}

impl Located {
    /// Regular points on both sides of the crossing, for a step of a given length.
    pub fn between(&self, start: &StepStart<'_>, length: f64, work: &mut Work) -> Option<[PlacedPoint; 2]> {
        if let Some(between) = &self.between {
            return Some(between.clone());
        }
        let Reached { corrected, rate, step, .. } = &*self.point;
        let width = WIDTHS[1] * length;
        let mut at = |ahead: f64| {
            if step + ahead <= 0.0 {
                return Some(PlacedPoint { place: 0.0, state: start.state.clone(), rate: start.rate.clone() });
            }
            let guess = corrected.state.advanced(rate, ahead);
            start.reach_near(guess, step + ahead, work).map(|near| placed(start, &near)).ok()
        };
        Some([at(-width)?, at(width)?])
    }
}

/// Finds the first crossing of a step whose start has the signature `before`; `None` where the search fails.
pub fn locate(
    start: &StepStart<'_>,
    before: Signature,
    change: SignatureChange,
    reached: &Reached,
    work: &mut Work,
) -> Option<Located> {
    work.at_bifurcation(|work| find(start, before, change, reached, work))
}

fn find(
    start: &StepStart<'_>,
    before: Signature,
    change: SignatureChange,
    reached: &Reached,
    work: &mut Work,
) -> Option<Located> {
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    if system.has_tracks()
        && let Some(point) = folded_singularity::locate(start, reached)
    {
        let crossing = Crossing { eigenvalues: 0, grazing: false, after: before, nulls: None };
        return Some(Located { point, crossing, between: None });
    }
    if start.loading.structure.layout().is_some() && !system.has_tracks() {
        let located = bordered_newton::locate(start, before, change, reached);
        if located.is_some() {
            return located;
        }
    }
    let origin = PlacedPoint { place: 0.0, state: start.state.clone(), rate: start.rate.clone() };
    let end = placed(start, reached);
    let reference = bordered_determinant(&system, start.loading, &end.state, &unit(&end.rate))?;
    let value = |state: &State, rate: &Rate| crossing_value(start, &system, change, &reference, state, rate);
    let (mut left, mut right) = (origin.clone(), end.clone());
    let mut root = root_between(&left, &right, &value)?;
    let mut best: Option<(f64, Located)> = None;
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
        let corrected = newton::judged(&system, state, start.force_scale);
        let residual = corrected.residual;
        if let Some(previous) = &previous {
            // The points of each round are at least four times closer.
            error = corrected.state.distance(previous) / 256.0;
        }
        previous = Some(corrected.state.clone());
        let (matrix, _) = scaled_rows(&system, start.loading, &corrected.state);
        let null = null_space_as_scaled(matrix, SINGULAR_PIVOT)?;
        if null.ncols() < 2 || best.as_ref().is_some_and(|(least, ..)| *least <= residual) {
            continue;
        }
        let eigenvalues = match change {
            SignatureChange::Count { net, .. } => {
                together(&eigenvalues(start, &corrected.state)?, change)?.min(net.unsigned_abs())
            }
            SignatureChange::None | SignatureChange::Odd => null.ncols() - 1,
        };
        let after = before.past(change, eigenvalues)?;
        let crossing = Crossing { eigenvalues, grazing: false, after, nulls: None };
        let step = corrected.state.distance(start.state);
        let mut point = Reached::new(corrected, rate, step, error);
        point.drift = start.drift.cloned();
        best = Some((residual, Located { point, crossing, between: Some([left.clone(), right.clone()]) }));
        if residual <= CONVERGED_RESIDUAL {
            break;
        }
    }
    let (residual, located) = best?;
    // With sparse matrices a singular start may appear regular.
    let is_start = start.loading.structure.layout().is_some() && located.point.step <= START_DISTANCE;
    (residual <= ACCEPTED_RESIDUAL && !is_start).then_some(located)
}

/// A quantity that decreases through zero at the crossing; `reference` is the determinant at the end of the step.
fn crossing_value(
    start: &StepStart<'_>,
    system: &ModeSystem<'_>,
    change: SignatureChange,
    reference: &Determinant,
    state: &State,
    rate: &Rate,
) -> Option<f64> {
    match change {
        SignatureChange::None => None,
        SignatureChange::Count { before, net } => {
            let values = eigenvalues(start, state)?;
            if net > 0 { values.get(before).copied() } else { values.get(before.checked_sub(1)?).map(|v| -v) }
        }
        SignatureChange::Odd => {
            // Negative past the crossing, of the size of the determinant there.
            let here = bordered_determinant(system, start.loading, state, rate)?;
            Some(-here.sign * reference.sign * (here.logarithm - reference.logarithm).min(300.0).exp())
        }
    }
}

/// Eigenvalues of the reduced tangent in ascending order.
fn eigenvalues(start: &StepStart<'_>, state: &State) -> Option<Vec<f64>> {
    let tangent = counted_tangent(start.loading, start.modes, start.state, state)?;
    let mut values: Vec<f64> = tangent.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    Some(values)
}

/// How many of the eigenvalues that cross are zero together with the first to cross.
fn together(values: &[f64], change: SignatureChange) -> Option<usize> {
    let SignatureChange::Count { before, net } = change else { return None };
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let crossing: Vec<f64> =
        if net > 0 { values.get(before..)?.to_vec() } else { values.get(..before)?.iter().rev().copied().collect() };
    let first = *crossing.first()?;
    Some(crossing.iter().take_while(|value| (*value - first).abs() <= COINCIDENT_EIGENVALUES * largest).count())
}

fn root_between(left: &PlacedPoint, right: &PlacedPoint, value: &impl Fn(&State, &Rate) -> Option<f64>) -> Option<f64> {
    let evaluate = |place: f64| {
        let (state, rate) = between(left, right, place);
        value(&state, &unit(&rate))
    };
    let last = evaluate(right.place)?;
    // A start that is itself a bifurcation point has no sign: begin a little past it.
    let first = AHEAD.iter().find_map(|part| {
        let place = left.place + part * (right.place - left.place);
        evaluate(place).filter(|value| *value > 0.0).map(|value| (place, value))
    })?;
    (last < 0.0).then(|| find_root(evaluate, first, (right.place, last), 0.0))?
}
