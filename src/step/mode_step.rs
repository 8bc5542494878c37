//! One step along the current mode, ended early by the first event.

use crate::algebra::SystemFactorisation;
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::closing_equation::{ArcLengthEquation, ClosingEquation};
use crate::mechanics::equations::corrected_point::{Corrected, Failure, Tangent};
use crate::mechanics::equations::slip_turn_update::{self, SettlingPasses};
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::slip_error;
use crate::step::corrector::slip_error::Pointed;
use crate::step::corrector::tangent;
use crate::step::event_functions::{self, EventFunction};
use crate::step::event_location;
use crate::step::event_location::StepPoints;
use crate::step::interpolation::PlacedPoint;
use crate::step::singular_step;
use crate::step::tolerances::{
    BOUND_TOLERANCE, COINCIDENCE_TOLERANCE, LARGEST_TURN, LARGEST_TURN_CORRECTION, LOAD_RATE_ROUNDING, SETTLED_ANGLE,
    SMALLEST_COSINE,
};

/// The start of a step.
#[derive(Clone, Copy)]
pub struct StepStart<'a> {
    pub loading: Loading<'a>,
    pub state: &'a State,
    /// The path's direction in `modes`.
    pub rate: &'a Rate,
    pub modes: &'a [Mode],
    /// Error of the path so far, where it has a discretisation error.
    pub drift: Option<&'a Rate>,
    pub force_scale: f64,
    /// Whether the equations have another null vector besides the direction: see `singular_step`.
    pub is_singular: bool,
    /// Deviation of the path from the direction in this case: see `choice::DirectionChoice`.
    pub beside: Option<&'a Rate>,
}

/// A point reached by a step.
#[derive(Debug, Clone)]
pub struct Reached {
    pub corrected: Corrected,
    /// The path's direction at the point, in the mode that led to it.
    pub rate: Rate,
    pub step: f64,
    /// Distance to the path (dimensionless).
    pub error_estimate: f64,
    /// Error of the path up to the point, where it has a discretisation error.
    pub drift: Option<Rate>,
    /// The event that ended the step early.
    pub event: Option<EventFunction>,
    /// Sign of the bordered determinant at the point, where it is certain.
    pub determinant: Option<f64>,
    /// The contact whose slip ends with the step, where its speed falls through zero.
    pub stopped: Option<usize>,
    /// A factorisation of the equations nearby.
    pub nearby: CachedFactorisation,
    /// Number of motions that share the limit point, where there are several; else 0.
    pub motions: usize,
}

impl Reached {
    /// A point without event; boxed, since it is passed on many times.
    pub(crate) fn new(corrected: Corrected, rate: Rate, step: f64, error_estimate: f64) -> Box<Self> {
        let (drift, event, determinant, stopped, nearby) = (None, None, None, None, CachedFactorisation::default());
        let motions = 0;
        Box::new(Self { corrected, rate, step, error_estimate, drift, event, determinant, stopped, nearby, motions })
    }
}

/// Locates a limit point at which the equations of the mode are singular, from the point past it.
pub type LocateSingularLimit = fn(&StepStart<'_>, EventFunction, &Reached, &mut Work) -> Option<Box<Reached>>;

/// The event functions of a trial step, at whose end some may be negative.
pub(crate) struct StepEvents {
    pub functions: Vec<EventFunction>,
    /// The event functions that are negative at the end.
    pub passed: Vec<EventFunction>,
    /// The points of the step, where an event is passed.
    pub stretch: Option<Box<StepPoints>>,
    /// The event function that is zero at the end, where its zero was solved for.
    pub met: Option<EventFunction>,
}

/// The reason why a step has to be shorter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refused {
    Newton(Failure),
    /// The direction turned by this angle (radians).
    Turned(f64),
    /// An event lies at the start itself.
    AtStart(EventFunction),
    /// The point reached violates the laws of contact and friction.
    Unlawful,
    /// A bar would shrink to a point.
    Collapsed,
    /// The signature of the equations changed or is uncertain, and no bifurcation point was located.
    Unresolved,
    /// Contact changes that were to be taken together cannot be joined.
    Apart,
}

/// Largest number of solves of an increment in which directions of slip settle.
const MOST_PASSES: u64 = 32;
/// Number of such solves in which the largest angle left has to be halved.
const MOST_IDLE_PASSES: u64 = 8;
/// Largest number of zeros and dips located in one step, each nearer to the start than the one before.
const MOST_LOOKS: usize = 32;

/// Refuses a turn by more than [`LARGEST_TURN`].
pub(crate) fn may_turn(cosine: f64) -> Result<(), Refused> {
    if cosine < SMALLEST_COSINE { Err(Refused::Turned(cosine.clamp(-1.0, 1.0).acos())) } else { Ok(()) }
}

impl StepStart<'_> {
    /// The point at an arc length, with its direction.
    pub fn reach(&self, step: f64, work: &mut Work) -> Result<Box<Reached>, Refused> {
        self.reach_near(self.state.advanced(self.rate, step), step, work)
    }

    /// The point at an arc length, from a guess.
    pub fn reach_near(&self, guess: State, step: f64, work: &mut Work) -> Result<Box<Reached>, Refused> {
        self.reach_by(guess, step, &mut None, work)
    }

    /// As [`reach_near`](Self::reach_near), with a factorisation of the equations nearby, if there is one; `serving`
    /// becomes the last factorisation.
    pub(crate) fn reach_by(
        &self,
        guess: State,
        step: f64,
        serving: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Result<Box<Reached>, Refused> {
        let system = ModeSystem::new(self.loading, self.modes, self.state);
        self.settle_by(system, guess, &ArcLengthEquation { from: self.state, step }, serving, work)
    }

    pub(crate) fn settle(
        &self,
        system: ModeSystem<'_>,
        guess: State,
        closing: &dyn ClosingEquation,
        work: &mut Work,
    ) -> Result<Box<Reached>, Refused> {
        self.settle_by(system, guess, closing, &mut None, work)
    }

    pub(crate) fn settle_by<'a>(
        &'a self,
        mut system: ModeSystem<'a>,
        guess: State,
        closing: &dyn ClosingEquation,
        serving: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Result<Box<Reached>, Refused> {
        if let Some(reached) = singular_step::held_straight(self, &system, closing) {
            return Ok(reached);
        }
        if let Some(reached) = singular_step::held_across(self, &guess, closing, work) {
            return Ok(reached);
        }
        let guess = singular_step::guess_beside(self, closing).unwrap_or(guess);
        system = system.along(self.rate);
        slip_turn_update::mark_loose(&mut system, self.rate);
        let corrected = newton::correct_from(&system, system.iterate(guess), closing, self.force_scale, serving, work)
            .map_err(Refused::Newton)?;
        self.directed(system, corrected, closing, serving, work)
    }

    /// A converged point with the path's direction there.
    pub(crate) fn directed(
        &self,
        mut system: ModeSystem<'_>,
        mut corrected: Corrected,
        closing: &dyn ClosingEquation,
        serving: &mut Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Result<Box<Reached>, Refused> {
        let singular = Refused::Newton(Failure::Singular);
        let mut tangent = tangent::tangent_and_error(&system, &corrected, self.rate, serving, &mut work.factorisations)
            .ok_or(singular)?;
        if system.has_tracks() {
            // Solve again, now that the turn of the slips at the end is known; where directions settle, until they
            // have.
            let mut is_last = !slip_turn_update::set_turns(&mut system, self.rate, &corrected, &tangent);
            let mut passes = SettlingPasses::default();
            let (mut least, mut found_at) = (f64::INFINITY, 0);
            for pass in 1.. {
                let again = newton::correct_from(
                    &system,
                    system.iterate_of(&corrected),
                    closing,
                    self.force_scale,
                    &mut None,
                    work,
                )
                .map_err(Refused::Newton)?;
                // The first solve shows how difficult the increment is.
                let hardness = corrected.iterations_to_small;
                corrected = again;
                corrected.iterations_to_small = hardness;
                let factorisations = &mut work.factorisations;
                tangent = tangent::tangent_and_error(&system, &corrected, self.rate, &mut None, factorisations)
                    .ok_or(singular)?;
                if is_last {
                    break;
                }
                let (settles, unsettled) = passes.advance(&mut system, self.rate, &corrected, &tangent);
                // What the last solve leaves is far below this: the estimate of the error compares two such ends.
                is_last = !settles || unsettled <= SETTLED_ANGLE;
                if unsettled <= 0.5 * least {
                    (least, found_at) = (unsettled, pass);
                }
                if !is_last && (pass == MOST_PASSES || pass - found_at >= MOST_IDLE_PASSES) {
                    return Err(Refused::Newton(Failure::NotConverged));
                }
            }
            let turn = slip_turn_update::largest_turn(&system, &corrected);
            if turn > LARGEST_TURN {
                return Err(Refused::Turned(turn));
            }
            // The series is no longer valid where the turn changes much within the step.
            let correction = slip_turn_update::largest_correction(&system, &corrected);
            if correction > LARGEST_TURN_CORRECTION {
                return Err(Refused::Turned(correction));
            }
        }
        let Tangent { rate, error: error_estimate, determinant, .. } = tangent;
        let step = corrected.state.distance(self.state);
        // The sphere around the start also meets the path behind, and may meet other branches: the chord has to point
        // along both directions.
        let cosine = |rate: &Rate| self.state.cosine_of_chord(&corrected.state, step, rate);
        may_turn(cosine(self.rate).min(cosine(&rate)))?;
        let mut reached = Reached::new(corrected, rate, step, error_estimate);
        reached.determinant = determinant;
        reached.nearby = CachedFactorisation::shared(serving.as_ref());
        Ok(reached)
    }

    /// A converged point of a straight path, which keeps its direction.
    pub(crate) fn straight_on(&self, corrected: Corrected, error_estimate: f64) -> Box<Reached> {
        let (rate, step) = (self.rate.clone(), corrected.state.distance(self.state));
        Reached::new(corrected, rate, step, error_estimate)
    }

    /// A step of a given arc length, or to the first event before its end.
    ///
    /// `ends` are the ends of the stage; `load_sign` is the sign of the load rate along the path at the start;
    /// `singular_limit` locates limit points at which the equations are singular.
    pub fn advance(
        &self,
        step: f64,
        ends: &[End],
        load_sign: f64,
        singular_limit: LocateSingularLimit,
        work: &mut Work,
    ) -> Result<Box<Reached>, Refused> {
        let (reached, events) = self.attempt(step, None, None, ends, load_sign, work)?;
        self.stop_at_event(reached, events, ends, singular_limit, work)
    }

    /// A trial step of an arc length, with the events that it passes. `before` is the point before the start in the
    /// same modes, if there is one, and `serving` a factorisation of the equations nearby.
    pub(crate) fn attempt(
        &self,
        step: f64,
        before: Option<&PlacedPoint>,
        mut serving: Option<SystemFactorisation>,
        ends: &[End],
        load_sign: f64,
        work: &mut Work,
    ) -> Result<(Box<Reached>, StepEvents), Refused> {
        let foreseen = before.and_then(|before| before.foresee(self.state, self.rate, step));
        let guess = foreseen.unwrap_or_else(|| self.state.advanced(self.rate, step));
        let mut system = ModeSystem::new(self.loading, self.modes, self.state);
        system.may_be_shorter = true;
        let closing = ArcLengthEquation { from: self.state, step };
        let mut reached = self.settle_by(system, guess, &closing, &mut serving, work)?;
        may_turn(self.rate.product(&reached.rate))?;
        let event_functions = self.event_functions(ends, load_sign);
        let mut passed = self.passed(&event_functions, &reached);
        let mut stretch = (!passed.is_empty()).then(|| Box::new(StepPoints::new(self, &reached, serving.take())));
        if stretch.is_none() {
            (passed, stretch) = self.dips(&event_functions, &mut reached, serving, work)?;
        }
        Ok((reached, StepEvents { functions: event_functions, passed, stretch, met: None }))
    }

    /// The event functions that may end a step.
    pub(crate) fn event_functions(&self, ends: &[End], load_sign: f64) -> Vec<EventFunction> {
        let mut event_functions = event_functions::of_mode(self.loading, self.modes, self.state, self.rate);
        if load_sign != 0.0 {
            event_functions.push(EventFunction::LoadRate { sign: load_sign });
        }
        event_functions.extend(ends.iter().map(|end| EventFunction::End(*end)));
        event_functions
    }

    /// Ends a step at the first event in it.
    pub(crate) fn stop_at_event(
        &self,
        mut reached: Box<Reached>,
        events: StepEvents,
        ends: &[End],
        singular_limit: LocateSingularLimit,
        work: &mut Work,
    ) -> Result<Box<Reached>, Refused> {
        let StepEvents { functions: event_functions, mut passed, mut stretch, met } = events;
        // The first solve shows how difficult the step is.
        let hardness = reached.corrected.iterations_to_small;
        // Each round finds the first zero of one quantity; any other that is negative there has its zero before.
        let mut event = met;
        let mut looks = 0..MOST_LOOKS;
        // A point that was solved for as a zero has already been checked for earlier events.
        let mut is_clear = met.is_some() && passed.is_empty();
        while !is_clear {
            while let Some(stretch) = &mut stretch
                && let Some(&event_function) = event_location::earliest(self, &passed, stretch, |event_function| {
                    self.zero(event_function, &reached)
                })
            {
                // Quantities that are only round-off would alternate.
                looks.next().ok_or(Refused::Newton(Failure::NotConverged))?;
                let located =
                    event_location::locate(self, event_function, stretch, self.zero(event_function, &reached), work);
                reached = match event_function {
                    EventFunction::LoadRate { .. } => {
                        self.alone_or_common(located, event_function, &reached, singular_limit, work)?
                    }
                    _ => located?,
                };
                event = Some(event_function);
                passed = self.passed(&event_functions, &reached);
                passed.retain(|other| *other != event_function);
            }
            // A quantity that was negative inside the step, but is not where another falls to zero, has its zero
            // before. Over a short distance the changes of the integrals of rates are round-off.
            let Some(found) = event.filter(|_| reached.step.powi(3) > f64::EPSILON) else { break };
            let others: Vec<EventFunction> = event_functions.iter().copied().filter(|other| *other != found).collect();
            let (dipped, inside) = self.dips(&others, &mut reached, None, work)?;
            is_clear = dipped.is_empty();
            if !is_clear {
                looks.next().ok_or(Refused::Newton(Failure::NotConverged))?;
                (passed, stretch) = (dipped, inside);
            }
        }
        if event.is_none() {
            // A step may end exactly where the stage does.
            event = ends.iter().map(|end| EventFunction::End(*end)).find(|event_function| {
                self.value(*event_function, &reached.corrected.state, &reached.rate) <= BOUND_TOLERANCE
            });
        }
        if matches!(event, None | Some(EventFunction::LoadRate { .. })) {
            // A contact may reach the end of its mode exactly where the step ends, or at the limit point itself: the
            // contact change takes precedence.
            event = self.coinciding(&event_functions, &reached).or(event);
        }
        if let Some(EventFunction::End(end)) = event {
            reached = self.hold_exactly(end, reached, work)?;
        }
        reached.event = event;
        reached.stopped = match (event, &stretch) {
            (Some(event_function @ EventFunction::Sliding(contact)), Some(stretch)) => {
                event_location::falls_through(self, event_function, stretch, &reached).then_some(contact)
            }
            _ => None,
        };
        reached.corrected.iterations_to_small = hardness;
        reached.drift = self.drift_at(&reached, work);
        reached.error_estimate += reached.drift.as_ref().map_or(0.0, Rate::size);
        Ok(reached)
    }

    /// A limit point as located, or, where its equations are singular, as the limit point that several motions share.
    fn alone_or_common(
        &self,
        located: Result<Box<Reached>, Refused>,
        event_function: EventFunction,
        end: &Reached,
        singular_limit: LocateSingularLimit,
        work: &mut Work,
    ) -> Result<Box<Reached>, Refused> {
        let is_regular = located.as_ref().is_ok_and(|located| located.determinant.is_some());
        let common = if is_regular { None } else { singular_limit(self, event_function, end, work) };
        common.map_or(located, Ok)
    }

    /// The error of the path at a point reached, where it has a discretisation error.
    fn drift_at(&self, reached: &Reached, work: &mut Work) -> Option<Rate> {
        let mut modes = self.modes.iter().zip(self.loading.contacts);
        if self.drift.is_none() && !modes.any(|(mode, contact)| mode.is_active() && contact.tangents() > 1) {
            return None;
        }
        let mut system = ModeSystem::new(self.loading, self.modes, self.state);
        if self.drift.is_none() && !system.has_tracks() {
            return None;
        }
        let end = Pointed { corrected: &reached.corrected, rate: &reached.rate };
        let before = self.drift;
        let drift = if system.has_tracks() {
            let factorisations = &mut work.factorisations;
            let tangent =
                tangent::tangent_and_error(&system, &reached.corrected, self.rate, &mut None, factorisations)?;
            slip_turn_update::mark_loose(&mut system, self.rate);
            slip_turn_update::set_turns(&mut system, self.rate, &reached.corrected, &tangent);
            let middle = self.reach(0.5 * reached.step, work).ok()?;
            slip_error::drift(
                &system,
                self.rate,
                before,
                Pointed { corrected: &middle.corrected, rate: &middle.rate },
                end,
            )
        } else {
            slip_error::drift(&system, self.rate, before, end, end)
        };
        work.factorisations += 1;
        drift.or_else(|| before.cloned())
    }

    pub(crate) fn value(&self, event_function: EventFunction, state: &State, rate: &Rate) -> f64 {
        event_function.value(self.loading, self.modes, state, rate)
    }

    pub(crate) fn zero(&self, event_function: EventFunction, reached: &Reached) -> f64 {
        let is_flat = [self.rate.load, reached.rate.load].iter().all(|rate| rate.abs() <= LOAD_RATE_ROUNDING);
        if is_flat && matches!(event_function, EventFunction::LoadRate { .. }) {
            return LOAD_RATE_ROUNDING;
        }
        let force_scale = self.force_scale.max(reached.corrected.force_scale);
        event_function.zero(self.loading, &reached.corrected.state, force_scale)
    }

    pub(crate) fn passed(&self, event_functions: &[EventFunction], reached: &Reached) -> Vec<EventFunction> {
        let negative = |event_function: &EventFunction| {
            let value = self.value(*event_function, &reached.corrected.state, &reached.rate);
            value < 0.0 && value < -self.zero(*event_function, reached)
        };
        event_functions.iter().copied().filter(negative).collect()
    }

    /// A contact quantity that has fallen to zero at the point reached.
    fn coinciding(&self, event_functions: &[EventFunction], reached: &Reached) -> Option<EventFunction> {
        event_functions.iter().copied().filter(|event_function| event_function.is_of_contact()).find(|event_function| {
            let forces = self.force_scale.max(reached.corrected.force_scale);
            let state = &reached.corrected.state;
            let last = self.value(*event_function, state, &reached.rate);
            !event_function.is_above_zero(self.loading, state, last, COINCIDENCE_TOLERANCE, forces)
                && self.value(*event_function, self.state, self.rate)
                    > event_function.zero_within(self.loading, state, COINCIDENCE_TOLERANCE, forces)
        })
    }

    /// Looks for a quantity that dips below zero inside the step. If there is one, shortens the step to the dip and
    /// returns the quantities that are negative there, with the points computed.
    pub(crate) fn dips(
        &self,
        event_functions: &[EventFunction],
        reached: &mut Reached,
        mut serving: Option<SystemFactorisation>,
        work: &mut Work,
    ) -> Result<(Vec<EventFunction>, Option<Box<StepPoints>>), Refused> {
        let step = reached.step;
        let mut stretch = None;
        for event_function in event_functions {
            let end = (&reached.corrected.state, &reached.rate);
            let start = (self.state, self.rate);
            if event_function.dip(self.loading, self.modes, start, end, step, 0.0).is_none() {
                continue;
            }
            let zero = self.zero(*event_function, reached);
            let Some(place) = event_function.dip(self.loading, self.modes, start, end, step, zero) else { continue };
            let points = stretch.get_or_insert_with(|| Box::new(StepPoints::new(self, reached, serving.take())));
            let inside = points.reach(self, place, work)?;
            let passed = self.passed(event_functions, &inside);
            if !passed.is_empty() {
                *reached = *inside;
                return Ok((passed, stretch));
            }
        }
        Ok((Vec::new(), None))
    }

    /// Solves once more with the end of the stage as closing equation, so that a load of 1 is exactly 1.
    fn hold_exactly(&self, end: End, reached: Box<Reached>, work: &mut Work) -> Result<Box<Reached>, Refused> {
        let Some(bound) = end.held().filter(|_| !end.is_met_exactly(&reached.corrected.state)) else {
            return Ok(reached);
        };
        let system = ModeSystem::new(self.loading, self.modes, self.state);
        let mut exact = self.settle(system, reached.corrected.state, &bound, work)?;
        end.make_exact(&mut exact.corrected.state);
        Ok(exact)
    }
}

#[cfg(test)]
mod tests {
    use super::{LARGEST_TURN, SMALLEST_COSINE, may_turn};

    #[test]
    fn the_least_cosine_is_that_of_the_most_turn() {
        // Up to round-off, in which the cosines of different libraries differ.
        assert!((SMALLEST_COSINE - LARGEST_TURN.cos()).abs() < 1e-15);
        assert!(may_turn(0.99 * SMALLEST_COSINE).is_err() && may_turn(1.01 * SMALLEST_COSINE).is_ok());
    }
}
