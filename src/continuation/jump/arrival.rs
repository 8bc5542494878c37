//! The rows of a jump, and the directions at the state at rest.

use crate::continuation::increment::stages;
use crate::continuation::path_state::motion::JumpProgress;
use crate::continuation::path_state::path_context::{Emitted, PathTrace};
use crate::continuation::path_state::tolerances::SAME_STATE;
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
    let before = start_of_row(trace, &motion, settings);
    let step = before.distance(&trace.at.here.state);
    note_step(trace, step);
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
    let state = trace.at.here.state.clone();
    let system = ModeSystem::new(trace.loading(), &modes, &state);
    let residual = newton::judged(&system, state.clone(), trace.at.totals.force_scale).residual;
    trace.emit(Emitted {
        before: &before,
        reactions: None,
        modes: &modes,
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

/// The row of a state of the motion.
pub(crate) fn moving(trace: &mut PathTrace<'_>) -> Increment {
    trace.refer();
    let state = trace.at.here.state.clone();
    let before = trace.at.motion.as_mut().map_or_else(
        || state.clone(),
        |motion| motion.row.replace(state.clone()).unwrap_or_else(|| motion.from.clone()),
    );
    let step = before.distance(&state);
    note_step(trace, step);
    let modes = trace.at.here.modes.clone();
    let system = ModeSystem::new(trace.loading(), &modes, &state);
    let residual = newton::judged(&system, state.clone(), trace.at.totals.force_scale).residual;
    trace.emit(Emitted {
        before: &before,
        reactions: None,
        modes: &modes,
        step,
        point: Point::plain(PointKind::Motion, Some("the structure moves".to_owned())),
        options: Vec::new(),
        taken: None,
        residual,
        error_estimate: 0.0,
        mode_named: None,
        arriving: None,
    })
}

/// The state of the row before the state at rest.
fn start_of_row(trace: &PathTrace<'_>, motion: &JumpProgress, settings: &JumpMotion) -> State {
    let kept = motion.row.as_ref().filter(|_| settings.keep_steps);
    debug_assert!(trace.at.motion.is_none());
    kept.unwrap_or(&motion.from).clone()
}

fn note_step(trace: &mut PathTrace<'_>, step: f64) {
    trace.at.totals.index += 1;
    trace.at.totals.arc_length += step;
    trace.at.counts.increments += 1;
}
