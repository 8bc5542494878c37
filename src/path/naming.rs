//! Where the MPEC names the mode: every increment of `method: "mpec"`, and the direction taken where a mode ends.
//!
//! The point that the path has reached is shown to solve the increment's program, without a quadratic program; where it
//! is not, the program is solved from the direction at hand.

use super::advance::{Reached, Start};
use super::corner::agree;
use super::decide::Choice;
use super::loading::Loading;
use super::program::{Arrived, Counts, Foreseen, IncrementProgram, Named};
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
/// How often the whole program is asked, for shorter and shorter increments.
const TRIALS: usize = 3;
/// By how much the arc length is shortened where nothing says how far the mode holds, and at most.
const SHORTER: f64 = 0.1;
const SHORTEST: f64 = 1e-3;
/// Arc length below which a reaction that has just left a boundary may still be there within the program's tolerance.
const NEAR: f64 = 1e-5;

impl Path<'_> {
    /// Whether the program, started along the present direction, ends in the present mode; up to an event, on the way there.
    pub(super) fn program_keeps_mode(&mut self, rate: &Rate, reached: &Reached, step: f64) -> bool {
        let modes = self.at.here.modes.clone();
        if self.is_shown(rate, &modes, reached) {
            return true;
        }
        let way = if reached.event.is_some() { WITHIN * reached.step } else { step };
        // So near to the event the program tells nothing apart.
        way < RESOLVED || self.is_named(rate, &modes, way, true)
    }

    fn start<'a>(&'a self, rate: &'a Rate, modes: &'a [Mode]) -> Start<'a> {
        let (here, force_scale) = (&self.at.here, self.at.totals.force_scale);
        Start {
            loading: self.loading(),
            state: &here.state,
            rate,
            modes,
            drift: None,
            force_scale,
            is_singular: here.is_singular,
            beside: here.beside.as_ref(),
        }
    }

    /// What the point of a mode at an arc length shows of its increment's program.
    fn show(&mut self, rate: &Rate, modes: &[Mode], way: f64) -> Foreseen {
        let mut work = self.at.totals.work;
        let reached = self.start(rate, modes).reach(way, &mut work);
        self.at.totals.work = work;
        reached.map_or(Foreseen::Unclear, |reached| self.show_at(rate, modes, &reached))
    }

    /// What a point reached in a mode shows of its increment's program.
    fn show_at(&mut self, rate: &Rate, modes: &[Mode], reached: &Reached) -> Foreseen {
        if reached.determinant.is_none() || reached.step <= 0.0 {
            return Foreseen::Unclear;
        }
        let ends = (&self.at.here.state, &reached.corrected.state);
        let program = Self::program(self.loading(), self.at.totals.force_scale, ends, rate, reached.step);
        let Some(mut program) = program else { return Foreseen::Named(Named::of(modes)) };
        let end = Arrived { state: ends.1, rate: &reached.rate, error: reached.error_estimate };
        let foreseen = program.solved_at(end, modes);
        self.at.totals.work.certificates += u64::from(matches!(foreseen, Foreseen::Named(_)));
        foreseen
    }

    /// Whether a point reached in a mode is shown to solve the program of its increment: nothing is left to search.
    fn is_shown(&mut self, rate: &Rate, modes: &[Mode], reached: &Reached) -> bool {
        let foreseen = self.show_at(rate, modes, reached);
        self.is_of(&foreseen, modes)
    }

    /// The same of the point at an arc length.
    fn is_shown_within(&mut self, rate: &Rate, modes: &[Mode], way: f64) -> bool {
        let foreseen = self.show(rate, modes, way);
        self.is_of(&foreseen, modes)
    }

    /// Whether these modes are named.
    fn is_of(&self, foreseen: &Foreseen, modes: &[Mode]) -> bool {
        matches!(foreseen, Foreseen::Named(named) if agree(self.loading(), &named.modes, modes))
    }

    /// Whether the program, started along a direction, ends in the direction's own mode.
    ///
    /// Its increment has about the arc length asked for, not exactly; where it names another mode, it may have gone past
    /// the end of this one, and is asked again for shorter increments. First the point of the mode is looked at: as a rule
    /// it is shown to solve the program. Then the branch of the direction's mode alone is
    /// solved: where it holds, it is the program's solution, and where it ends, it says how far it goes. The whole program
    /// has the word where that does not settle it; `untold` is the answer where no program can tell.
    fn is_named(&mut self, rate: &Rate, modes: &[Mode], step: f64, untold: bool) -> bool {
        let state = self.at.here.state.clone();
        if self.scene.structure.dimension == 3 {
            // A cone may bind a branch that holds.
            return self.is_named_by_whole(&state, rate, modes, step);
        }
        if untold && step <= NEAR {
            // So near to where contacts change no answer of a search would count against the mode.
            return true;
        }
        let mut tried = step;
        while tried >= RESOLVED {
            match self.show(rate, modes, tried) {
                shown if self.is_of(&shown, modes) => return true,
                Foreseen::EndsAfter(part) => {
                    tried *= WITHIN * part;
                    continue;
                }
                Foreseen::Named(_) | Foreseen::Untold | Foreseen::Unclear => {}
            }
            match self.foresee(&state, rate, modes, tried) {
                Foreseen::Named(named) if agree(self.loading(), &named.modes, modes) => return true,
                Foreseen::EndsAfter(part) => tried *= WITHIN * part.clamp(SHORTEST, 1.0),
                Foreseen::Named(_) | Foreseen::Unclear => tried *= SHORTER,
                Foreseen::Untold if tried <= NEAR => return untold,
                Foreseen::Untold => return self.is_named_by_whole(&state, rate, modes, tried),
            }
        }
        // So near to where contacts change the whole program tells no more than its branch.
        if step <= NEAR { untold } else { self.is_named_by_whole(&state, rate, modes, RESOLVED) }
    }

    /// The same by the whole program, all branches of it.
    fn is_named_by_whole(&mut self, state: &State, rate: &Rate, modes: &[Mode], step: f64) -> bool {
        let mut tried = step;
        for _ in 0..TRIALS {
            let named = self.name(state, rate, modes, tried);
            if named.is_some_and(|named| agree(self.loading(), &named.modes, modes)) {
                return true;
            }
            tried *= SHORTER;
        }
        false
    }

    /// Whether the program, started along the present direction, ends in these modes: contacts change within the step.
    pub(super) fn program_joins_changes(&mut self, rate: &Rate, step: f64, end: &[Mode]) -> bool {
        let (state, modes) = (self.at.here.state.clone(), self.at.here.modes.clone());
        let named = self.name(&state, rate, &modes, step);
        named.is_some_and(|named| agree(self.loading(), &named.modes, end))
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
                let slope = watch.slope(loading, modes, state, rate)?;
                // What is zero here is not ahead.
                (value > ZERO * watch.scale(loading, state, forces) && slope < 0.0).then(|| value / -slope)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// The increment's program from a state to about another; `None` where no contact can be reached: there is nothing to
    /// decide.
    pub(super) fn program<'a>(
        loading: Loading<'a>,
        force_scale: f64,
        (base, ahead): (&'a State, &State),
        expected: &'a Rate,
        step: f64,
    ) -> Option<IncrementProgram<'a>> {
        let program = Self::increment_program(loading, force_scale, (base, ahead), expected, step);
        (program.pairs() > 0).then_some(program)
    }

    /// The same, whether or not a contact can be reached.
    pub(super) fn increment_program<'a>(
        loading: Loading<'a>,
        force_scale: f64,
        (base, ahead): (&'a State, &State),
        expected: &'a Rate,
        step: f64,
    ) -> IncrementProgram<'a> {
        let reactions = ahead.reactions.iter().fold(0.0_f64, |largest, reaction| largest.max(reaction.size()));
        let force = force_scale.max(ahead.load.abs()).max(reactions).max(f64::MIN_POSITIVE);
        IncrementProgram::new(loading, base, expected, step, force)
    }

    fn name(&mut self, base: &State, expected: &Rate, modes: &[Mode], step: f64) -> Option<Named> {
        let ahead = base.advanced(expected, step);
        let program = Self::program(self.loading(), self.at.totals.force_scale, (base, &ahead), expected, step);
        let Some(mut program) = program else { return Some(Named::of(modes)) };
        let start = program.variables_at(expected);
        let (named, counts) = program.name(&start, modes, &self.cancel);
        self.count(counts);
        named
    }

    fn foresee(&mut self, base: &State, expected: &Rate, modes: &[Mode], step: f64) -> Foreseen {
        let ahead = base.advanced(expected, step);
        let program = Self::program(self.loading(), self.at.totals.force_scale, (base, &ahead), expected, step);
        let Some(mut program) = program else { return Foreseen::Named(Named::of(modes)) };
        let start = program.variables_at(expected);
        let (foreseen, counts) = program.foresee(&start, modes, &self.cancel);
        self.count(counts);
        foreseen
    }

    pub(super) fn count(&mut self, counts: Counts) {
        let totals = &mut self.at.totals;
        totals.work.qp_solves += counts.qp_solves;
        totals.work.mpec_solves += counts.mpec_solves;
        totals.work.sqp_iterations += counts.sqp_iterations;
        totals.last_relaxation = counts.last_relaxation.or(totals.last_relaxation);
    }

    /// Whether the program confirms a direction at the present point: started along it, it ends in the direction's own
    /// mode. Not where the next change is too near for the program to tell.
    ///
    /// The forward term rewards the direction that is tried, not the one in which the path came: where the path turns
    /// against its past (a contact closes, the load turns), that term would hold the increment back at zero.
    ///
    /// Changes come in clusters: what is tried first goes no further than the `last` step did.
    pub(super) fn is_confirmed_by_program(&mut self, choice: &Choice, last: f64) -> bool {
        let within = WITHIN * self.way_to_next_change(&choice.modes, &choice.rate);
        let first = (FIRST_TRIAL * self.at.step).min(within);
        let soon = last.max(RESOLVED);
        within >= RESOLVED
            && (soon < first && self.is_shown_within(&choice.rate, &choice.modes, soon)
                || self.is_named(&choice.rate, &choice.modes, first, false))
    }
}
