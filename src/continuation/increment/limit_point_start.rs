//! The motion that is free where a stage begins at a limit point of the stage before.
//!
//! At a limit point the tangent has a null vector `φ`. Forces `f` of the next stage with `f·φ ≠ 0` drive the structure
//! along `φ`, ahead or back. Forces with `f·φ = 0` leave first order undecided: the equations `K v = ṡ f` have the null
//! vector `(φ, 0)` and a solution `(w, 1)`, and second order has two branches `α φ + w` that cross, along each of which
//! the load rises to one side. By `α` the rates of the eigenvalue that is zero here are opposite: one branch is stable.

use crate::branching::directions::feasible_direction::sign_of;
use crate::branching::directions::trial_step::later_sign;
use crate::continuation::increment::tolerances::NO_WORK;
use crate::continuation::path_state::path_context::PathTrace;

use crate::mechanics::problem::loading::Loading;
use crate::model::request::StageControl;

/// The motion of all degrees of freedom along which the structure moved without a change of its load where a stage ends,
/// if it does so at a limit point. Before a stage under load control, the sign is such that the limit point's eigenvalue
/// rises along the motion; otherwise that of the path.
pub(crate) fn free_motion(trace: &PathTrace<'_>) -> Option<Vec<f64>> {
    let here = &trace.at.here;
    let rate = here.rate.as_ref().filter(|rate| sign_of(rate.load) == 0.0)?;
    let mut motion = rate.displacement.clone();
    let next = trace.scene.stages.get(trace.at.stage + 1)?;
    if next.control == StageControl::Load {
        // Close to the limit point `λ φ·φ = ṡ f·φ` with its eigenvalue `λ`.
        let later = later_sign(trace.loading(), &here.state, rate, &here.modes, trace.rules().force_scale).sign;
        if later * work(trace.loading(), &motion).0 < 0.0 {
            motion.iter_mut().for_each(|value| *value = -*value);
        }
    }
    Some(motion)
}

/// Whether the forces of a stage do no work on a motion of the degrees of freedom.
pub(crate) fn does_no_work(loading: Loading<'_>, motion: &[f64]) -> bool {
    // What else a stage may move or press does work in general.
    if loading.pattern.moves_boundary() || loading.structure.has_following_loads() {
        return false;
    }
    let (work, sizes) = work(loading, motion);
    work.abs() <= NO_WORK * sizes
}

/// Work of the forces of a stage on a motion of the degrees of freedom, and the product of the sizes of both.
fn work(loading: Loading<'_>, motion: &[f64]) -> (f64, f64) {
    let forces = &loading.pattern.forces;
    let free = || loading.structure.freedom_of.iter().map(|freedom| (forces[*freedom], motion[*freedom]));
    let size = |of: fn((f64, f64)) -> f64| free().map(|pair| of(pair).powi(2)).sum::<f64>().sqrt();
    (free().map(|(force, moved)| force * moved).sum(), size(|(force, _)| force) * size(|(_, moved)| moved))
}
