//! A path along a direction that another path did not take.

use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::branching::directions::tolerances::STATIONARY_LOAD_RATE;
use crate::continuation::path::checkpoint::CheckpointError;
use crate::step::tolerances::BOUND_TOLERANCE;

use crate::continuation::path_state::path_context::{Emitted, PathTrace};
use crate::continuation::path_state::resumable_state::{Followed, Phase, StageCounts};
use crate::continuation::path_state::totals::Totals;

use crate::continuation::path_state::visited_states;
use crate::mechanics::contact::all_continue;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::result::increment::{Increment, Point, PointKind};

/// A separate path from a point along one of the directions listed there: see `Path::follow`.
pub(crate) fn along(
    mut trace: PathTrace<'_>,
    direction: usize,
    event: String,
) -> Result<PathTrace<'_>, CheckpointError> {
    let counts = counts_along(&trace, direction)?;
    let listed = trace.at.listed.take().ok_or(CheckpointError::NothingListed)?;
    if listed.taken != Some(direction)
        && let Some(choice) = listed.options.get(direction)
    {
        turn(&mut trace, choice);
        if listed.point.kind == PointKind::SmoothBifurcation {
            // A branch bends from its start, whatever the curvature of the path before.
            trace.at.step = trace.at.step.min(trace.scene.analysis.arc_length.initial);
        }
    }
    trace.at.counts = counts;
    trace.at.begun = trace.at.here.rate.clone().map(|rate| (trace.at.here.state.clone(), rate));
    trace.at.phase = Phase::NotStarted;
    trace.at.stage_over = false;
    let begun = Totals::begun();
    trace.at.totals = Totals { index: begun.index, work: begun.work, report: begun.report, ..trace.at.totals };
    trace.elapsed_before = 0.0;
    trace.at.followed = Some(Followed { listed, direction, event });
    Ok(trace)
}

/// The stage's counts at the present point if the path leaves it along a direction, or the reason why it cannot.
pub(crate) fn counts_along(trace: &PathTrace<'_>, direction: usize) -> Result<StageCounts, CheckpointError> {
    let listed = trace.at.listed.as_ref().ok_or(CheckpointError::NothingListed)?;
    let options = listed.options.len();
    let choice =
        listed.options.get(direction).ok_or(CheckpointError::NoSuchDirection { found: direction, listed: options })?;
    if choice.mechanism {
        return Err(CheckpointError::Mechanism { direction });
    }
    let mut counts = trace.at.counts;
    if listed.taken != Some(direction)
        && let Some(arriving) = &listed.arriving
    {
        // The counts at this point depend on the direction in which the path leaves it.
        let changed =
            arriving.counts.contact_changes < counts.contact_changes || !all_continue(&arriving.modes, &choice.modes);
        let turned = arriving.load_sign * choice.load_sign < 0.0;
        counts = arriving.counts;
        counts.contact_changes += u64::from(changed);
        counts.limit_points += u64::from(turned);
    }
    if counts.end_stage(&trace.scene.stages[trace.at.stage].ends) || trace.at.stage_over && goes_past_end(trace, choice)
    {
        let stage = trace.scene.stages[trace.at.stage].name.to_string();
        return Err(CheckpointError::StageEnds { stage, direction });
    }
    Ok(counts)
}

/// Leaves the present point along another direction than the one taken there.
fn turn(trace: &mut PathTrace<'_>, choice: &DirectionChoice) {
    trace.go(choice);
    let visited = trace.visit();
    if !trace.at.visited.states().any(|known| *known == visited) {
        trace.at.visited.remember(visited, visited_states::room(trace.scene));
    }
}

/// Whether a direction leaves the running stage at a bound that is reached at the present point, or remains on the
/// bound.
fn goes_past_end(trace: &PathTrace<'_>, choice: &DirectionChoice) -> bool {
    trace.scene.stages[trace.at.stage].ends.iter().any(|end| match *end {
        End::Load { bound, sign } => {
            sign * (trace.at.here.state.load - bound) >= -BOUND_TOLERANCE && sign * choice.load_sign >= 0.0
        }
        End::Displacement { freedom, bound, sign } => {
            sign * (trace.at.here.state.displacement[freedom] - bound) >= -BOUND_TOLERANCE
                && sign * choice.rate.displacement[freedom] > -STATIONARY_LOAD_RATE
        }
        End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_) => false,
    })
}

/// The first increment of a path that follows another's direction.
pub(crate) fn first_increment(trace: &mut PathTrace<'_>, followed: Followed) -> Increment {
    trace.at.phase = Phase::Running;
    let Followed { listed, direction, event } = followed;
    let point = Point { kind: PointKind::Start, event: Some(event), better_direction: false, ..listed.point };
    let state = trace.at.here.state.clone();
    let modes = trace.at.here.modes.clone();
    trace.emit(Emitted {
        before: &state,
        reactions: None,
        modes: &modes,
        step: 0.0,
        point,
        options: listed.options,
        taken: Some(direction),
        residual: listed.residual,
        error_estimate: listed.error_estimate,
        mode_named: None,
        arriving: listed.arriving,
    })
}
