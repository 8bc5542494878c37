//! Verification of contact modes by the MPEC: for every increment of `method: "mpec"`, and for the direction taken
//! where a mode ends.
//!
//! The point reached by the path is shown to solve the increment's program, without a quadratic program; where this
//! fails, the program is solved from the given direction.

use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::complementarity::mpec::Problem;
use crate::continuation::increment::tolerances::{
    DOUBTFUL_LENGTH, FIRST_TRIAL_SHARE, SHARE_BEFORE_CHANGE, SHORTENING_FACTOR, SHORTEST_RESOLVED_LENGTH,
    SMALLEST_MODE_EXTENT,
};
use crate::continuation::path_state::path_context::PathTrace;
use crate::mechanics::contact::Mode;
use crate::mechanics::multi_contact::reaction_sharing::agree;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use crate::step::event_functions;
use crate::step::increment_mpec::certificate;
use crate::step::increment_mpec::{Arrived, ForeseenModes, IncrementProgram, Named, ProgramCounts};
use crate::step::mode_step::{Reached, StepStart};

/// Number of attempts with the whole program, for shorter and shorter increments.
const TRIALS: usize = 3;

/// Whether the program, started along the present direction, ends in the present mode; where an event ends the step,
/// before it.
pub(crate) fn program_keeps_mode(trace: &mut PathTrace<'_>, rate: &Rate, reached: &Reached, step: f64) -> bool {
    let modes = trace.at.here.modes.clone();
    if is_shown(trace, rate, &modes, reached) {
        return true;
    }
    let way = if reached.event.is_some() { SHARE_BEFORE_CHANGE * reached.step } else { step };
    // This close to the event the program cannot distinguish the modes.
    way < SHORTEST_RESOLVED_LENGTH || is_named(trace, rate, &modes, way, true)
}

fn start<'a>(trace: &'a PathTrace<'_>, rate: &'a Rate, modes: &'a [Mode]) -> StepStart<'a> {
    let (here, force_scale) = (&trace.at.here, trace.at.totals.force_scale);
    StepStart {
        loading: trace.loading(),
        state: &here.state,
        rate,
        modes,
        drift: None,
        force_scale,
        is_singular: here.is_singular,
        beside: here.beside.as_ref(),
    }
}

/// The result of the certificate for the increment's program at the point of a mode at an arc length.
fn show(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], way: f64) -> ForeseenModes {
    let mut work = trace.at.totals.work;
    let reached = start(trace, rate, modes).reach(way, &mut work);
    trace.at.totals.work = work;
    reached.map_or(ForeseenModes::Unclear, |reached| show_at(trace, rate, modes, &reached))
}

/// The result of the certificate for the increment's program at a point reached in a mode.
fn show_at(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], reached: &Reached) -> ForeseenModes {
    if reached.determinant.is_none() || reached.step <= 0.0 {
        return ForeseenModes::Unclear;
    }
    let ends = (&trace.at.here.state, &reached.corrected.state);
    let program = program(trace.loading(), trace.at.totals.force_scale, ends, rate, reached.step);
    let Some(mut program) = program else { return ForeseenModes::Named(Named::of(modes)) };
    let end = Arrived { state: ends.1, rate: &reached.rate, error: reached.error_estimate };
    let foreseen = certificate::solved_at(&mut program, end, modes);
    trace.at.totals.work.certificates += u64::from(matches!(foreseen, ForeseenModes::Named(_)));
    foreseen
}

/// Whether a point reached in a mode is shown to solve the program of its increment, so that no search is needed.
fn is_shown(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], reached: &Reached) -> bool {
    let foreseen = show_at(trace, rate, modes, reached);
    is_of(trace, &foreseen, modes)
}

/// The same for the point at an arc length.
fn is_shown_within(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], way: f64) -> bool {
    let foreseen = show(trace, rate, modes, way);
    is_of(trace, &foreseen, modes)
}

/// Whether these modes are confirmed.
fn is_of(trace: &PathTrace<'_>, foreseen: &ForeseenModes, modes: &[Mode]) -> bool {
    matches!(foreseen, ForeseenModes::Named(named) if agree(trace.loading(), &named.modes, modes))
}

/// Whether the program, started along a direction, ends in the direction's own mode.
///
/// The arc length of the program's increment is only approximately the one requested; where the program finds another
/// mode, it may have passed the end of this one, and is solved again for shorter increments. First the point of the
/// mode is tested: usually it is shown to solve the program. Otherwise the branch of the direction's mode alone is
/// solved: where the mode holds, this is the program's solution, and where it ends, the solution shows how far it
/// extends. The whole program decides where this is inconclusive; `untold` is returned where no program can decide.
fn is_named(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], step: f64, untold: bool) -> bool {
    let state = trace.at.here.state.clone();
    if trace.scene.structure.dimension == 3 {
        // A cone may be active on a valid branch.
        return is_named_by_whole(trace, &state, rate, modes, step);
    }
    if untold && step <= DOUBTFUL_LENGTH {
        // This close to a contact change no result of a search would refute the mode.
        return true;
    }
    let mut tried = step;
    while tried >= SHORTEST_RESOLVED_LENGTH {
        match show(trace, rate, modes, tried) {
            shown if is_of(trace, &shown, modes) => return true,
            ForeseenModes::EndsAfter(part) => {
                tried *= SHARE_BEFORE_CHANGE * part;
                continue;
            }
            ForeseenModes::Named(_) | ForeseenModes::Untold | ForeseenModes::Unclear => {}
        }
        match foresee(trace, &state, rate, modes, tried) {
            ForeseenModes::Named(named) if agree(trace.loading(), &named.modes, modes) => return true,
            ForeseenModes::EndsAfter(part) => tried *= SHARE_BEFORE_CHANGE * part.clamp(SMALLEST_MODE_EXTENT, 1.0),
            ForeseenModes::Named(_) | ForeseenModes::Unclear => tried *= SHORTENING_FACTOR,
            ForeseenModes::Untold if tried <= DOUBTFUL_LENGTH => return untold,
            ForeseenModes::Untold => return is_named_by_whole(trace, &state, rate, modes, tried),
        }
    }
    // This close to a contact change the whole program is no more conclusive than its branch.
    if step <= DOUBTFUL_LENGTH {
        untold
    } else {
        is_named_by_whole(trace, &state, rate, modes, SHORTEST_RESOLVED_LENGTH)
    }
}

/// The same by the whole program with all its branches.
fn is_named_by_whole(trace: &mut PathTrace<'_>, state: &State, rate: &Rate, modes: &[Mode], step: f64) -> bool {
    let mut tried = step;
    for _ in 0..TRIALS {
        let named = name(trace, state, rate, modes, tried);
        if named.is_some_and(|named| agree(trace.loading(), &named.modes, modes)) {
            return true;
        }
        tried *= SHORTENING_FACTOR;
    }
    false
}

/// Whether the program, started along the present direction, ends in these modes: contacts change within the step.
pub(crate) fn program_joins_changes(trace: &mut PathTrace<'_>, rate: &Rate, step: f64, end: &[Mode]) -> bool {
    let (state, modes) = (trace.at.here.state.clone(), trace.at.here.modes.clone());
    let named = name(trace, &state, rate, &modes, step);
    named.is_some_and(|named| agree(trace.loading(), &named.modes, end))
}

/// Arc length to the first contact change along a direction, to first order: an increment that continues past it ends
/// in another mode. Infinite where no change lies ahead.
fn way_to_next_change(trace: &PathTrace<'_>, modes: &[Mode], rate: &Rate) -> f64 {
    let (loading, state) = (trace.loading(), &trace.at.here.state);
    let forces = trace.at.totals.force_scale;
    event_functions::of_mode(loading, modes, state, rate)
        .into_iter()
        .filter_map(|event_function| {
            let value = event_function.value(loading, modes, state, rate);
            let slope = event_function.slope(loading, modes, state, rate)?;
            // A quantity that is zero at the present point does not lie ahead.
            (value > CONTACT_TOLERANCE * event_function.scale(loading, state, forces) && slope < 0.0)
                .then(|| value / -slope)
        })
        .fold(f64::INFINITY, f64::min)
}

/// The increment's program from a state to approximately another; `None` where no contact can be reached: then there
/// is nothing to decide.
pub(crate) fn program<'a>(
    loading: Loading<'a>,
    force_scale: f64,
    (base, ahead): (&'a State, &State),
    expected: &'a Rate,
    step: f64,
) -> Option<IncrementProgram<'a>> {
    let program = increment_program(loading, force_scale, (base, ahead), expected, step);
    (program.pairs() > 0).then_some(program)
}

/// The increment's program, whether or not a contact can be reached.
pub(crate) fn increment_program<'a>(
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

fn name(trace: &mut PathTrace<'_>, base: &State, expected: &Rate, modes: &[Mode], step: f64) -> Option<Named> {
    let ahead = base.advanced(expected, step);
    let program = program(trace.loading(), trace.at.totals.force_scale, (base, &ahead), expected, step);
    let Some(mut program) = program else { return Some(Named::of(modes)) };
    let start = program.variables_at(expected);
    let (named, counts) = program.name(&start, modes, &trace.cancel);
    count(trace, counts);
    named
}

fn foresee(trace: &mut PathTrace<'_>, base: &State, expected: &Rate, modes: &[Mode], step: f64) -> ForeseenModes {
    let ahead = base.advanced(expected, step);
    let program = program(trace.loading(), trace.at.totals.force_scale, (base, &ahead), expected, step);
    let Some(mut program) = program else { return ForeseenModes::Named(Named::of(modes)) };
    let start = program.variables_at(expected);
    let (foreseen, counts) = program.foresee(&start, modes, &trace.cancel);
    count(trace, counts);
    foreseen
}

pub(crate) fn count(trace: &mut PathTrace<'_>, counts: ProgramCounts) {
    let totals = &mut trace.at.totals;
    totals.work.qp_solves += counts.qp_solves;
    totals.work.mpec_solves += counts.mpec_solves;
    totals.work.sqp_iterations += counts.sqp_iterations;
    totals.last_relaxation = counts.last_relaxation.or(totals.last_relaxation);
}

/// Whether the program confirms a direction at the present point: started along it, the program ends in the direction's
/// own mode. `false` where the next change is too close for the program to decide.
///
/// The forward term rewards the direction tried, not the incoming one: where the path reverses (a contact closes, the
/// load turns), rewarding the incoming direction would keep the increment at zero.
///
/// Changes occur in clusters: the first trial is no longer than the `last` step.
pub(crate) fn is_confirmed_by_program(trace: &mut PathTrace<'_>, choice: &DirectionChoice, last: f64) -> bool {
    let within = SHARE_BEFORE_CHANGE * way_to_next_change(trace, &choice.modes, &choice.rate);
    let first = (FIRST_TRIAL_SHARE * trace.at.step).min(within);
    let soon = last.max(SHORTEST_RESOLVED_LENGTH);
    within >= SHORTEST_RESOLVED_LENGTH
        && (soon < first && is_shown_within(trace, &choice.rate, &choice.modes, soon)
            || is_named(trace, &choice.rate, &choice.modes, first, false))
}
