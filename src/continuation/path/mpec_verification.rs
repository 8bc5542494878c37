//! Where the MPEC names the mode: every increment of `method: "mpec"`, and the direction taken where a mode ends.
//!
//! The point that the path has reached is shown to solve the increment's program, without a quadratic program; where it
//! is not, the program is solved from the direction at hand.

use crate::branching::directions::choice::DirectionChoice;
use crate::complementarity::mpec::Problem;
use crate::continuation::path_state::trace::PathTrace;
use crate::mechanics::contact::Mode;
use crate::mechanics::multi_contact::reaction_split::agree;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::natural_residual::ZERO;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::event_functions;
use crate::step::increment_mpec::certificate;
use crate::step::increment_mpec::{Arrived, ForeseenModes, IncrementProgram, Named, ProgramCounts};
use crate::step::segment::{Reached, StepStart};

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

/// Whether the program, started along the present direction, ends in the present mode; up to an event, on the way there.
pub(crate) fn program_keeps_mode(trace: &mut PathTrace<'_>, rate: &Rate, reached: &Reached, step: f64) -> bool {
    let modes = trace.at.here.modes.clone();
    if is_shown(trace, rate, &modes, reached) {
        return true;
    }
    let way = if reached.event.is_some() { WITHIN * reached.step } else { step };
    // So near to the event the program tells nothing apart.
    way < RESOLVED || is_named(trace, rate, &modes, way, true)
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

/// What the point of a mode at an arc length shows of its increment's program.
fn show(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], way: f64) -> ForeseenModes {
    let mut work = trace.at.totals.work;
    let reached = start(trace, rate, modes).reach(way, &mut work);
    trace.at.totals.work = work;
    reached.map_or(ForeseenModes::Unclear, |reached| show_at(trace, rate, modes, &reached))
}

/// What a point reached in a mode shows of its increment's program.
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

/// Whether a point reached in a mode is shown to solve the program of its increment: nothing is left to search.
fn is_shown(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], reached: &Reached) -> bool {
    let foreseen = show_at(trace, rate, modes, reached);
    is_of(trace, &foreseen, modes)
}

/// The same of the point at an arc length.
fn is_shown_within(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], way: f64) -> bool {
    let foreseen = show(trace, rate, modes, way);
    is_of(trace, &foreseen, modes)
}

/// Whether these modes are named.
fn is_of(trace: &PathTrace<'_>, foreseen: &ForeseenModes, modes: &[Mode]) -> bool {
    matches!(foreseen, ForeseenModes::Named(named) if agree(trace.loading(), &named.modes, modes))
}

/// Whether the program, started along a direction, ends in the direction's own mode.
///
/// Its increment has about the arc length asked for, not exactly; where it names another mode, it may have gone past
/// the end of this one, and is asked again for shorter increments. First the point of the mode is looked at: as a rule
/// it is shown to solve the program. Then the branch of the direction's mode alone is
/// solved: where it holds, it is the program's solution, and where it ends, it says how far it goes. The whole program
/// has the word where that does not settle it; `untold` is the answer where no program can tell.
fn is_named(trace: &mut PathTrace<'_>, rate: &Rate, modes: &[Mode], step: f64, untold: bool) -> bool {
    let state = trace.at.here.state.clone();
    if trace.scene.structure.dimension == 3 {
        // A cone may bind a branch that holds.
        return is_named_by_whole(trace, &state, rate, modes, step);
    }
    if untold && step <= NEAR {
        // So near to where contacts change no answer of a search would count against the mode.
        return true;
    }
    let mut tried = step;
    while tried >= RESOLVED {
        match show(trace, rate, modes, tried) {
            shown if is_of(trace, &shown, modes) => return true,
            ForeseenModes::EndsAfter(part) => {
                tried *= WITHIN * part;
                continue;
            }
            ForeseenModes::Named(_) | ForeseenModes::Untold | ForeseenModes::Unclear => {}
        }
        match foresee(trace, &state, rate, modes, tried) {
            ForeseenModes::Named(named) if agree(trace.loading(), &named.modes, modes) => return true,
            ForeseenModes::EndsAfter(part) => tried *= WITHIN * part.clamp(SHORTEST, 1.0),
            ForeseenModes::Named(_) | ForeseenModes::Unclear => tried *= SHORTER,
            ForeseenModes::Untold if tried <= NEAR => return untold,
            ForeseenModes::Untold => return is_named_by_whole(trace, &state, rate, modes, tried),
        }
    }
    // So near to where contacts change the whole program tells no more than its branch.
    if step <= NEAR { untold } else { is_named_by_whole(trace, &state, rate, modes, RESOLVED) }
}

/// The same by the whole program, all branches of it.
fn is_named_by_whole(trace: &mut PathTrace<'_>, state: &State, rate: &Rate, modes: &[Mode], step: f64) -> bool {
    let mut tried = step;
    for _ in 0..TRIALS {
        let named = name(trace, state, rate, modes, tried);
        if named.is_some_and(|named| agree(trace.loading(), &named.modes, modes)) {
            return true;
        }
        tried *= SHORTER;
    }
    false
}

/// Whether the program, started along the present direction, ends in these modes: contacts change within the step.
pub(crate) fn program_joins_changes(trace: &mut PathTrace<'_>, rate: &Rate, step: f64, end: &[Mode]) -> bool {
    let (state, modes) = (trace.at.here.state.clone(), trace.at.here.modes.clone());
    let named = name(trace, &state, rate, &modes, step);
    named.is_some_and(|named| agree(trace.loading(), &named.modes, end))
}

/// Arc length to the first change of a contact along a direction, to first order: an increment that goes on past it
/// ends in another mode. Infinite where none is ahead.
fn way_to_next_change(trace: &PathTrace<'_>, modes: &[Mode], rate: &Rate) -> f64 {
    let (loading, state) = (trace.loading(), &trace.at.here.state);
    let forces = trace.at.totals.force_scale;
    event_functions::of_mode(loading, modes, state, rate)
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

/// The same, whether or not a contact can be reached.
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

/// Whether the program confirms a direction at the present point: started along it, it ends in the direction's own
/// mode. Not where the next change is too near for the program to tell.
///
/// The forward term rewards the direction that is tried, not the one in which the path came: where the path turns
/// against its past (a contact closes, the load turns), that term would hold the increment back at zero.
///
/// Changes come in clusters: what is tried first goes no further than the `last` step did.
pub(crate) fn is_confirmed_by_program(trace: &mut PathTrace<'_>, choice: &DirectionChoice, last: f64) -> bool {
    let within = WITHIN * way_to_next_change(trace, &choice.modes, &choice.rate);
    let first = (FIRST_TRIAL * trace.at.step).min(within);
    let soon = last.max(RESOLVED);
    within >= RESOLVED
        && (soon < first && is_shown_within(trace, &choice.rate, &choice.modes, soon)
            || is_named(trace, &choice.rate, &choice.modes, first, false))
}
