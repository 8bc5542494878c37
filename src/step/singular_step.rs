//! Steps from a point at which the equations of the mode have further null vectors, or nearly so: see
//! `branch_directions`.
//!
//! A slider that sticks at a limit point of the structure attached to it keeps this structure at its limit point,
//! whatever the load on the slider: all along the path a second null vector leaves Newton's method without a unique
//! correction. Where the path is otherwise straight, the point straight ahead satisfies the equations. Where it is not
//! (another part slips), the equations are solved with the undetermined motions suppressed.

use crate::mechanics::equations::closing_equation::ClosingEquation;
use crate::mechanics::equations::{ModeSystem, null_motion_suppression};
use crate::mechanics::problem::state::State;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tolerances::ACCEPTED_RESIDUAL;
use crate::step::mode_step::{Reached, StepStart};

/// The point straight ahead, where it satisfies the equations.
pub(crate) fn held_straight(
    start: &StepStart<'_>,
    system: &ModeSystem<'_>,
    closing: &dyn ClosingEquation,
) -> Option<Box<Reached>> {
    if !start.is_singular || start.beside.is_some() || system.has_tracks() {
        return None;
    }
    let step = closing.straight_way(start.state, start.rate)?;
    if !(step.is_finite() && step > 0.0) {
        return None;
    }
    let corrected = newton::judged(system, start.state.advanced(start.rate, step), start.force_scale);
    let error = corrected.residual;
    (error <= ACCEPTED_RESIDUAL).then(|| start.straight_on(corrected, error))
}

/// The point found with the undetermined motions suppressed; `None` where there are none, or where the equations cannot
/// be satisfied in this way.
pub(crate) fn held_across(
    start: &StepStart<'_>,
    guess: &State,
    closing: &dyn ClosingEquation,
    work: &mut Work,
) -> Option<Box<Reached>> {
    if !start.is_singular || start.beside.is_some() {
        return None;
    }
    let mut system = ModeSystem::new(start.loading, start.modes, start.state).along(start.rate);
    if !null_motion_suppression::suppress_open_motions(&mut system, start.state, start.rate) {
        return None;
    }
    let iterate = system.iterate(guess.clone());
    let corrected = newton::correct_from(&system, iterate, closing, start.force_scale, &mut None, work).ok()?;
    if !null_motion_suppression::is_still_open(&system, &corrected.state) {
        // Only the start is singular.
        return None;
    }
    let mut reached = start.directed(system, corrected, closing, &mut None, work).ok()?;
    // The sign of the determinant depends on the signs of the terms that suppress the motions.
    reached.determinant = None;
    Some(reached)
}

/// A guess beside the direction, where the path curves at once: along an arm of a parabola.
pub(crate) fn guess_beside(start: &StepStart<'_>, closing: &dyn ClosingEquation) -> Option<State> {
    let (beside, step) = (start.beside?, closing.arc_length()?);
    let mut guess = start.state.advanced(start.rate, step);
    guess.advance(beside, step.sqrt());
    Some(guess)
}
