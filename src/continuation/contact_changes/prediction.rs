//! The next contact change, where the rates at the start of a step foresee it.
//!
//! A step that passes many changes is cut at the first of them: what was solved at its far end was solved for nothing,
//! and is too far from the change to help to locate it. The gaps and forces of the contacts and their rates foresee the
//! place. There the change itself is solved for, in place of an arc length: one factorisation leads to it. Where that
//! finds no zero that lies where it should and comes first, the step goes to just past the place, and needs less of Newton's
//! method than a whole one. Where nothing has changed by then its end is a point like others, and the next step is as long
//! as this one was to be.

use crate::algebra::SystemFactorisation;
use crate::continuation::contact_changes::simultaneous::may_join_at;
use crate::continuation::path_state::step_quantum::quantised;
use crate::continuation::path_state::trace::PathTrace;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::stage_criteria::End;
use crate::mechanics::problem::state::Rate;
use crate::step::corrector::cached_factorisation::AtHand;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tangent;
use crate::step::event_functions::{self, EventZero, Watch};
use crate::step::event_location::StepPoints;
use crate::step::interpolation::PlacedPoint;
use crate::step::segment::{Attempt, PASSED, StepStart, may_turn};

/// How far past the change the step is to end, over the way there: rates are not all that tells where it is.
const PAST: f64 = 1.25;
/// The change is where it was foreseen if it is not nearer than this part of the way there, and not past that end.
const LEAST_OF_WAY: f64 = 0.5;
/// No step is cut to less than this part of what it was to be.
const LEAST: f64 = 1.0 / 256.0;

/// A contact change, or the end of a stage, that the rates foresee.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForeseenChange {
    /// What falls to zero there.
    pub watch: Watch,
    /// Arc length up to there.
    pub way: f64,
    /// To just past it.
    pub step: f64,
    /// The path is straight up to there: nothing that is not zero at its ends is so on the way.
    pub is_straight: bool,
}

/// A shorter step along the direction just now that ends just past the change that comes first. `may_join`: those that
/// may be taken together are not stopped at.
///
/// Only where matrices are sparse: the factorisations that are saved of a dense one cost as little as the points that
/// come on top.
pub(crate) fn step_to_foreseen_change(
    trace: &PathTrace<'_>,
    step: f64,
    rate: &Rate,
    may_join: bool,
) -> Option<ForeseenChange> {
    let (loading, here) = (trace.loading(), &trace.at.here);
    loading.structure.layout()?;
    let way = |watch: &event_functions::Watch| {
        let slope = watch.slope(loading, &here.modes, &here.state, rate).filter(|slope| *slope < 0.0)?;
        let value = watch.value(loading, &here.modes, &here.state, rate);
        // What is zero here has just changed.
        let is_above = watch.is_above(loading, &here.state, value, PASSED, trace.at.totals.force_scale);
        is_above.then(|| value / -slope)
    };
    let watches = event_functions::of_mode(loading, &here.modes, &here.state, rate);
    let ways = || watches.iter().filter_map(|watch| Some((*watch, way(watch)?)));
    let (first, way) = ways().min_by(|one, other| one.1.total_cmp(&other.1))?;
    if may_join && ways().filter(|(_, way)| *way < step).all(|(watch, _)| may_join_at(loading, &here.modes, watch)) {
        return None;
    }
    let part = PAST * way / step;
    let step = step * quantised(part.max(LEAST));
    (part < 1.0).then_some(ForeseenChange { watch: first, way, step, is_straight: false })
}

/// The step that ends at a change foreseen, which is solved for at once; `None` where that leads elsewhere.
pub(crate) fn meet_change(
    start: &StepStart<'_>,
    foreseen: ForeseenChange,
    at_hand: Option<AtHand>,
    before: Option<&PlacedPoint>,
    ends: &[End],
    load_sign: f64,
    work: &mut Work,
) -> Option<Attempt> {
    let ForeseenChange { watch, way, step, is_straight } = foreseen;
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    if watch.slope(start.loading, start.modes, start.state, start.rate).is_none() || system.has_tracks() {
        return None;
    }
    let guess = before.and_then(|before| before.foresee(start.state, start.rate, way));
    let guess = guess.unwrap_or_else(|| start.state.advanced(start.rate, way));
    let scale = watch.scale(start.loading, &guess, start.force_scale);
    let closing = EventZero { watch, scale, towards: start.rate };
    let own = at_hand.filter(|_| is_straight).and_then(|at_hand| at_hand.along(&system, start.rate));
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
    let falls = watch.slope(start.loading, start.modes, state, &reached.rate).is_some_and(|slope| slope < 0.0);
    let is_zero = start.value(watch, state, &reached.rate).abs() <= start.zero(watch, &reached);
    let turns = may_turn(start.rate.product(&reached.rate)).is_err();
    if !falls || !is_zero || turns || reached.step > step || reached.step < LEAST_OF_WAY * way {
        return None;
    }
    let watches = start.watches(ends, load_sign);
    let others: Vec<Watch> = watches.iter().copied().filter(|other| *other != watch).collect();
    let mut passed = start.passed(&others, &reached);
    let mut stretch = (!passed.is_empty()).then(|| Box::new(StepPoints::new(start, &reached, serving.take())));
    if stretch.is_none() && !is_straight {
        (passed, stretch) = start.dips(&others, &mut reached, serving, work).ok()?;
    }
    Some(Attempt { reached, watches, passed, stretch, met: Some(watch) })
}
