//! The motion that is free where a stage begins at a limit point of the stage before.
//!
//! At a limit point the tangent has a null vector `φ`. Forces `f` of the next stage with `f·φ ≠ 0` drive the structure
//! along `φ`, ahead or back. Forces with `f·φ = 0` leave first order undecided: the equations `K v = ṡ f` have the null
//! vector `(φ, 0)` and a solution `(w, 1)`, and second order has two branches `α φ + w` that cross, along each of which
//! the load rises to one side. By `α` the rates of the eigenvalue that is zero here are opposite: one branch is stable.

use crate::branching::directions::feasible_direction::sign_of;
use crate::continuation::increment::tolerances::NO_WORK;
use crate::continuation::path_state::path_context::PathTrace;
use crate::mechanics::problem::loading::Loading;

/// The motion of all degrees of freedom along which the structure moved without a change of its load where a stage ends,
/// if it does so at a limit point.
pub(crate) fn free_motion(trace: &PathTrace<'_>) -> Option<Vec<f64>> {
    let rate = trace.at.here.rate.as_ref().filter(|rate| sign_of(rate.load) == 0.0)?;
    Some(rate.displacement.clone())
}

/// Whether the forces of a stage do no work on a motion of the degrees of freedom.
pub(crate) fn does_no_work(loading: Loading<'_>, motion: &[f64]) -> bool {
    let pattern = loading.pattern;
    // What else a stage may move or press does work in general.
    if pattern.moves_boundary() || loading.structure.has_following_loads() {
        return false;
    }
    let free = || loading.structure.freedom_of.iter().map(|freedom| (pattern.forces[*freedom], motion[*freedom]));
    let work: f64 = free().map(|(force, moved)| force * moved).sum();
    let size = |of: fn((f64, f64)) -> f64| free().map(|pair| of(pair).powi(2)).sum::<f64>().sqrt();
    work.abs() <= NO_WORK * size(|(force, _)| force) * size(|(_, moved)| moved)
}
