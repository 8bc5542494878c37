//! Steps from a point at which the equations of the mode have other null vectors, or as good as that: see `branches`.
//!
//! A slider that sticks at a fold of what hangs on it keeps that at its fold, whatever the load on the slider: all along, a
//! second null vector leaves Newton's method nothing to go by. Where nothing else bends the path, the point straight ahead
//! meets the equations. Where something does (another part slips), they are solved with the motions held that they leave
//! open.

use super::advance::{Reached, Start, Work};
use super::mode_system::ModeSystem;
use super::newton::{ACCEPTED_RESIDUAL, Place};
use super::state::State;

impl Start<'_> {
    /// The point straight ahead, where the equations hold along the direction.
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

    /// The point found with the motions held that the equations leave open; `None` where there are none, or the equations
    /// cannot be met so.
    pub(super) fn held_across(&self, guess: &State, place: Place<'_>, work: &mut Work) -> Option<Box<Reached>> {
        if !self.is_singular || self.beside.is_some() {
            return None;
        }
        let mut system = ModeSystem::new(self.loading, self.modes, self.state);
        if !system.hold_still(self.state, self.rate) {
            return None;
        }
        let iterate = system.iterate(guess.clone());
        let corrected = system.correct_from(iterate, place, self.force_scale, &mut None, work).ok()?;
        if !system.is_still_open(&corrected.state) {
            // Only the start is singular.
            return None;
        }
        let mut reached = self.directed(system, corrected, place, &mut None, work).ok()?;
        // Which sign it has hangs on the signs of what is added to hold the motions.
        reached.determinant = None;
        Some(reached)
    }

    /// A guess off the direction, where the path bends at once: along the arm of a parabola.
    pub(super) fn guess_beside(&self, place: Place<'_>) -> Option<State> {
        let (beside, Place::ArcLength { step, .. }) = (self.beside?, place) else { return None };
        let mut guess = self.state.advanced(self.rate, step);
        guess.advance(beside, step.sqrt());
        Some(guess)
    }
}
