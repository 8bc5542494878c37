//! The path as an iterator of increments.
//!
//! Between events the path keeps its contact mode and is followed by arc-length steps; where the mode ends, the
//! directions are listed and one is taken. The step length is controlled by the turn of the path and the Newton
//! iterations.

use crate::continuation::increment::{acceptance, stages, step_control};
use crate::continuation::jump::rows;
use crate::continuation::path::branch_switching;
use crate::continuation::path::checkpoint::{self, Checkpoint, CheckpointError};
use crate::continuation::path_state::passed_points::PassedPoint;
use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::resumable_state::{Phase, Progress};
use crate::continuation::scene::Scene;
use crate::resources::budget::{self, Budget};
use crate::resources::cancel::CancelFlag;
use crate::result::increment::Increment;
use crate::result::program_iterate::ProgramIterate;
use crate::result::report::Report;
use crate::result::stop_reason::StopReason;

/// A path being traced.
pub struct Path<'a> {
    pub(crate) trace: PathTrace<'a>,
    budget: Budget,
}

impl<'a> Path<'a> {
    pub fn new(scene: &'a Scene, cancel: CancelFlag) -> Self {
        Self::along(PathTrace::at(scene, Progress::new(scene), 0.0, cancel))
    }

    fn along(trace: PathTrace<'a>) -> Self {
        Self { budget: Budget::under_way(trace.cancel.clone()), trace }
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        let at = &self.trace.at;
        (at.phase == Phase::Ended).then(|| at.totals.report.clone())
    }

    /// Limits the next step to this arc length (dimensionless), so that a point can be placed where it is wanted.
    /// `analysis.arc_length.min` remains the lower bound.
    pub fn shorten_next(&mut self, longest: f64) {
        let least = self.trace.scene.analysis.arc_length.min;
        self.trace.at.step = self.trace.at.step.min(longest.max(least));
    }

    /// Keeps the iterates of each increment's programs from now on, each until the next increment.
    pub fn keep_iterates(&mut self) {
        self.trace.iterates = Some(Vec::new());
    }

    /// The iterates of the last increment for which a program was solved; empty where they are not kept.
    pub fn iterates(&self) -> &[ProgramIterate] {
        self.trace.iterates.as_deref().unwrap_or_default()
    }

    /// Keeps from now on the points at which contacts change, the load turns or a stage ends.
    pub(crate) fn keep_passed_points(&mut self) {
        self.trace.passed = Some(Vec::new());
    }

    /// The points kept so far; empty where they are not kept.
    pub(crate) fn passed_points(&self) -> &[PassedPoint] {
        self.trace.passed.as_deref().unwrap_or_default()
    }

    /// The points kept so far, without the path.
    pub(crate) fn into_passed_points(self) -> Vec<PassedPoint> {
        self.trace.passed.unwrap_or_default()
    }

    /// A checkpoint of the path at its present point; valid after any call of `next`.
    pub fn checkpoint(&self) -> Checkpoint {
        checkpoint::put_down(&self.trace)
    }

    /// Resumes a path from a checkpoint; its increments are the same, bit for bit, as those of the uninterrupted path.
    ///
    /// # Errors
    /// A checkpoint of another model, or of another version of this program.
    pub fn resume(scene: &'a Scene, checkpoint: Checkpoint, cancel: CancelFlag) -> Result<Self, CheckpointError> {
        checkpoint::take_up(scene, checkpoint, cancel).map(Self::along)
    }

    /// The number of directions listed at the present point; 0 where the continuation is unique.
    pub fn listed_directions(&self) -> usize {
        self.trace.at.listed.as_ref().map_or(0, |listed| listed.options.len())
    }

    /// A separate path from a checkpoint along one of the directions listed there.
    ///
    /// Its first increment, of index 0, is the point itself with `event` as its event; loads, energies, arc length and
    /// the counts of the stage are carried over. Work and time begin at zero. Along the direction that was taken, the
    /// increments are those of the original path.
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
        let trace = checkpoint::take_up(scene, checkpoint, cancel)?;
        branch_switching::along(trace, direction, event).map(Self::along)
    }

    /// Whether a path can follow this one of the directions listed at the present point.
    pub fn can_be_followed(&self, direction: usize) -> bool {
        branch_switching::counts_along(&self.trace, direction).is_ok()
    }
}

impl Iterator for Path<'_> {
    type Item = Increment;

    fn next(&mut self) -> Option<Increment> {
        let (budget, index) = (self.budget.clone(), self.trace.at.totals.index);
        let trace = &mut self.trace;
        budget.during(|| increment(trace)).unwrap_or_else(|breach| {
            self.trace.break_off(breach, index);
            None
        })
    }
}

/// The next increment; `None` where the path has ended.
fn increment(trace: &mut PathTrace<'_>) -> Option<Increment> {
    match trace.at.phase {
        Phase::Ended => return None,
        Phase::NotStarted => {
            budget::spend(0);
            return Some(match trace.at.followed.take() {
                Some(followed) => branch_switching::first_increment(trace, followed),
                None => stages::begin_stage(trace),
            });
        }
        Phase::Running => {}
    }
    if std::mem::take(&mut trace.at.stage_over) && !stages::next_stage(trace) {
        return None;
    }
    if trace.cancel.is_cancelled() {
        trace.end(StopReason::Cancelled);
        return None;
    }
    if trace.at.totals.index >= trace.scene.analysis.max_increments {
        trace.end(StopReason::MaxIncrements);
        return None;
    }
    if trace.at.motion.is_some() {
        return rows::next_row(trace);
    }
    trace.refer();
    if trace.at.here.rate.is_none() {
        return Some(stages::begin_stage(trace));
    }
    match step_control::step(trace) {
        Ok((end, balance)) => acceptance::accept(trace, end, balance),
        Err(reason) => {
            trace.end(reason);
            None
        }
    }
}
