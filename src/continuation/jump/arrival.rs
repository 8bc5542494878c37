//! The rows of a jump, and the directions at the state at rest.

use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::continuation::increment::stages;
use crate::continuation::path_state::path_context::{Emitted, PathTrace};
use crate::continuation::path_state::tolerances::SAME_STATE;
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::problem::state::State;
use crate::model::request::{JumpMotion, JumpMotionKind};
use crate::result::increment::{Increment, Point, PointKind};
use crate::result::stop_reason::StopReason;
use crate::step::corrector::newton;

/// The row of the state at rest, from which the path goes on.
pub(crate) fn at_rest(trace: &mut PathTrace<'_>, settings: &JumpMotion) -> Increment {
    trace.refer();
    let Some(motion) = trace.at.motion.take() else { return moving(trace) };
    let kept = motion.row.as_ref().filter(|_| settings.keep_steps);
    let before = kept.unwrap_or(&motion.from).clone();
    note_step(trace, &before);
    let kind = match settings.kind {
        JumpMotionKind::Overdamped => "overdamped",
        JumpMotionKind::Inertial => "inertial",
    };
    let steps = if motion.steps == 1 { "time step" } else { "time steps" };
    let event = format!("at rest after an {kind} motion of {} {steps}", motion.steps);
    let mut point = Point::plain(PointKind::Jump, Some(event));
    let modes = trace.at.here.modes.clone();
    let (options, taken) = stages::depart(trace, &mut point);
    if motion.from.distance(&trace.at.here.state) <= SAME_STATE && trace.at.motion.take().is_some() {
        trace.end(StopReason::NoDirection);
    }
    emit(trace, &before, &modes, point, (options, taken))
}

/// The row of a state of the motion.
pub(crate) fn moving(trace: &mut PathTrace<'_>) -> Increment {
    trace.refer();
    let state = trace.at.here.state.clone();
    let before = trace.at.motion.as_mut().map_or_else(
        || state.clone(),
        |motion| motion.row.replace(state.clone()).unwrap_or_else(|| motion.from.clone()),
    );
    note_step(trace, &before);
    let modes = trace.at.here.modes.clone();
    let point = Point::plain(PointKind::Motion, Some("the structure moves".to_owned()));
    emit(trace, &before, &modes, point, (Vec::new(), None))
}

/// The row of the present state, in the modes that led there.
fn emit(
    trace: &mut PathTrace<'_>,
    before: &State,
    modes: &[Mode],
    point: Point,
    (options, taken): (Vec<DirectionChoice>, Option<usize>),
) -> Increment {
    let state = &trace.at.here.state;
    let system = ModeSystem::new(trace.loading(), modes, state);
    let residual = newton::judged(&system, state.clone(), trace.at.totals.force_scale).residual;
    let step = before.distance(state);
    trace.emit(Emitted {
        before,
        reactions: None,
        modes,
        step,
        point,
        options,
        taken,
        residual,
        error_estimate: 0.0,
        mode_named: None,
        arriving: None,
    })
}

/// Counts the row from the state of the one before.
fn note_step(trace: &mut PathTrace<'_>, before: &State) {
    trace.at.totals.index += 1;
    trace.at.totals.arc_length += before.distance(&trace.at.here.state);
    trace.at.counts.increments += 1;
}
