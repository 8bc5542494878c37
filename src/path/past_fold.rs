//! Steps from a point at which the equations of the mode have another null vector, or as good as that: see `branches`.

use super::advance::{Reached, Start};
use super::mode_system::ModeSystem;
use super::newton::{ACCEPTED_RESIDUAL, Place};
use super::state::State;

impl Start<'_> {
    /// The point straight ahead, where the equations hold along the direction. A slider that sticks at a fold of what hangs
    /// on it keeps that at its fold, whatever the load on the slider: all along, a second null vector leaves Newton's method
    /// nothing to go by.
    pub(super) fn held_straight(&self, system: &ModeSystem<'_>, place: Place<'_>) -> Option<Box<Reached>> {
        if !self.is_singular || self.beside.is_some() || system.has_tracks() {
            return None;
        }
        let step = match place {
            Place::ArcLength { step, .. } => step,
            Place::Load(value) => (value - self.state.load) / self.rate.load,
            Place::Displacement { freedom, value } => {
                (value - self.state.displacement[freedom]) / self.rate.displacement[freedom]
            }
            Place::Zero { .. } => return None,
        };
        if !(step.is_finite() && step > 0.0) {
            return None;
        }
        let corrected = system.judged(self.state.advanced(self.rate, step), self.force_scale);
        let error = corrected.residual;
        (error <= ACCEPTED_RESIDUAL).then(|| self.straight_on(corrected, error))
    }

    /// A guess off the direction, where the path bends at once: along the arm of a parabola.
    pub(super) fn guess_beside(&self, place: Place<'_>) -> Option<State> {
        let (beside, Place::ArcLength { step, .. }) = (self.beside?, place) else { return None };
        let mut guess = self.state.advanced(self.rate, step);
        guess.advance(beside, step.sqrt());
        Some(guess)
    }
}
