//! A point on the branch of one contact mode at which a quantity is zero: the load rate at a smooth limit point, the event
//! function of a contact where it changes. Also the point of the branch at which another branch crosses it, where the
//! equations along the branch are singular.

use crate::branching::bifurcation::locate::singular_point::LocatedSingularity;
use crate::continuation::critical_curve::history::contact_history::PointGuess;
use crate::continuation::critical_curve::history::tolerances::{
    ACCEPTED_CORRECTION, LARGEST_CORRECTION, POINT_ROUND_OFF, ROUNDED_VALUE, SAME_BRANCH, UNFOLDED,
};
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::closing_equation::HyperplaneEquation;
use crate::mechanics::equations::corrected_point::Corrected;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::{newton, tangent};
use crate::step::event_functions::EventFunction;

/// Iterations along the branch.
const MOST_ITERATIONS: usize = 30;
/// Arc length over which the slope of a quantity is measured that has no slope of its own.
const DIFFERENCE: f64 = 1e-4;

/// A point of a branch.
#[derive(Debug, Clone)]
pub(crate) struct BranchPoint {
    pub state: State,
    /// The branch's direction there.
    pub rate: Rate,
    /// Modes with the directions of slip as they are there.
    pub modes: Vec<Mode>,
    pub residual: f64,
    /// At a bifurcation point the motion that becomes free.
    pub motion: Option<Rate>,
    /// How far branches that met at a bifurcation point pass each other; 0 where they meet, and at other points.
    pub unfolding: f64,
}

/// The branch of a mode, from the state in which the mode begins.
pub(crate) struct ModeBranch<'a> {
    pub loading: Loading<'a>,
    pub modes: &'a [Mode],
    pub anchor: &'a State,
    pub force_scale: f64,
}

impl ModeBranch<'_> {
    /// The point of the branch at which a quantity is zero, near a guess.
    ///
    /// Points of the branch lie in hyperplanes across its direction; where the quantity is zero along it is found by
    /// Newton's method, with the secant through the last two points where the quantity has no slope of its own.
    pub fn locate(&self, event: EventFunction, guess: &PointGuess, work: &mut Work) -> Option<BranchPoint> {
        let size = 1.0 + guess.state.distance(self.anchor);
        let value = |point: &BranchPoint| event.value(self.loading, self.modes, &point.state, &point.rate);
        let chord = guess.from.chord(&guess.state);
        let plane = HyperplaneEquation { from: &guess.state, rate: &guess.rate, step: 0.0 };
        let mut here = self.correct(&guess.state, plane, (&guess.from, &chord), work)?;
        let mut at = value(&here);
        let mut slope = match event.slope(self.loading, self.modes, &here.state, &here.rate) {
            Some(slope) => slope,
            None => {
                let beside = self.advanced(&here, DIFFERENCE, work)?;
                (value(&beside) - at) / DIFFERENCE
            }
        };
        let (mut best, mut least, mut left) = (here.clone(), f64::INFINITY, f64::INFINITY);
        let is_found = |least: f64, left: f64| least <= ACCEPTED_CORRECTION * size || left <= ROUNDED_VALUE;
        for _ in 0..MOST_ITERATIONS {
            let step = (-at / slope).clamp(-LARGEST_CORRECTION * size, LARGEST_CORRECTION * size);
            if !step.is_finite() {
                return None;
            }
            if step.abs() <= POINT_ROUND_OFF * size {
                return Some(here);
            }
            if step.abs() >= 0.5 * least && is_found(least, left) {
                // What remains is round-off.
                return Some(best);
            }
            if step.abs() < least {
                (least, left, best) = (step.abs(), at.abs(), here.clone());
            }
            let next = self.advanced(&here, step, work)?;
            let found = value(&next);
            slope = match event.slope(self.loading, self.modes, &next.state, &next.rate) {
                Some(slope) => slope,
                None if found == at => return is_found(least, left).then_some(best),
                None => (found - at) / step,
            };
            (here, at) = (next, found);
        }
        is_found(least, left).then_some(best)
    }

    /// The point at which another branch crosses this one, near a guess. Where the branches pass each other it is the point
    /// at which a small force would make them meet.
    pub fn locate_bifurcation(&self, guess: &PointGuess, work: &mut Work) -> Option<BranchPoint> {
        let system = ModeSystem::new(self.loading, self.modes, self.anchor);
        let size = 1.0 + guess.state.distance(self.anchor);
        let motion = guess.motion.clone().unwrap_or_else(|| any_motion(&guess.rate));
        let reach = LARGEST_CORRECTION * size;
        let near =
            LocatedSingularity::near(&system, guess.state.clone(), (&guess.rate, vec![motion]), (reach, &|_| true))?;
        (work.newton_iterations, work.factorisations) =
            (work.newton_iterations + near.iterations, work.factorisations + near.iterations);
        let corrected = newton::judged(&system, near.state.clone(), self.force_scale);
        let unfolding = near.unfolding.amax();
        let rate = match near.continued(&guess.rate, SAME_BRANCH) {
            Some(rate) => rate,
            // Branches that pass each other have no direction in common.
            None if unfolding > UNFOLDED => guess.rate.clone(),
            None => return None,
        };
        let motion = near.bordering.right.last().map(|right| near.bordering.rate(right))?;
        Some(BranchPoint {
            rate,
            residual: corrected.residual,
            modes: corrected.modes,
            state: corrected.state,
            motion: motion.normalised(),
            unfolding,
        })
    }

    /// The point of the branch in a plane through a state, with the value of a quantity there.
    pub fn in_plane(
        &self,
        event: EventFunction,
        guess: &PointGuess,
        plane: HyperplaneEquation<'_>,
        work: &mut Work,
    ) -> Option<(BranchPoint, f64)> {
        let chord = guess.from.chord(&guess.state);
        let mut found = self.correct(&guess.state, plane, (&guess.from, &chord), work)?;
        if found.rate.product(&guess.rate) < 0.0 {
            found.rate.scale(-1.0);
        }
        let value = event.value(self.loading, self.modes, &found.state, &found.rate);
        Some((found, value))
    }

    /// The direction of the branch at a state on it, closest to another direction.
    pub fn direction(&self, state: &State, towards: &Rate, work: &mut Work) -> Option<Rate> {
        let system = ModeSystem::new(self.loading, self.modes, self.anchor);
        let corrected = newton::judged(&system, state.clone(), self.force_scale);
        self.tangent(&system, &corrected, towards, work)
    }

    fn advanced(&self, from: &BranchPoint, step: f64, work: &mut Work) -> Option<BranchPoint> {
        let plane = HyperplaneEquation { from: &from.state, rate: &from.rate, step };
        self.correct(&from.state.advanced(&from.rate, step), plane, (&from.state, &from.rate), work)
    }

    /// The point of the branch in a plane, from a guess beside a converged point.
    fn correct(
        &self,
        guess: &State,
        plane: HyperplaneEquation<'_>,
        (point, chord): (&State, &Rate),
        work: &mut Work,
    ) -> Option<BranchPoint> {
        let system = ModeSystem::new(self.loading, self.modes, self.anchor).beside(point, chord);
        let guess = system.iterate(guess.clone());
        let corrected = newton::correct_from(&system, guess, &plane, self.force_scale, &mut None, work).ok()?;
        let rate = self.tangent(&system, &corrected, plane.rate, work)?;
        Some(BranchPoint {
            rate,
            residual: corrected.residual,
            modes: corrected.modes,
            state: corrected.state,
            motion: None,
            unfolding: 0.0,
        })
    }

    fn tangent(&self, system: &ModeSystem<'_>, corrected: &Corrected, towards: &Rate, work: &mut Work) -> Option<Rate> {
        let made = &mut work.factorisations;
        let mut rate = tangent::tangent_and_error(system, corrected, towards, &mut None, made)?.rate;
        if rate.product(towards) < 0.0 {
            rate.scale(-1.0);
        }
        Some(rate)
    }
}

/// A motion with a component in every direction, the same in every run, for the first search.
fn any_motion(like: &Rate) -> Rate {
    let mut motion = like.clone();
    motion.scale(0.0);
    let components = motion.displacement.iter_mut().enumerate();
    components.for_each(|(freedom, value)| *value = 0.5 + ((freedom * 7) % 13) as f64 / 13.0);
    motion
}
