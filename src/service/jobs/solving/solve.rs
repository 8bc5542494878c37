//! Runs a solve on a thread of its own, apart from the threads of the runtime.
//!
//! The solve sends its increments over a bounded channel: a slow store makes the solver wait instead of filling the memory. A
//! panic is caught here and becomes the error of the job.

use crate::model::{ParameterCurve, decode};
use crate::resources::budget::{Breach, Budget};
use crate::resources::cancel::CancelFlag;
use crate::resources::panics;
use crate::service::jobs::solving::branches;
use crate::service::jobs::solving::checkpoints::StoredCheckpoint;
use crate::service::jobs::solving::context::SolveContext;
use crate::service::jobs::solving::increment_recorder::IncrementRecorder;
use crate::service::jobs::solving::solve_output::{SolveEnd, SolveOutput};
use crate::service::jobs::solving::solver::{ResumeError, Solver};
use crate::service::store::{Claim, Line, Task};
use crate::studies::error_against_time::StudyRun;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use tokio::sync::{mpsc, oneshot};

#[cfg(panic = "abort")]
compile_error!("a panic in a solve would end the service: build with panic = \"unwind\"");

/// Increments between solver and store, enough for the solver to continue while a batch is written.
const IN_FLIGHT: usize = 4096;
/// Approximate bytes of these increments: an increment with its branch is hardly larger than [`OF_MODEL`] times its model, so
/// that the channel of a large model has fewer places.
const IN_FLIGHT_BYTES: usize = 32 << 20;
const OF_MODEL: usize = 4;
const FEWEST_IN_FLIGHT: usize = 8;
/// The usual size of the stack of a main thread, with which the solver is tested.
const STACK_BYTES: usize = 8 << 20;

/// A running solve.
pub struct Solve {
    pub sent: mpsc::Receiver<SolveOutput>,
    pub end: oneshot::Receiver<SolveEnd>,
}

/// Starts the thread. A path resumes from its checkpoint, or starts again if there is none that can be read; increments up to
/// `claim.last` are stored already and not sent again. A study resumes from `stored`, the lines of its finished runs; a curve
/// begins anew, and its `stored` points are not sent again.
/// Checkpoints are at least the flush interval apart.
pub fn start(context: SolveContext, claim: &Claim, stored: Vec<Line>, cancel: CancelFlag) -> std::io::Result<Solve> {
    let (sender, sent) = mpsc::channel(places(claim.request.len()));
    let (end_sender, end) = oneshot::channel();
    let claim_of_thread = claim.clone();
    let span = tracing::Span::current();
    std::thread::Builder::new().name(format!("solve-{}", claim.lease.job)).stack_size(STACK_BYTES).spawn(
        move || {
            let _entered = span.enter();
            let budget = Budget::new(cancel.clone(), context.bounds);
            context.running.begun(&claim_of_thread.lease, &budget);
            let solve = || match claim_of_thread.task {
                Task::Path => run(&context, &claim_of_thread, cancel, &sender),
                // Workers claim the runs of a sweep, not the sweep.
                Task::Sweep => SolveEnd::Silent,
                Task::Study => study(context.solver.as_ref(), &claim_of_thread, &stored, &cancel, &sender),
                Task::Curve => curve(context.solver.as_ref(), &claim_of_thread, &stored, &cancel, &sender),
            };
            let ended = match catch_unwind(AssertUnwindSafe(|| budget.during(solve))) {
                Ok(Ok(ended)) => ended,
                Ok(Err(Breach::Cancelled)) => SolveEnd::Cancelled,
                Ok(Err(breach)) => SolveEnd::Exceeded(breach),
                Err(panic) => SolveEnd::Panicked(panics::text(panic.as_ref())),
            };
            // The receiver is gone if the runtime is shutting down.
            let _ = end_sender.send(ended);
        },
    )?;
    Ok(Solve { sent, end })
}

fn places(model_bytes: usize) -> usize {
    (IN_FLIGHT_BYTES / OF_MODEL / model_bytes.max(1)).clamp(FEWEST_IN_FLIGHT, IN_FLIGHT)
}

fn run(context: &SolveContext, claim: &Claim, cancel: CancelFlag, sender: &mpsc::Sender<SolveOutput>) -> SolveEnd {
    let solver = context.solver.as_ref();
    let mut request = match decode::decode(claim.request.as_bytes()) {
        Ok(request) => request,
        Err(errors) => return SolveEnd::Refused(errors),
    };
    // A job that follows another has the same request except for this member.
    request.analysis.max_increments = claim.max_increments;
    let anew = |why: &dyn std::error::Error| tracing::warn!(%why, "the path is traced again from its start");
    match claim.checkpoint.as_ref().map(StoredCheckpoint::read) {
        Some(Ok(from)) => {
            let mut recorder = IncrementRecorder::new(context, claim, sender);
            recorder.go_on_from(&from);
            tracing::info!(increment = from.at.path.index(), "resumed from its checkpoint");
            match solver.resume(&request, from.at, cancel.clone(), &mut |step, place| recorder.take(step, place)) {
                Ok(report) => return recorder.end(report),
                Err(ResumeError::Input(errors)) => return SolveEnd::Refused(errors),
                Err(ResumeError::Checkpoint(error)) => anew(&error),
            }
        }
        Some(Err(error)) => anew(&error),
        None => {}
    }
    let beginning = match claim.origin.as_ref().map(|(parent, origin)| branches::beginning(parent, origin)).transpose()
    {
        Ok(beginning) => beginning,
        Err(error) => return SolveEnd::Unreadable(error.to_string()),
    };
    let mut recorder = IncrementRecorder::new(context, claim, sender);
    match solver.solve(&request, beginning, cancel.clone(), &mut |step, place| recorder.take(step, place)) {
        Ok(report) => recorder.end(report),
        // Cancelled while the path of the parent was retraced.
        Err(_) if cancel.is_cancelled() => SolveEnd::Cancelled,
        Err(errors) => SolveEnd::Refused(errors),
    }
}

fn study(
    solver: &dyn Solver,
    claim: &Claim,
    stored: &[Line],
    cancel: &CancelFlag,
    sender: &mpsc::Sender<SolveOutput>,
) -> SolveEnd {
    let request = match decode::study(claim.request.as_bytes()) {
        Ok(request) => request,
        Err(errors) => return SolveEnd::Refused(errors),
    };
    let done: Vec<StudyRun> = match stored.iter().map(|line| serde_json::from_str(&line.body)).collect() {
        Ok(done) => done,
        Err(error) => return SolveEnd::Unreadable(error.to_string()),
    };
    let mut unwritable = None;
    let reported = solver.study(&request, done, cancel, &mut |run| match serde_json::to_string(run) {
        Ok(body) => {
            match sender.blocking_send(SolveOutput::Line(Line { index: run.index, body, branch: None }, None)) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        }
        Err(error) => {
            unwritable = Some(error.to_string());
            ControlFlow::Break(())
        }
    });
    match (unwritable, reported) {
        (Some(error), _) => SolveEnd::Unwritable(error),
        (None, Ok(Some(report))) => SolveEnd::Studied(report),
        (None, Ok(None)) if cancel.is_cancelled() => SolveEnd::Cancelled,
        (None, Ok(None)) => SolveEnd::Silent,
        (None, Err(errors)) => SolveEnd::Refused(errors),
    }
}

/// Points come out the same again, bit for bit, so that a curve that is resumed begins anew: it takes seconds.
fn curve(
    solver: &dyn Solver,
    claim: &Claim,
    stored: &[Line],
    cancel: &CancelFlag,
    sender: &mpsc::Sender<SolveOutput>,
) -> SolveEnd {
    let curve = match ParameterCurve::read(claim.request.as_bytes()) {
        Ok(curve) => curve,
        Err(errors) => return SolveEnd::Refused(errors),
    };
    let mut failed = None;
    let found = solver.curve(&curve, cancel, &mut |row| {
        let body = match serde_json::to_string(&row) {
            Ok(body) => body,
            Err(error) => {
                failed = Some(SolveEnd::Unwritable(error.to_string()));
                return ControlFlow::Break(());
            }
        };
        match stored.get(usize::try_from(row.index).unwrap_or(usize::MAX)) {
            Some(line) if line.body == body => ControlFlow::Continue(()),
            Some(line) => {
                failed = Some(SolveEnd::Differs(line.index));
                ControlFlow::Break(())
            }
            None => {
                match sender.blocking_send(SolveOutput::Line(Line { index: row.index, body, branch: None }, None)) {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(_) => ControlFlow::Break(()),
                }
            }
        }
    });
    match (failed, found) {
        (Some(failed), _) => failed,
        (None, Ok(summary)) => SolveEnd::Curved(summary),
        (None, Err(_)) if cancel.is_cancelled() => SolveEnd::Cancelled,
        (None, Err(errors)) => SolveEnd::NoCurve(errors),
    }
}
