//! Acceptance of a point reached by a step: it becomes the present point and a row.

use crate::branching::bifurcation::branch_directions::tolerances::COINCIDENCE_COSINE;
use crate::branching::bifurcation::locate::Crossing;
use crate::branching::bifurcation::step_end::StepEnd;
use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::branching::selection::selection_rule;
use crate::continuation::increment::point_classification::{self, Arrival, Came};
use crate::continuation::increment::stages;
use crate::continuation::increment::step_control::{self, StepBalance};
use crate::continuation::increment::tolerances::UNSTRESSED_MULTIPLE;
use crate::continuation::path_state::motion::JumpCause;
use crate::continuation::path_state::path_context::{Emitted, PathTrace};
use crate::continuation::path_state::resumable_state::{Arriving, Phase};
use crate::continuation::path_state::tolerances::REACTION_ROUND_OFF;
use crate::mechanics::contact::{Mode, Reaction, all_continue};
use crate::mechanics::problem::natural_residual;
use crate::result::increment::{Increment, Point, PointKind};
use crate::result::stop_reason::StopReason;
use crate::step::event_functions::EventFunction;
use crate::step::interpolation::PlacedPoint;

/// Makes the reached point the present one and classifies it; `None` where its continuation would violate the contact
/// laws.
pub(crate) fn accept(trace: &mut PathTrace<'_>, end: StepEnd, balance: StepBalance) -> Option<Increment> {
    let joined = end.changes();
    let (reached, mut added) = (end.reached, balance.added);
    let step = trace.scene.arc_length(&trace.at.here.state, &reached.corrected.state, reached.step);
    added.step = step;
    trace.at.totals.add(&added);
    trace.at.counts.increments += 1;
    let here = &mut trace.at.here;
    let before = std::mem::replace(&mut here.state, reached.corrected.state);
    let begun = here.rate.take().filter(|_| joined == 0);
    let changes = reached.event.is_some_and(EventFunction::is_of_contact);
    here.apart = (changes && here.before.is_none()).then_some(reached.step);
    (here.before, here.is_factorised) = (None, false);
    let mut modes = std::mem::replace(&mut here.modes, reached.corrected.modes);
    here.drift = reached.drift;
    // Past its bend the path is an ordinary one, and predictions do not use points before the bend.
    let bends = here.beside.take().is_some();
    here.is_singular &= !bends;
    let begun = begun.filter(|_| !bends);
    let negative_before = here.signature.and_then(|signature| signature.negative);
    here.signature = end.signature;
    let arriving = Arriving { modes: here.modes.clone(), load_sign: here.load_sign, counts: trace.at.counts };
    let at_bound = stages::at_bound(trace, &reached.rate);
    let arrival_rate = trace.passed.is_some().then(|| reached.rate.clone());
    let arrived = changes.then(|| trace.at.here.state.reactions.clone());
    let came = Came {
        rate: reached.rate,
        step: reached.step,
        stopped: reached.stopped,
        nearby: reached.nearby,
        motions: reached.motions,
    };
    let mut arrival = what_it_is(trace, &mut modes, joined, reached.event, end.crossing, came);
    if end.returned {
        arrival.stop = Some(StopReason::Cycle);
    }
    let changed = joined > 0 || !all_continue(&trace.at.here.modes, &modes);
    let creeps = step_control::reason_of_creep(trace, reached.step, changed || at_bound || arrival.stage_ends);
    arrival.stop = arrival.stop.or(creeps);
    // A contact change may have redistributed reactions.
    if changes && !natural_residual::holds(trace.loading(), &trace.at.here.state, trace.at.totals.force_scale) {
        trace.at.totals.index -= 1;
        trace.end(StopReason::ContactViolated);
        return None;
    }
    let stage = &trace.scene.stages[trace.at.stage];
    let stage_ends = arrival.stage_ends || at_bound || trace.at.counts.end_stage(&stage.ends);
    // The next stage may hold what moves freely in this one.
    arrival.stop =
        arrival.stop.filter(|stop| !(stage_ends && *stop == StopReason::Mechanism && reached.event.is_none()));
    let unstable = !stage_ends && arrival.stop.is_none() && loses_stability(trace, arrival.point.kind, negative_before);
    let is_turned = arriving.load_sign >= 0.0 && trace.at.here.load_sign < 0.0;
    conclude(trace, &mut arrival, stage_ends, unstable, is_turned);
    let point = arrival.point;
    let reactions = arrived.filter(|arrived| is_anew(trace, arrived));
    trace.note_passed(arrival_rate, &arriving.modes, reached.event, point.kind, stage_ends);
    let row = trace.emit(Emitted {
        before: &before,
        reactions,
        modes: &modes,
        step,
        point,
        options: arrival.options,
        taken: arrival.taken,
        residual: residual_of_forces(trace, reached.corrected.residual, reached.corrected.force_scale),
        error_estimate: reached.error_estimate,
        mode_named: balance.mode_named.map(|named| named && !arrival.unconfirmed),
        arriving: Some(arriving),
    });
    if !changes && let Some(rate) = begun {
        trace.at.here.before = PlacedPoint::before(before, rate, &trace.at.here.state);
    }
    trace.at.stage_over = stage_ends && trace.at.phase == Phase::Running;
    Some(row)
}

/// Begins a jump, leaves an unstable path, or ends the path or its stage, if one of these comes next.
fn conclude(trace: &mut PathTrace<'_>, arrival: &mut Arrival, stage_ends: bool, unstable: bool, is_turned: bool) {
    if let Some(cause) = trace.cause_of_jump(is_turned, arrival.stop).filter(|_| !stage_ends) {
        stages::begin_jump(trace, cause, &mut arrival.point);
        arrival.taken = None;
    } else if unstable {
        arrival.taken = leave_unstable_path(trace, &arrival.options, &mut arrival.point);
    } else if let Some(reason) = arrival.stop {
        arrival.point.kind = PointKind::End;
        trace.end_at(reason, &arrival.options);
    } else if stage_ends {
        stages::tell_end(&mut arrival.point, &trace.scene.stages[trace.at.stage]);
    }
}

/// The residual over the force scale, or over what rounding makes of the structure's forces where these are no larger:
/// of a motion without stress nothing but rounding is left.
fn residual_of_forces(trace: &PathTrace<'_>, residual: f64, force_scale: f64) -> f64 {
    let forces = trace.at.totals.force_scale.max(force_scale);
    let none = UNSTRESSED_MULTIPLE * trace.structure.largest_rounding(&trace.at.here.state.displacement);
    if forces < none { residual * forces / none } else { residual }
}

/// Classifies the point. `modes` are the modes that led to it, unless changes treated together have replaced them.
fn what_it_is(
    trace: &mut PathTrace<'_>,
    modes: &mut Vec<Mode>,
    joined: u64,
    event: Option<EventFunction>,
    crossing: Option<Crossing>,
    came: Came,
) -> Arrival {
    if joined == 0 {
        return point_classification::classify(trace, event, crossing, came);
    }
    trace.at.here.is_singular = false;
    let arrival = point_classification::joined_changes(trace, modes, joined, came.rate);
    modes.clone_from(&trace.at.here.modes);
    arrival
}

/// Whether the load goes on by itself through a point past which more eigenvalues are negative than before.
fn loses_stability(trace: &PathTrace<'_>, kind: PointKind, before: Option<usize>) -> bool {
    let after = trace.at.here.signature.and_then(|signature| signature.negative);
    trace.rules().load_rises
        && kind == PointKind::SmoothBifurcation
        && after.is_some_and(|after| after > before.unwrap_or(0))
}

/// Leaves a path that becomes unstable: along a branch on which the load goes on, or by a jump towards one on which it does
/// not. Returns the direction taken.
fn leave_unstable_path(trace: &mut PathTrace<'_>, options: &[DirectionChoice], point: &mut Point) -> Option<usize> {
    let Some(own) = trace.at.here.rate.clone() else { return Some(0) };
    let is_branch = |index: usize| {
        let option = &options[index];
        !option.retrace && !option.mechanism && option.rate.product(&own) <= COINCIDENCE_COSINE
    };
    let rises = |index: usize| is_branch(index) && options[index].load_sign > 0.0;
    if let Some(rising) = selection_rule::preferred(options, &own, trace.rules(), rises) {
        trace.go(&options[rising]);
        trace.at.step = trace.at.step.min(trace.scene.analysis.arc_length.initial);
        return Some(rising);
    }
    let Some(branch) = selection_rule::preferred(options, &own, trace.rules(), is_branch) else { return Some(0) };
    stages::begin_jump(trace, JumpCause::LosesStability, point);
    if let Some(motion) = &mut trace.at.motion {
        motion.push.clone_from(&options[branch].rate.displacement);
    }
    None
}

/// Whether reactions differ from those with which a step arrived: the contacts of a node may share its force in another
/// way in the continuation of the path, but do not yet share it so at the point.
fn is_anew(trace: &PathTrace<'_>, arrived: &[Reaction]) -> bool {
    let round_off = REACTION_ROUND_OFF * trace.at.totals.force_scale;
    let now = trace.at.here.state.reactions.iter();
    now.zip(arrived).any(|(now, arrived)| now.difference(arrived) > round_off)
}
