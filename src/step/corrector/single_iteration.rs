//! One iteration of Newton's method on the equations of a mode (`equations`): an approximate solution, whose error is
//! of second order in the error of the guess.

use crate::algebra::SystemFactorisation;
use crate::algebra::dense::matrix_sink::Sink;
use crate::mechanics::equations::closing_equation::ClosingEquation;
use crate::mechanics::equations::{Kind, ModeSystem, mode_factorisation, rate_recovery, residual};
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use nalgebra::DVector;

/// The state after one iteration from a guess, with the factorisation of the equations at the guess; `None` where they
/// are singular there.
pub(crate) fn iterated_once(
    system: &ModeSystem<'_>,
    guess: State,
    closing: &dyn ClosingEquation,
    work: &mut Work,
) -> Option<(State, SystemFactorisation)> {
    let mut iterate = system.iterate(guess);
    residual::make_consistent(system, &mut iterate);
    system.begin_iteration(&mut iterate);
    let mut values = DVector::zeros(system.size());
    let mut force = vec![0.0; system.loading.structure.freedoms()];
    residual::write_residual(system, &iterate, &mut values, &mut force);
    residual::make_mixed(system, &iterate, &mut values, &mut force);
    let last = system.size() - 1;
    values[last] = closing.value(system, &iterate.state);
    let put_closing = |matrix: &mut dyn Sink| closing.write_gradient(system, &iterate.state, matrix);
    work.factorisations += 1;
    work.newton_iterations += 1;
    let factorisation = mode_factorisation::factorise(system, &iterate, Kind::Increment, put_closing)?;
    if !factorisation.solve_once(&mut values) || !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    Some((rate_recovery::corrected_by(system, iterate, &values).state, factorisation))
}

/// The approximate direction of the path, from a factorisation of the equations nearby, on the side of `towards`.
pub(crate) fn direction_about(
    system: &ModeSystem<'_>,
    state: &State,
    factorisation: &SystemFactorisation,
    towards: &Rate,
) -> Option<Rate> {
    let mut values = rate_recovery::bordering(system);
    if !factorisation.solve_once(&mut values) {
        return None;
    }
    let mut rate = rate_recovery::direction_from(system, &system.iterate(state.clone()), &values)?;
    if rate.product(towards) < 0.0 {
        rate.scale(-1.0);
    }
    Some(rate)
}
