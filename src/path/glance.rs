//! One iteration of Newton's method on the equations of a mode (`mode_system`): about where it leads, off by the square of
//! how far the guess was.

use super::advance::Work;
use super::mode_system::{Kind, ModeSystem};
use super::newton::Place;
use super::state::{Rate, State};
use crate::linear_algebra::{Sink, SystemFactorisation};
use nalgebra::DVector;

impl ModeSystem<'_> {
    /// The state after one iteration from a guess, with the factorisation of the equations at the guess; `None` where they
    /// are singular there.
    pub(super) fn iterated_once(
        &self,
        guess: State,
        place: Place<'_>,
        work: &mut Work,
    ) -> Option<(State, SystemFactorisation)> {
        let mut iterate = self.iterate(guess);
        self.make_consistent(&mut iterate);
        let mut values = DVector::zeros(self.size());
        let mut force = vec![0.0; self.loading.structure.freedoms()];
        self.residual(&iterate, &mut values, &mut force);
        let last = self.size() - 1;
        values[last] = self.place(&iterate.state, place, None);
        let put_place = |matrix: &mut dyn Sink| {
            self.place(&iterate.state, place, Some(matrix));
        };
        work.factorisations += 1;
        work.newton_iterations += 1;
        let factorisation = self.factorise(&iterate, Kind::Increment, put_place)?;
        if !factorisation.solve_once(&mut values) || !values.iter().all(|value| value.is_finite()) {
            return None;
        }
        Some((self.corrected_by(iterate, &values).state, factorisation))
    }

    /// About the path's direction, by a factorisation of the equations nearby, on the side of another.
    pub(super) fn direction_about(
        &self,
        state: &State,
        factorisation: &SystemFactorisation,
        towards: &Rate,
    ) -> Option<Rate> {
        let mut values = self.bordering();
        if !factorisation.solve_once(&mut values) {
            return None;
        }
        let mut rate = self.direction_from(&self.iterate(state.clone()), &values)?;
        if rate.product(towards) < 0.0 {
            rate.scale(-1.0);
        }
        Some(rate)
    }
}
