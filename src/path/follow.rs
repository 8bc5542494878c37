//! A path along a direction that another path did not take.

use super::advance::AT_END;
use super::checkpoint::{Checkpoint, CheckpointError};
use super::decide::{Choice, STATIONARY};
use super::history;
use super::increment::{Increment, Point, PointKind};
use super::progress::{Phase, StageCounts};
use super::scene::{End, Scene};
use super::totals::Totals;
use super::tracer::{Emitted, Path};
use crate::cancel::CancelFlag;
use crate::contact::{Mode, all_continue};
use serde::{Deserialize, Serialize};

/// The directions listed at a point, and what was true before one of them was taken.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Listed {
    pub options: Vec<Choice>,
    pub taken: Option<usize>,
    /// `None` where the path begins.
    pub arriving: Option<Arriving>,
    pub point: Point,
    pub residual: f64,
    pub error_estimate: f64,
}

/// How a path came to a point.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Arriving {
    pub modes: Vec<Mode>,
    pub load_sign: f64,
    /// The increment that led here counted, its events not.
    pub counts: StageCounts,
}

/// The beginning of a path that follows a direction of another.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Followed {
    pub listed: Listed,
    direction: usize,
    event: String,
}

impl<'a> Path<'a> {
    /// How many directions are listed at the present point; 0 where there is one way on.
    pub fn listed_directions(&self) -> usize {
        self.at.listed.as_ref().map_or(0, |listed| listed.options.len())
    }

    /// A path of its own from a checkpoint along one of the directions listed there.
    ///
    /// Its first increment, of index 0, is the point itself with `event` as its event; loads, energies, arc length and
    /// the counts of the stage are carried on. Work and time are its own. Along the direction that was taken, the
    /// increments are those of the path that was put down.
    ///
    /// # Errors
    /// A checkpoint that does not fit, and a direction along which there is no path.
    pub fn follow(
        scene: &'a Scene,
        checkpoint: Checkpoint,
        direction: usize,
        event: String,
        cancel: CancelFlag,
    ) -> Result<Self, CheckpointError> {
        let mut path = Self::resume(scene, checkpoint, cancel)?;
        let counts = path.counts_along(direction)?;
        let listed = path.at.listed.take().ok_or(CheckpointError::NothingListed)?;
        if listed.taken != Some(direction)
            && let Some(choice) = listed.options.get(direction)
        {
            path.turn(choice);
            if listed.point.kind == PointKind::SmoothBifurcation {
                // A branch bends from where it begins, whatever the path before did.
                path.at.step = path.at.step.min(scene.analysis.arc_length.initial);
            }
        }
        path.at.counts = counts;
        path.at.begun = path.at.here.rate.clone().map(|rate| (path.at.here.state.clone(), rate));
        path.at.phase = Phase::NotStarted;
        path.at.stage_over = false;
        let begun = Totals::begun();
        path.at.totals = Totals { index: begun.index, work: begun.work, report: begun.report, ..path.at.totals };
        path.elapsed_before = 0.0;
        path.at.followed = Some(Followed { listed, direction, event });
        Ok(path)
    }

    /// Whether a path goes along this one of the directions listed at the present point.
    pub fn can_be_followed(&self, direction: usize) -> bool {
        self.counts_along(direction).is_ok()
    }

    /// The stage's counts at the present point if the path leaves it along that direction, or why it cannot.
    fn counts_along(&self, direction: usize) -> Result<StageCounts, CheckpointError> {
        let listed = self.at.listed.as_ref().ok_or(CheckpointError::NothingListed)?;
        let options = listed.options.len();
        let choice = listed
            .options
            .get(direction)
            .ok_or(CheckpointError::NoSuchDirection { found: direction, listed: options })?;
        if choice.mechanism {
            return Err(CheckpointError::Mechanism { direction });
        }
        let mut counts = self.at.counts;
        if listed.taken != Some(direction)
            && let Some(arriving) = &listed.arriving
        {
            // What this point counts as depends on how the path leaves it.
            let changed = arriving.counts.contact_changes < counts.contact_changes
                || !all_continue(&arriving.modes, &choice.modes);
            let turned = arriving.load_sign * choice.load_sign < 0.0;
            counts = arriving.counts;
            counts.contact_changes += u64::from(changed);
            counts.limit_points += u64::from(turned);
        }
        if counts.end_stage(&self.scene.stages[self.at.stage].ends) || self.at.stage_over && self.goes_past_end(choice)
        {
            let stage = self.scene.stages[self.at.stage].name.to_string();
            return Err(CheckpointError::StageEnds { stage, direction });
        }
        Ok(counts)
    }

    /// Leaves the present point along another direction than the one taken there.
    fn turn(&mut self, choice: &Choice) {
        self.go(choice);
        let visited = self.visit();
        if !self.at.visited.states().any(|known| *known == visited) {
            self.at.visited.remember(visited, history::room(self.scene));
        }
    }

    /// Whether a direction leads out of the running stage at a bound that is reached here, or stays on it.
    fn goes_past_end(&self, choice: &Choice) -> bool {
        self.scene.stages[self.at.stage].ends.iter().any(|end| match *end {
            End::Load { bound, sign } => {
                sign * (self.at.here.state.load - bound) >= -AT_END && sign * choice.load_sign >= 0.0
            }
            End::Displacement { freedom, bound, sign } => {
                sign * (self.at.here.state.displacement[freedom] - bound) >= -AT_END
                    && sign * choice.rate.displacement[freedom] > -STATIONARY
            }
            End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_) => false,
        })
    }

    /// The first increment of a path that follows another's direction.
    pub(super) fn followed_row(&mut self, followed: Followed) -> Increment {
        self.at.phase = Phase::Running;
        let Followed { listed, direction, event } = followed;
        let point = Point { kind: PointKind::Start, event: Some(event), better_direction: false, ..listed.point };
        let state = self.at.here.state.clone();
        let modes = self.at.here.modes.clone();
        self.emit(Emitted {
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
}
