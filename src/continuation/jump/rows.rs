//! The rows of a jump, and the directions at the state at rest.

use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::continuation::increment::stages;
use crate::continuation::jump::comparison::{self, time_steps};
use crate::continuation::jump::jump_motion::{self, Advance, JumpEnd, NoRest};
use crate::continuation::jump::time_step::TimeStepScene;
use crate::continuation::path_state::path_context::{Emitted, PathTrace};
use crate::continuation::path_state::tolerances::SAME_STATE;
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::problem::state::State;
use crate::model::request::JumpMotion;
use crate::result::increment::{Increment, Point, PointKind};
use crate::result::stop_reason::StopReason;
use crate::step::corrector::newton;

/// The next row of a path that jumps: a time step, where they are kept, or the state at rest; `None` where the path ends.
pub(crate) fn next_row(trace: &mut PathTrace<'_>) -> Option<Increment> {
    let settings = trace.scene.analysis.jump_motion.unwrap_or_default();
    if settings.compare && !comparison::follow_other_motion(trace, &settings) {
        trace.end(StopReason::Cancelled);
        return None;
    }
    let mut scene = TimeStepScene::of(trace);
    loop {
        let Some(motion) = trace.at.motion.clone() else {
            trace.end(StopReason::NoEquilibrium);
            return None;
        };
        match jump_motion::advance(trace, motion, &settings, &mut scene) {
            Ok(Advance::AtRest) => return Some(at_rest(trace, &settings)),
            Ok(Advance::Moving) if settings.keep_steps => return Some(moving(trace)),
            Ok(Advance::Moving | Advance::Again) => {}
            Err(JumpEnd(reason, why)) => {
                end(trace, reason, why);
                return None;
            }
        }
    }
}

/// Ends a path that jumps: its report says why the motion does not come to rest, and where the other kind of motion leads.
fn end(trace: &mut PathTrace<'_>, reason: StopReason, why: Option<NoRest>) {
    trace.end(reason);
    if trace.at.totals.report.stop_reason != reason {
        return;
    }
    let other = trace.at.motion.as_ref().and_then(|motion| motion.other.as_ref());
    let parts = [
        why.map(|why| format!(": {}", why.sentence())),
        other.map(|other| format!("; {}", comparison::sentence_of_end(other))),
    ];
    trace.at.totals.report.sentence.extend(parts.into_iter().flatten());
}

/// The row of the state at rest, from which the path goes on: within its stage, or with the next where that ends here.
fn at_rest(trace: &mut PathTrace<'_>, settings: &JumpMotion) -> Increment {
    trace.refer();
    let Some(motion) = trace.at.motion.take() else { return moving(trace) };
    let kept = motion.row.as_ref().filter(|_| settings.keep_steps);
    let before = kept.unwrap_or(&motion.from).clone();
    note_step(trace, &before);
    let other = motion.other.as_ref().map(|other| comparison::compared(trace, other));
    let mut event = format!("at rest after an {} motion of {}", settings.kind.name(), time_steps(motion.steps));
    event.extend(other.as_ref().map(|other| format!("; {}", comparison::sentence(other))));
    let mut point = Point::plain(PointKind::Jump, Some(event));
    let modes = trace.at.here.modes.clone();
    let (options, taken) = if stages::is_over(trace) {
        trace.at.stage_over = true;
        stages::tell_end(&mut point, &trace.scene.stages[trace.at.stage]);
        (Vec::new(), None)
    } else {
        stages::depart(trace, &mut point)
    };
    if motion.from.distance(&trace.at.here.state) <= SAME_STATE && trace.at.motion.take().is_some() {
        trace.end(StopReason::NoDirection);
    }
    let row = emit(trace, &before, &modes, point, (options, taken));
    Increment { other_motion: other.map(Box::new), ..row }
}

/// The row of a state of the motion.
fn moving(trace: &mut PathTrace<'_>) -> Increment {
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
    let step = distance(trace, before);
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

/// The arc length from a state to the present one.
fn distance(trace: &PathTrace<'_>, before: &State) -> f64 {
    let here = &trace.at.here.state;
    trace.scene.arc_length(before, here, before.distance(here))
}

/// Counts the row from the state of the one before.
fn note_step(trace: &mut PathTrace<'_>, before: &State) {
    trace.at.totals.index += 1;
    trace.at.totals.arc_length += distance(trace, before);
    trace.at.counts.increments += 1;
}
