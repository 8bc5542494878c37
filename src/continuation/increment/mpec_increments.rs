//! Increments found by their program alone: `method: "mpec"` with the certificate skipped.
//!
//! The length of an increment and the event that ends it are determined as usual (`step_control`), so that increments
//! are as long as those of `auto`. The end is then found anew, by the program from the previous point and its
//! direction; the contact mode is identified, and Newton's method on the mode's equations with the arc-length equation
//! refines the program's solution to round-off. The refined point replaces the original one unless round-off gives it
//! the larger residual. Where an event ends the increment, a contact is on the boundary of two modes there and the
//! program may find either; the event's own equation has located the point, which has to be the same.
//!
//! `γ1` is adapted until the program ends near the arc length sought, and further where it ends in another mode: an
//! event may lie just past the point. An increment whose end no search finds counts as a fall-back: the point found by
//! the mode's equations is retained.

use crate::branching::bifurcation::step_end::StepEnd;
use crate::continuation::increment::mpec_verification;
use crate::continuation::increment::tolerances::{ADAPTED_ARC_LENGTH, MODE_BOUNDARY_TOLERANCE, POINT_DISTANCE};
use crate::continuation::path_state::path_context::PathTrace;
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::closing_equation::ArcLengthEquation;
use crate::mechanics::multi_contact::reaction_sharing::agree;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::natural_residual;
use crate::mechanics::problem::state::{Rate, State};
use crate::result::program_iterate::{ContactIterate, ProgramIterate};
use crate::step::corrector::cost_counters::Work;
use crate::step::increment_mpec::relaxation_sequence;
use crate::step::increment_mpec::{IncrementProgram, ProgramCounts, ProgramEnd, Searched};
use crate::step::mode_step::{Reached, StepStart};
use std::sync::Arc;

/// Largest number of searches for one increment, `γ1` adapted from one to the next.
const MOST_SEARCHES: usize = 8;
/// Range of arc lengths, relative to the one sought, from which the refinement starts.
const NEAR: [f64; 2] = [0.5, 2.0];

/// By-products of the searches for an increment.
#[derive(Default)]
struct Left {
    counts: Vec<ProgramCounts>,
    work: Work,
    iterates: Vec<ProgramIterate>,
}

/// Finds by its program the end of an increment that is about to be accepted. Returns whether the program has it.
pub(crate) fn found_by_program(trace: &mut PathTrace<'_>, rate: &Rate, end: &mut StepEnd) -> bool {
    let (found, Left { counts, work, iterates }) = search_end(trace, rate, end);
    trace.at.totals.work = work;
    counts.into_iter().for_each(|counts| mpec_verification::count(trace, counts));
    if let Some(kept) = &mut trace.iterates {
        *kept = iterates;
    }
    let Some(found) = found else {
        trace.at.totals.work.mpec_fallbacks += 1;
        return false;
    };
    let reached = &mut end.reached;
    // Next to stiff elements round-off may leave a larger residual at one of the two points than at the other.
    let is_as_good = found.corrected.residual <= reached.corrected.residual.max(f64::EPSILON);
    if is_as_good && reached.event.is_none() && end.crossing.is_none() && !end.returned {
        let hardness = reached.corrected.iterations_to_small;
        (reached.corrected, reached.rate) = (found.corrected, found.rate);
        reached.corrected.iterations_to_small = hardness;
    }
    true
}

fn search_end(trace: &PathTrace<'_>, rate: &Rate, step_end: &StepEnd) -> (Option<Box<Reached>>, Left) {
    let (here, reached) = (&trace.at.here, &step_end.reached);
    let mut left = Left { work: trace.at.totals.work, ..Left::default() };
    let (loading, base, step) = (trace.loading(), &here.state, reached.step);
    let modes = if step_end.joined.is_some() { &reached.corrected.modes } else { &here.modes };
    if step <= 0.0 {
        return (Some(reached.clone()), left);
    }
    let ahead = base.advanced(rate, step);
    let mut program =
        mpec_verification::increment_program(loading, trace.at.totals.force_scale, (base, &ahead), rate, step);
    relaxation_sequence::stay_near(&mut program);
    let predicted = program.variables_at(rate);
    let (mut start, mut relaxation) = (predicted.clone(), relaxation_sequence::first_relaxation(&program));
    for _ in 0..MOST_SEARCHES {
        let searched = relaxation_sequence::search_from(
            &program,
            &start,
            relaxation,
            modes,
            trace.iterates.is_some(),
            &trace.cancel,
        );
        note(trace, &program, &searched, &mut left);
        if trace.cancel.is_cancelled() {
            break;
        }
        let Some(end) = searched.end else {
            let Some(tighter) = relaxation_sequence::tighter(relaxation) else { break };
            (start, relaxation) = (predicted.clone(), tighter);
            continue;
        };
        let is_near = (NEAR[0]..=NEAR[1]).contains(&end.size);
        if is_near && is_mode_at(trace, loading, &end, modes, reached) {
            let found = polished(trace, &end, rate, modes, step, &mut left.work);
            let is_same = |found: &Reached| {
                let state = &found.corrected.state;
                let forces = trace.at.totals.force_scale.max(found.corrected.force_scale);
                state.distance(&reached.corrected.state) <= POINT_DISTANCE * (1.0 + step)
                    && natural_residual::holds(loading, state, forces)
            };
            if let Some(found) = found.filter(|found| is_same(found)) {
                return (Some(found), left);
            }
        }
        // Away from the path: too large a relaxation led the search elsewhere.
        let is_off = !is_near || (end.size - 1.0).abs() <= ADAPTED_ARC_LENGTH;
        match relaxation_sequence::tighter(relaxation).filter(|_| is_off) {
            Some(tighter) => (start, relaxation) = (predicted.clone(), tighter),
            None => {
                relaxation_sequence::adapt_arc_weight(&mut program, end.size);
                start = end.variables;
            }
        }
    }
    (None, left)
}

fn note(trace: &PathTrace<'_>, program: &IncrementProgram<'_>, searched: &Searched, left: &mut Left) {
    left.counts.push(searched.counts);
    let plan = trace.scene.plan();
    let (length, force) = (plan.displacement_scale, plan.force_scale);
    let number = left.counts.len() as u64;
    for iterate in &searched.iterates {
        let (state, contacts) = relaxation_sequence::contacts_at(program, &iterate.x);
        let contacts = contacts.into_iter().filter_map(|at| {
            let (node, obstacle) = trace.names().nth(at.contact)?;
            Some(ContactIterate {
                node: Arc::clone(node),
                obstacle: Arc::clone(obstacle),
                gap: at.gap * length,
                normal_reaction: at.normal * force,
                within_cone: at.within_cone * force,
                slip: at.slip * length,
            })
        });
        left.iterates.push(ProgramIterate {
            program: number,
            relaxation: iterate.relaxation,
            size: relaxation_sequence::arc_length_ratio(program, &iterate.x),
            load_factor: trace.scene.stages[trace.at.stage].load_factor(state.load),
            violation: iterate.violation,
            contacts: contacts.collect(),
        });
    }
}

/// The end of a search refined to round-off in a mode, at the arc length sought.
fn polished(
    trace: &PathTrace<'_>,
    end: &ProgramEnd,
    rate: &Rate,
    modes: &[Mode],
    step: f64,
    work: &mut Work,
) -> Option<Box<Reached>> {
    let (here, force_scale) = (&trace.at.here, trace.at.totals.force_scale);
    let start = StepStart {
        loading: trace.loading(),
        state: &here.state,
        rate,
        modes,
        drift: None,
        force_scale,
        is_singular: here.is_singular,
        beside: here.beside.as_ref(),
    };
    let system = ModeSystem::new(trace.loading(), modes, &here.state);
    let closing = ArcLengthEquation { from: &here.state, step };
    let polished = start.settle(system, end.state.clone(), &closing, work).ok()?;
    // Repeated: close to the solution the first pass may stop as soon as the tolerance is met.
    let system = ModeSystem::new(trace.loading(), modes, &here.state);
    start.settle(system, polished.corrected.state, &closing, work).ok()
}

/// Whether a search ends in these modes, apart from contacts on the boundary of both modes.
fn is_mode_at(
    trace: &PathTrace<'_>,
    loading: Loading<'_>,
    end: &ProgramEnd,
    modes: &[Mode],
    reached: &Reached,
) -> bool {
    if agree(loading, &end.modes, modes) {
        return true;
    }
    let forces = trace.at.totals.force_scale.max(reached.corrected.force_scale);
    let state = &reached.corrected.state;
    let either: Vec<Mode> = (0..modes.len())
        .map(|contact| {
            let (found, expected) = (end.modes[contact], modes[contact]);
            if is_at_edge(loading, contact, (found, expected), state, reached.step, forces) { expected } else { found }
        })
        .collect();
    agree(loading, &either, modes)
}

/// Whether a contact is on the boundary of two modes.
fn is_at_edge(
    loading: Loading<'_>,
    contact: usize,
    (one, other): (Mode, Mode),
    state: &State,
    step: f64,
    forces: f64,
) -> bool {
    let reaction = &state.reactions[contact];
    if one.is_active() != other.is_active() {
        return loading.gap(contact, state).abs() <= MODE_BOUNDARY_TOLERANCE * step
            && reaction.size() <= MODE_BOUNDARY_TOLERANCE * forces;
    }
    let cone = loading.contacts[contact].friction.margin(reaction);
    match (one, other) {
        (Mode::Slip { .. }, Mode::Slip { .. }) => reaction.tangential_size() <= MODE_BOUNDARY_TOLERANCE * forces,
        _ => cone.abs() <= MODE_BOUNDARY_TOLERANCE * forces,
    }
}
