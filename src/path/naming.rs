//! Where the MPEC names the mode: every increment of `method: "mpec"`, and the direction taken where a mode ends.

use super::corner::agree;
use super::decide::Choice;
use super::program::{IncrementProgram, Named};
use super::standing::ZERO;
use super::state::{Rate, State};
use super::tracer::Path;
use super::watch;
use crate::contact::Mode;
use crate::mpec::Problem;

/// Arc length at which a direction is first put to the program, as a fraction of the path's next step.
const FIRST_TRIAL: f64 = 0.25;
/// The part of the way to the next change of a contact that it may go.
const WITHIN: f64 = 0.5;
/// Arc length below which changes are not told apart by the program, whose products end at a relaxation of 1e-8.
const RESOLVED: f64 = 1e-8;
/// How often that arc length is shortened until the program names the direction's own mode.
const TRIALS: usize = 5;

impl Path<'_> {
    /// Whether the program, started along the present direction, ends in the present mode.
    ///
    /// Its increment has about the arc length asked for, not exactly; where it names another mode, it may have gone past
    /// the end of this one, and is asked again for shorter increments.
    pub(super) fn program_keeps_mode(&mut self, rate: &Rate, step: f64) -> bool {
        let modes = self.at.here.modes.clone();
        let state = self.at.here.state.clone();
        let mut tried = step;
        for _ in 0..TRIALS {
            let named = self.name(&state, rate, &modes, tried);
            if named.is_some_and(|named| agree(self.loading(), &named.modes, &modes)) {
                return true;
            }
            tried *= 0.3;
        }
        false
    }

    /// Arc length to the first change of a contact along a direction, to first order: an increment that goes on past it
    /// ends in another mode. Infinite where none is ahead.
    fn way_to_next_change(&self, modes: &[Mode], rate: &Rate) -> f64 {
        let (loading, state) = (self.loading(), &self.at.here.state);
        let forces = self.at.totals.force_scale;
        watch::of_mode(loading, modes, state, rate)
            .into_iter()
            .filter_map(|watch| {
                let value = watch.value(loading, modes, state, rate);
                let slope = watch.slope(loading, state, rate)?;
                // What is zero here is not ahead.
                (value > ZERO * watch.scale(loading, state, forces) && slope < 0.0).then(|| value / -slope)
            })
            .fold(f64::INFINITY, f64::min)
    }

    fn name(&mut self, base: &State, expected: &Rate, modes: &[Mode], step: f64) -> Option<Named> {
        let loading = self.loading();
        let ahead = base.advanced(expected, step);
        let reactions = ahead.reactions.iter().fold(0.0_f64, |largest, reaction| largest.max(reaction.size()));
        let force = self.at.totals.force_scale.max(ahead.load.abs()).max(reactions).max(f64::MIN_POSITIVE);
        let mut program = IncrementProgram::new(loading, base, expected, step, force);
        if program.pairs() == 0 {
            // No contact can be reached: there is nothing to decide.
            return Some(Named {
                modes: modes.to_vec(),
                #[cfg(test)]
                end: None,
            });
        }
        let start = program.variables_at(expected);
        let (named, counts) = program.name(&start, modes, &self.cancel);
        self.at.totals.work.qp_solves += counts.qp_solves;
        self.at.totals.work.mpec_solves += counts.mpec_solves;
        named
    }

    /// Whether the program confirms a direction at the present point: started along it, it ends in the direction's own
    /// mode. Not where the next change is too near for the program to tell.
    ///
    /// The forward term rewards the direction that is tried, not the one in which the path came: where the path turns
    /// against its past (a contact closes, the load turns), that term would hold the increment back at zero.
    pub(super) fn is_confirmed_by_program(&mut self, choice: &Choice) -> bool {
        let within = WITHIN * self.way_to_next_change(&choice.modes, &choice.rate);
        if within < RESOLVED {
            return false;
        }
        let state = self.at.here.state.clone();
        let mut step = (FIRST_TRIAL * self.at.step).min(within);
        for _ in 0..TRIALS {
            let named = self.name(&state, &choice.rate, &choice.modes, step);
            if named.is_some_and(|named| agree(self.loading(), &named.modes, &choice.modes)) {
                return true;
            }
            step *= 0.1;
        }
        false
    }
}
