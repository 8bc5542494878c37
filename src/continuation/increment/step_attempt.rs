//! One attempt of a step: how far its mode extends, and whether the point reached is admissible.

use crate::branching::bifurcation::locate::{self, Crossing, Located};
use crate::branching::bifurcation::singularity::test_functions::{self, Signature, SignatureChange};
use crate::branching::bifurcation::step_end::StepEnd;
use crate::branching::bifurcation::{simultaneous_limit_points, stage_end_near_singular_point};
use crate::continuation::contact_changes::prediction;
use crate::continuation::contact_changes::prediction::ForeseenChange;
use crate::continuation::contact_changes::simultaneous;
use crate::continuation::increment::step_control;
use crate::continuation::increment::tolerances::{LARGEST_SHARE_OF_STEP, NEXT_CHANGE_RATIO};
use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::resumable_state::PresentPoint;
use crate::mechanics::contact::Mode;
use crate::mechanics::problem::natural_residual;
use crate::mechanics::problem::state::Rate;
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use crate::step::corrector::cost_counters::Work;
use crate::step::event_functions::EventFunction;
use crate::step::lift_off;
use crate::step::mode_step::{Reached, Refused, StepEvents, StepStart};

/// Largest number of shorter steps tried where a change of signature cannot be resolved.
const MOST_UNRESOLVED: u64 = 4;

/// The length of a step as far as it is known before an attempt.
pub(crate) struct Sought {
    /// Determined by the path's turn, Newton's iterations and the energy balance of the previous steps.
    pub ordinary: f64,
    /// The next event of a path that is straight up to the event.
    pub jump: Option<ForeseenChange>,
    /// The next contact change predicted by the rates.
    pub foreseen: Option<ForeseenChange>,
    /// Contact changes in the step may be treated together.
    pub may_join: bool,
}

impl Sought {
    /// The first length to try.
    pub fn step(&self) -> f64 {
        self.jump.or(self.foreseen).map_or(self.ordinary, |foreseen| foreseen.step)
    }

    /// Whether a step of this length leads to the next event of a straight path.
    pub fn jumps(&self, step: f64) -> bool {
        self.jump.is_some_and(|event| event.step == step)
    }
}

/// Results of the attempts of one step so far.
pub(crate) struct Tries {
    /// Arc length within which the next change is sought, in the first attempt only.
    next: Option<f64>,
    /// Signature just past the start.
    known: Option<Signature>,
    /// Factorisation with which the direction was found.
    cached: CachedFactorisation,
    /// Number of attempts at which a change of signature could not be resolved.
    pub unresolved: u64,
    /// Whether the last attempt treated changes together; `None` where there were none to treat so.
    pub joined: Option<bool>,
}

impl Tries {
    pub fn new(here: &PresentPoint, cached: CachedFactorisation) -> Self {
        let next = here.apart.map(|apart| NEXT_CHANGE_RATIO * apart);
        Self { next, known: here.signature, cached, unresolved: 0, joined: None }
    }
}

/// Attempts a step of this length along the present direction.
pub(crate) fn try_step(
    trace: &PathTrace<'_>,
    rate: &Rate,
    step: f64,
    sought: &Sought,
    tries: &mut Tries,
    work: &mut Work,
) -> Result<StepEnd, Refused> {
    let here = &trace.at.here;
    let start = StepStart {
        loading: trace.loading(),
        state: &here.state,
        rate,
        modes: &here.modes,
        drift: here.drift.as_ref(),
        force_scale: trace.at.totals.force_scale,
        is_singular: here.is_singular,
        beside: here.beside.as_ref(),
    };
    let ends = &trace.scene.stages[trace.at.stage].ends;
    let outcome = end_of_step(trace, &start, step, sought, tries, work);
    let is_lost = match &outcome {
        Ok(end) => matches!(end.reached.event, Some(EventFunction::End(_))) && end.reached.determinant.is_none(),
        Err(refused) => matches!(refused, Refused::Newton(_)),
    };
    let bounded = is_lost
        .then(|| stage_end_near_singular_point::beside_singular(&start, step, ends, here.load_sign, tries.known, work))
        .flatten();
    let back = outcome.as_ref().ok().and_then(|end| step_control::way_back(trace, &start, &end.reached, work));
    let end = if let Some(back) = back {
        StepEnd { returned: true, ..StepEnd::plain(back) }
    } else if let Some(bounded) = bounded {
        bounded
    } else {
        let end = outcome?;
        // The equations of a straight path are the same at both ends, and nowhere singular in between.
        if end.joined.is_some() || sought.jumps(step) {
            end
        } else {
            let known = tries.known.or_else(|| Signature::past_start(&start, end.reached.step, &mut None, work));
            tries.known = known;
            first_crossing(&start, known, end.reached, tries.unresolved < MOST_UNRESOLVED, work)?
        }
    };
    let corrected = &end.reached.corrected;
    let forces = trace.at.totals.force_scale.max(corrected.force_scale);
    if !natural_residual::holds(trace.loading(), &corrected.state, forces) {
        Err(Refused::Unlawful)
    } else if step_control::shrinks_to_a_point(trace, &corrected.state) {
        Err(Refused::Collapsed)
    } else {
        Ok(end)
    }
}

/// The end of a step: past changes that are treated together, or at the first event in it.
fn end_of_step(
    trace: &PathTrace<'_>,
    start: &StepStart<'_>,
    step: f64,
    sought: &Sought,
    tries: &mut Tries,
    work: &mut Work,
) -> Result<StepEnd, Refused> {
    let (ends, load_sign) = (&trace.scene.stages[trace.at.stage].ends, trace.at.here.load_sign);
    let may_join = sought.may_join && !sought.jumps(step);
    let foreseen = may_join.then(|| simultaneous::join_foreseen(start, step, ends, load_sign, work)).flatten();
    if let Some(joined) = foreseen {
        tries.joined = Some(joined.is_some());
        // Where the changes cannot be treated together the step has to end at the first of them.
        return joined.ok_or(Refused::Apart);
    }
    let (reached, events) = match attempt(trace, start, step, sought, tries, work) {
        Ok(reached) => reached,
        Err(refused) => {
            let leaves = lift_off::ahead(start, step, (ends, load_sign), work);
            return leaves.map(StepEnd::plain).ok_or(refused);
        }
    };
    if may_join && let Some(first) = simultaneous::changes_to_join(start, &reached, &events) {
        let joined = simultaneous::join_changes(start, &first, &reached, &events, work);
        tries.joined = Some(joined.is_some());
        if let Some(joined) = joined {
            return Ok(joined);
        }
    }
    let ended = start.stop_at_event(reached, events, ends, simultaneous_limit_points::locate, work);
    let ended = ended.or_else(|refused| lift_off::ahead(start, step, (ends, load_sign), work).ok_or(refused));
    ended.map(StepEnd::plain)
}

/// The extent of the mode: to the next of several changes if it is near, to a predicted change, or over a whole step.
fn attempt(
    trace: &PathTrace<'_>,
    start: &StepStart<'_>,
    step: f64,
    sought: &Sought,
    tries: &mut Tries,
    work: &mut Work,
) -> Result<(Box<Reached>, StepEvents), Refused> {
    let here = &trace.at.here;
    let (ends, load_sign) = (&trace.scene.stages[trace.at.stage].ends, here.load_sign);
    let is_straight = sought.jumps(step);
    let joins = sought.may_join && !is_straight && simultaneous::may_join(start);
    // A change predicted by the rates is located from the prediction.
    let is_open = !joins && !is_straight && sought.foreseen.is_none();
    let next = tries.next.take().filter(|next| *next < LARGEST_SHARE_OF_STEP * step && is_open);
    let next = next.and_then(|next| {
        let mut serving = None;
        tries.known = tries.known.or_else(|| Signature::past_start(start, next, &mut serving, work));
        let (reached, events) = start.attempt(next, None, serving, ends, load_sign, work).ok()?;
        (!events.passed.is_empty()).then_some((reached, events))
    });
    if let Some(next) = next {
        return Ok(next);
    }
    let before = here.before.as_ref();
    let foreseen = sought.jump.or(sought.foreseen).filter(|foreseen| foreseen.step == step);
    let cached = here.is_factorised.then(|| std::mem::take(&mut tries.cached));
    let met =
        foreseen.and_then(|foreseen| prediction::meet_change(start, foreseen, cached, before, ends, load_sign, work));
    met.map_or_else(|| start.attempt(step, before, None, ends, load_sign, work), Ok)
}

/// Ends a step at the first smooth bifurcation in it, of its own mode or of the mode in which contacts that touch
/// without reaction throughout the step are free; with the signature past its end.
fn first_crossing(
    start: &StepStart<'_>,
    before: Option<Signature>,
    reached: Box<Reached>,
    may_refuse: bool,
    work: &mut Work,
) -> Result<StepEnd, Refused> {
    let end = crossing_in_mode(start, before, reached, may_refuse, work)?;
    let loose = test_functions::loosened(start, &end.reached);
    Ok(match loose.and_then(|loose| crossing_when_loose(start, &loose, &end.reached, work)) {
        Some((point, crossing)) => StepEnd::in_mode(point, Some(crossing), before),
        None => end,
    })
}

/// The first smooth bifurcation of a step in loosened modes.
fn crossing_when_loose(
    start: &StepStart<'_>,
    loose: &[Mode],
    reached: &Reached,
    work: &mut Work,
) -> Option<(Box<Reached>, Crossing)> {
    let loosened = StepStart { modes: loose, ..*start };
    let before = Signature::past_start(&loosened, reached.step, &mut None, work)?;
    let mut end = loosened.reach_near(reached.corrected.state.clone(), reached.step, work).ok()?;
    end.event = reached.event;
    let (_, change) = test_functions::compare(&loosened, before, &end, work);
    if change == SignatureChange::None {
        return None;
    }
    let Located { mut point, crossing, .. } = locate::locate(&loosened, before, change, &end, work)?;
    if point.step >= reached.step || crossing.eigenvalues == 0 {
        return None;
    }
    for (contact, mode) in point.corrected.modes.iter_mut().enumerate() {
        if loose[contact] != start.modes[contact] {
            *mode = start.modes[contact];
        }
    }
    point.corrected.iterations_to_small = reached.corrected.iterations_to_small;
    Some((point, Crossing { grazing: true, ..crossing }))
}

/// Ends a step at the first smooth bifurcation in its own mode.
fn crossing_in_mode(
    start: &StepStart<'_>,
    before: Option<Signature>,
    reached: Box<Reached>,
    may_refuse: bool,
    work: &mut Work,
) -> Result<StepEnd, Refused> {
    let Some(before) = before else {
        // The start is singular: the signature is known from the end of the step on.
        let state = &reached.corrected.state;
        let is_limit = matches!(reached.event, Some(EventFunction::LoadRate { .. }));
        let regular = if is_limit { None } else { test_functions::sign_at_end(start, &reached, work) };
        let after = regular
            .and_then(|sign| Signature::with_determinant(start.loading, start.modes, start.state, state, sign, work));
        return Ok(StepEnd::in_mode(reached, None, after));
    };
    let (after, change) = test_functions::compare(start, before, &reached, work);
    if after.is_none() && reached.event.is_none() && may_refuse {
        return Err(Refused::Unresolved);
    }
    if change == SignatureChange::None {
        return Ok(StepEnd::in_mode(reached, None, after));
    }
    match locate::locate(start, before, change, &reached, work) {
        Some(Located { mut point, crossing, .. }) if point.step < reached.step || crossing.eigenvalues == 0 => {
            point.corrected.iterations_to_small = reached.corrected.iterations_to_small;
            let after = crossing.after;
            Ok(StepEnd::in_mode(point, Some(crossing), Some(after)))
        }
        Some(_) => Ok(StepEnd::in_mode(reached, None, Some(before))),
        None if may_refuse => Err(Refused::Unresolved),
        None => Ok(StepEnd::in_mode(reached, None, after)),
    }
}
