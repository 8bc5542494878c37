//! The beginning and the end of a stage, and the transition to the next.

use crate::branching::directions::feasible_direction::{self, DirectionChoice, PriorMotion};
use crate::branching::directions::trial_step::later_sign;
use crate::branching::selection::selection_rule::{self, Decision};
use crate::continuation::increment::limit_point_start;
use crate::continuation::path_state::event_descriptions::{describe_change, describe_slipping, describe_start};
use crate::continuation::path_state::motion::{JumpCause, JumpProgress};
use crate::continuation::path_state::path_context::{Emitted, PathTrace};
use crate::continuation::path_state::resumable_state::{Phase, StageCounts};
use crate::continuation::path_state::visited_states::VisitedStates;
use crate::continuation::scene::StageLoad;
use crate::mechanics::contact::all_continue;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::state::Rate;
use crate::result::increment::{Increment, Point, PointKind};
use crate::result::stop_reason::StopReason;
use crate::step::corrector::newton;
use crate::step::event_functions::EventFunction;
use crate::step::tolerances::BOUND_TOLERANCE;

/// The row with which a stage begins: the directions there, one of them taken. Where a bound of the stage is already
/// met, the stage ends there too.
pub(crate) fn begin_stage(trace: &mut PathTrace<'_>) -> Increment {
    if trace.at.phase == Phase::Running {
        trace.at.totals.index += 1;
    }
    trace.at.phase = Phase::Running;
    trace.look_ahead(trace.at.step);
    trace.at.stage_over = bound_is_met(trace);
    let event = describe_start(trace.scene, trace.at.stage, trace.at.stage_over);
    let mut point = Point::plain(PointKind::Start, Some(event));
    let (mut options, mut taken) = (Vec::new(), None);
    if !trace.at.stage_over {
        let before = trace.at.here.modes.clone();
        (options, taken) = depart(trace, &mut point);
        let changes = match trace.at.stage {
            _ if taken.is_none() => None,
            // No contact has a mode before the first stage.
            0 => describe_slipping(trace.names(), trace.loading(), &trace.at.here.modes),
            _ if all_continue(&trace.at.here.modes, &before) => None,
            _ => Some(describe_change(trace.names(), &before, Some(&trace.at.here.modes), &[])),
        };
        if let (Some(event), Some(changes)) = (&mut point.event, changes) {
            *event = format!("{event}; {changes}");
        }
    }
    let here = &trace.at.here;
    let (state, modes) = (here.state.clone(), here.modes.clone());
    let system = ModeSystem::new(trace.loading(), &modes, &state);
    let residual = newton::judged(&system, state.clone(), trace.at.totals.force_scale).residual;
    let error_estimate = here.drift.as_ref().map_or(0.0, Rate::size);
    let rate = trace.passed.is_some().then(|| trace.at.here.rate.clone()).flatten();
    trace.note_passed(rate, &modes, None, PointKind::Start, false);
    trace.emit(Emitted {
        before: &state,
        reactions: None,
        modes: &modes,
        step: 0.0,
        point,
        options,
        taken,
        residual,
        error_estimate,
        mode_named: None,
        arriving: None,
    })
}

/// Takes a direction from a state at rest, and enters in the point what was found; returns the directions and the one
/// taken. Where the load is to rise and cannot, a jump begins.
pub(crate) fn depart(trace: &mut PathTrace<'_>, point: &mut Point) -> (Vec<DirectionChoice>, Option<usize>) {
    let state = &trace.at.here.state;
    let free =
        trace.at.free_motion.as_deref().filter(|motion| limit_point_start::does_no_work(trace.loading(), motion));
    let before = PriorMotion::StageStart { free };
    let mut decision = selection_rule::decide(trace.loading(), state, &trace.standings(state), before, trace.rules());
    trace.at.free_motion = None;
    if trace.rules().load_rises {
        rise(trace, &mut decision);
    }
    trace.take(&mut decision);
    trace.at.begun = trace.at.here.rate.clone().map(|rate| (trace.at.here.state.clone(), rate));
    trace.at.step = trace.at.step.min(trace.scene.analysis.arc_length.initial);
    point.bifurcation = feasible_direction::is_bifurcation(&decision.options, decision.taken, None);
    point.unexplored_modes = decision.unexplored;
    point.degenerate = decision.degenerate;
    let cannot_rise = decision.taken.is_some_and(|taken| decision.options[taken].load_sign < 0.0);
    if let Some(cause) = trace.cause_of_jump(cannot_rise, decision.stop) {
        begin_jump(trace, cause, point);
        return (decision.options, None);
    }
    if let Some(reason) = decision.stop {
        trace.end_at(reason, &decision.options);
    }
    (decision.options, decision.taken)
}

/// Tells of directions whose load rate is zero at first order, as at a limit point, whether the load rises along them, and
/// takes one along which it does, if there is one.
fn rise(trace: &PathTrace<'_>, decision: &mut Decision) {
    let (loading, state, rules) = (trace.loading(), &trace.at.here.state, trace.rules());
    for option in decision.options.iter_mut().filter(|option| option.load_sign == 0.0 && !option.mechanism) {
        option.load_sign = later_sign(loading, state, &option.rate, &option.modes, rules.force_scale).sign;
    }
    let rises = |index: &usize| decision.options[*index].load_sign > 0.0 && !decision.options[*index].mechanism;
    let mut open: Vec<usize> = (0..decision.options.len()).filter(rises).collect();
    selection_rule::retain_most_stable(loading, state, &decision.options, &mut open, rules);
    if let Some(taken) = decision.taken.filter(|taken| !open.contains(taken)) {
        let along = &decision.options[taken].rate;
        let rising = selection_rule::preferred(&decision.options, along, rules, |index| open.contains(&index));
        decision.taken = rising.or(decision.taken);
    }
}

/// Lets the structure jump from the present point.
pub(crate) fn begin_jump(trace: &mut PathTrace<'_>, cause: JumpCause, point: &mut Point) {
    let what = cause.describe(trace.scene.stages[trace.at.stage].falls()).to_owned();
    point.event = Some(point.event.take().map_or(what.clone(), |event| format!("{event}; {what}")));
    trace.at.here.rate = None;
    trace.at.motion = Some(JumpProgress::begin(trace.at.here.state.clone(), cause));
}

/// Whether a load or displacement at which the stage ends is met before the stage begins.
fn bound_is_met(trace: &PathTrace<'_>) -> bool {
    let here = &trace.at.here;
    let still = Rate {
        displacement: vec![0.0; here.state.displacement.len()],
        load: 0.0,
        reactions: here.state.reactions.clone(),
    };
    let left = |end: &End| EventFunction::End(*end).value(trace.loading(), &here.modes, &here.state, &still);
    trace.scene.stages[trace.at.stage].ends.iter().any(|end| left(end) <= 0.0)
}

/// Whether the stage ends at a state at rest to which the structure has jumped: a bound is passed or a count is full.
pub(crate) fn is_over(trace: &PathTrace<'_>) -> bool {
    bound_is_met(trace) || trace.at.counts.end_stage(&trace.scene.stages[trace.at.stage].ends)
}

/// Enters in a point that a stage, or a part of its history, ends there.
pub(crate) fn tell_end(point: &mut Point, stage: &StageLoad) {
    if point.kind == PointKind::Regular {
        point.kind = PointKind::End;
    }
    let what = if stage.turns { "the load turns".to_owned() } else { format!("stage \"{}\" ends", stage.name) };
    point.event = Some(point.event.take().map_or(what.clone(), |event| format!("{event}; {what}")));
}

/// Keeps the load that the stage reached and begins the next stage; `false` where there is none.
pub(crate) fn next_stage(trace: &mut PathTrace<'_>) -> bool {
    if trace.at.stage + 1 == trace.scene.stages.len() {
        trace.end(StopReason::StagesCompleted);
        return false;
    }
    let free_motion = limit_point_start::free_motion(trace);
    let at = &mut trace.at;
    at.free_motion = free_motion;
    at.reached.push(at.here.state.load);
    at.hold(trace.scene);
    at.stage += 1;
    at.here.state.set_load(0.0);
    at.here.rate = None;
    at.here.signature = None;
    (at.here.before, at.here.apart) = (None, None);
    at.counts = StageCounts::default();
    at.visited = VisitedStates::default();
    trace.load_anew();
    true
}

/// Whether a load or displacement at which the stage ends is reached at the present point, whatever else happens there;
/// the load is then set exactly.
pub(crate) fn at_bound(trace: &mut PathTrace<'_>, rate: &Rate) -> bool {
    let here = &trace.at.here;
    let left = |end: &End| EventFunction::End(*end).value(trace.loading(), &here.modes, &here.state, rate);
    let met = trace.scene.stages[trace.at.stage].ends.iter().find(|end| left(end) <= BOUND_TOLERANCE);
    if let Some(End::Load { bound, .. }) = met {
        trace.at.here.state.set_load(*bound);
    }
    met.is_some()
}
