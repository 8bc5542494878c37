//! Prediction of the next contact change by the rates at the start of a step.
//!
//! Without prediction a step that passes many changes is cut at the first of them: the solution at its end is wasted
//! and too far from the change to help locate it. The gaps and forces of the contacts and their rates predict the place
//! of the change. Newton's method then solves for the change itself, in place of a given arc length: one factorisation
//! suffices. Where it finds no zero close enough to the prediction and before all others, the step goes to just past
//! the predicted place, and needs fewer Newton iterations than a full step. Where nothing has changed by then its end
//! is an ordinary point, and the next step has the full length intended for this one.

use crate::algebra::SystemFactorisation;
use crate::continuation::contact_changes::simultaneous::may_join_at;
use crate::continuation::contact_changes::tolerances::{
    PREDICTED_STEP_RATIO, SMALLEST_DISTANCE_RATIO, SMALLEST_STEP_SHARE,
};
use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::step_factor_rounding::quantised;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::state::Rate;
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tangent;
use crate::step::event_functions::{self, EventFunction, EventZero};
use crate::step::event_location::StepPoints;
use crate::step::interpolation::PlacedPoint;
use crate::step::mode_step::{Reached, StepEvents, StepStart, may_turn};

/// A contact change, or the end of a stage, predicted by the rates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForeseenChange {
    /// The quantity that decreases to zero there.
    pub event_function: EventFunction,
    /// Arc length up to the change.
    pub way: f64,
    /// Arc length to just past the change.
    pub step: f64,
    /// The path is straight up to the change: a quantity that is nonzero at both ends is nonzero in between.
    pub is_straight: bool,
}

/// A shorter step along the present direction that ends just past the first predicted change. With `may_join` the step
/// does not stop at changes that may be treated together.
///
/// Only with sparse matrices: a dense factorisation saved costs no more than the additional points.
pub(crate) fn step_to_foreseen_change(
    trace: &PathTrace<'_>,
    step: f64,
    rate: &Rate,
    may_join: bool,
) -> Option<ForeseenChange> {
    let (loading, here) = (trace.loading(), &trace.at.here);
    loading.structure.layout()?;
    let way = |event_function: &event_functions::EventFunction| {
        let slope = event_function.slope(loading, &here.modes, &here.state, rate).filter(|slope| *slope < 0.0)?;
        let value = event_function.value(loading, &here.modes, &here.state, rate);
        // A quantity that is zero at the present point has just changed.
        (value > event_function.zero(loading, &here.state, trace.at.totals.force_scale)).then(|| value / -slope)
    };
    let event_functions = event_functions::of_mode(loading, &here.modes, &here.state, rate);
    let ways = || event_functions.iter().filter_map(|event_function| Some((*event_function, way(event_function)?)));
    let (first, way) = ways().min_by(|one, other| one.1.total_cmp(&other.1))?;
    if may_join
        && ways()
            .filter(|(_, way)| *way < step)
            .all(|(event_function, _)| may_join_at(loading, &here.modes, event_function))
    {
        return None;
    }
    let part = PREDICTED_STEP_RATIO * way / step;
    let step = step * quantised(part.max(SMALLEST_STEP_SHARE));
    (part < 1.0).then_some(ForeseenChange { event_function: first, way, step, is_straight: false })
}

/// The step that ends at a predicted change, which is solved for directly; `None` where the solution lies elsewhere.
pub(crate) fn meet_change(
    start: &StepStart<'_>,
    foreseen: ForeseenChange,
    cached: Option<CachedFactorisation>,
    before: Option<&PlacedPoint>,
    ends: &[End],
    load_sign: f64,
    work: &mut Work,
) -> Option<(Box<Reached>, StepEvents)> {
    let ForeseenChange { event_function, way, step, is_straight } = foreseen;
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    if event_function.slope(start.loading, start.modes, start.state, start.rate).is_none() || system.has_tracks() {
        return None;
    }
    let guess = before.and_then(|before| before.foresee(start.state, start.rate, way));
    let guess = guess.unwrap_or_else(|| start.state.advanced(start.rate, way));
    let scale = event_function.scale(start.loading, &guess, start.force_scale);
    let closing = EventZero { event_function, scale, towards: start.rate };
    let own = cached.filter(|_| is_straight).and_then(|cached| cached.along(&system, start.rate));
    let mut serving = None;
    let guess = system.iterate(guess);
    let corrected = newton::correct_with(&system, guess, &closing, start.force_scale, own, &mut serving, work).ok()?;
    let mut reached = match &serving {
        Some(SystemFactorisation::Sparse(nearby)) if is_straight => {
            let error = tangent::error_by(&system, nearby, &corrected)?;
            start.straight_on(corrected, error)
        }
        _ => start.directed(system, corrected, &closing, &mut serving, work).ok()?,
    };
    let state = &reached.corrected.state;
    let falls = event_function.slope(start.loading, start.modes, state, &reached.rate).is_some_and(|slope| slope < 0.0);
    let is_zero = start.value(event_function, state, &reached.rate).abs() <= start.zero(event_function, &reached);
    let turns = may_turn(start.rate.product(&reached.rate)).is_err();
    if !falls || !is_zero || turns || reached.step > step || reached.step < SMALLEST_DISTANCE_RATIO * way {
        return None;
    }
    let event_functions = start.event_functions(ends, load_sign);
    let others: Vec<EventFunction> = event_functions.iter().copied().filter(|other| *other != event_function).collect();
    let mut passed = start.passed(&others, &reached);
    let mut stretch = (!passed.is_empty()).then(|| Box::new(StepPoints::new(start, &reached, serving.take())));
    if stretch.is_none() && !is_straight {
        (passed, stretch) = start.dips(&others, &mut reached, serving, work).ok()?;
    }
    Some((reached, StepEvents { functions: event_functions, passed, stretch, met: Some(event_function) }))
}
