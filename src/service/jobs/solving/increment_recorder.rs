//! Prepares the increments of a path for the store, with the branch points and checkpoints that are stored beside them.

use crate::check::judged::{JudgedIncrement, JudgedReport, Step};
use crate::output::json_line;
use crate::result::increment::{Diagnostics, Increment};
use crate::result::stop_reason::StopReason;
use crate::service::jobs::solving::branches::Branches;
use crate::service::jobs::solving::checkpoints::{Checkpoints, Clock, StoredCheckpoint};
use crate::service::jobs::solving::context::SolveContext;
use crate::service::jobs::solving::solve_output::{SolveEnd, SolveOutput};
use crate::service::jobs::solving::solver::Place;
use crate::service::metrics::{Solved, Work};
use crate::service::store::{Claim, Line};
use crate::studies::sweeps::LimitLoad;
use std::ops::ControlFlow;
use std::time::Instant;
use tokio::sync::mpsc;

/// Relative tolerance within which a stored increment and its recomputed value are the same: another version of this program
/// may round differently.
const SAME: f64 = 1e-6;

/// Receives the increments of an attempt, in order, and sends the new ones to the store.
pub struct IncrementRecorder<'a> {
    claim: &'a Claim,
    sender: &'a mpsc::Sender<SolveOutput>,
    work: &'a Work,
    /// When the solver began its current step.
    since: Instant,
    /// The totals of the path that have been counted; `None` if the path begins with the totals of another attempt or job.
    counted: Option<Diagnostics>,
    branches: Branches,
    checkpoints: Checkpoints,
    clock: Clock,
    /// The last stored increment, if it can be read.
    last: Option<JudgedIncrement>,
    /// The path has reached the last stored increment.
    has_arrived: bool,
    why_not: Option<SolveEnd>,
}

impl<'a> IncrementRecorder<'a> {
    /// Records a path from its start.
    pub fn new(context: &'a SolveContext, claim: &'a Claim, sender: &'a mpsc::Sender<SolveOutput>) -> Self {
        let put_down = context.flush_interval;
        // An increment in the format of another version is not compared.
        let last = claim.last.as_ref().and_then(|line| serde_json::from_str::<JudgedIncrement>(&line.body).ok());
        let mut clock = Clock::default();
        clock.go_on_from(last.as_ref().map_or(0.0, elapsed_s));
        Self {
            claim,
            sender,
            work: &context.metrics.work,
            since: Instant::now(),
            counted: claim.origin.is_none().then(Diagnostics::default),
            branches: Branches::every(put_down, claim.last_branch.as_deref()),
            checkpoints: Checkpoints::every(put_down),
            clock,
            last,
            has_arrived: claim.last.is_none(),
            why_not: None,
        }
    }

    /// Records a path from a checkpoint.
    pub fn go_on_from(&mut self, from: &StoredCheckpoint) {
        self.checkpoints.after(&from.at);
        self.counted = None;
        self.clock = from.clock;
        self.clock.go_on_from(self.last.as_ref().map_or(0.0, elapsed_s));
        self.has_arrived = self.claim.last.as_ref().is_none_or(|last| last.index <= from.at.path.index());
    }

    /// Counts the work of a step, and sends its increment; after a step without a recorded increment, a checkpoint if one is due.
    pub fn take(&mut self, step: Step, place: &dyn Place) -> ControlFlow<()> {
        let (time, totals) = (self.since.elapsed(), step.diagnostics);
        let before = self.counted.replace(totals).unwrap_or(totals);
        self.work.solved(Solved {
            time,
            factorisations: totals.factorisations.saturating_sub(before.factorisations),
            newton_iterations: totals.newton_iterations.saturating_sub(before.newton_iterations),
            qp_solves: totals.qp_solves.saturating_sub(before.qp_solves),
            mpec_solves: totals.mpec_solves.saturating_sub(before.mpec_solves),
            sqp_iterations: totals.sqp_iterations.saturating_sub(before.sqp_iterations),
            certificates: totals.certificates.saturating_sub(before.certificates),
        });
        let flow = match step.given {
            Some(judged) => self.send(judged, place),
            None => self.put_down(place),
        };
        self.since = Instant::now();
        flow
    }

    /// Sends an increment that is not stored yet; breaks if the receiver wants no more.
    fn send(&mut self, mut judged: JudgedIncrement, place: &dyn Place) -> ControlFlow<()> {
        let index = judged.increment.index;
        judged.increment.diagnostics.elapsed_s = self.clock.tell(elapsed_s(&judged));
        let stored = self.claim.last.as_ref().is_some_and(|last| index <= last.index);
        if !self.has_arrived && !self.arrive(&judged.increment) {
            self.why_not = Some(SolveEnd::Differs(index));
            return ControlFlow::Break(());
        }
        if stored {
            return ControlFlow::Continue(());
        }
        match self.line(&judged, place) {
            Ok((line, limit)) => self.pass(SolveOutput::Line(line, limit))?,
            Err(error) => return self.unwritable(&error),
        }
        self.put_down(place)
    }

    /// Sends a checkpoint if one is due and the path has reached the last stored increment.
    fn put_down(&mut self, place: &dyn Place) -> ControlFlow<()> {
        if !self.has_arrived {
            return ControlFlow::Continue(());
        }
        match self.checkpoints.at(place, self.clock) {
            Ok(None) => ControlFlow::Continue(()),
            Ok(Some(checkpoint)) => self.pass(SolveOutput::Checkpoint(checkpoint)),
            Err(error) => self.unwritable(&error),
        }
    }

    fn pass(&self, sent: SolveOutput) -> ControlFlow<()> {
        match self.sender.blocking_send(sent) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }

    fn unwritable(&mut self, error: &serde_json::Error) -> ControlFlow<()> {
        self.why_not = Some(SolveEnd::Unwritable(error.to_string()));
        ControlFlow::Break(())
    }

    /// Whether the path leads to the last stored increment.
    fn arrive(&mut self, increment: &Increment) -> bool {
        let claim = self.claim;
        let Some(last) = &claim.last else { return true };
        if increment.index < last.index {
            return true;
        }
        self.has_arrived = true;
        increment.index == last.index && self.last.as_ref().is_none_or(|last| are_same(&last.increment, increment))
    }

    fn line(&mut self, judged: &JudgedIncrement, place: &dyn Place) -> serde_json::Result<(Line, Option<String>)> {
        let body = json_line(judged)?;
        let branch = if judged.increment.directions.is_some() {
            let alternatives = if self.claim.explores { place.alternatives().to_vec() } else { Vec::new() };
            self.branches.at(place, alternatives)?
        } else {
            None
        };
        let limit = LimitLoad::at(&judged.increment).map(|limit| serde_json::to_string(&limit)).transpose()?;
        Ok((Line { index: judged.increment.index, body, branch }, limit))
    }

    /// How the solve ended, given the report of the path.
    pub fn end(self, report: Option<JudgedReport>) -> SolveEnd {
        let Self { mut clock, why_not, has_arrived, .. } = self;
        if let Some(why_not) = why_not {
            return why_not;
        }
        let Some(mut judged) = report else { return SolveEnd::Silent };
        match &self.claim.last {
            Some(last)
                if !has_arrived
                    && !matches!(judged.report.stop_reason, StopReason::Cancelled | StopReason::MemoryLimit) =>
            {
                SolveEnd::Differs(last.index)
            }
            _ => {
                judged.report.elapsed_s = clock.tell(judged.report.elapsed_s);
                SolveEnd::Reported(Box::new(judged))
            }
        }
    }
}

fn elapsed_s(judged: &JudgedIncrement) -> f64 {
    judged.increment.diagnostics.elapsed_s
}

/// Whether two increments are the same point of a path. Where nothing moves, the arc length shows the change of the load.
fn are_same(one: &Increment, other: &Increment) -> bool {
    let near = |one: f64, other: f64, size: f64| (one - other).abs() <= SAME * size;
    let size = |increment: &Increment| {
        increment.displacements.values().flatten().fold(0.0_f64, |size, value| size.max(value.abs()))
    };
    let size = size(one).max(size(other));
    one.index == other.index
        && one.stage == other.stage
        && near(one.arc_length, other.arc_length, one.arc_length.abs())
        && one.displacements.len() == other.displacements.len()
        && one.displacements.iter().zip(other.displacements.iter()).all(|((name, one), (other_name, other))| {
            name == other_name && one.iter().zip(other).all(|(one, other)| near(*one, *other, size))
        })
}
