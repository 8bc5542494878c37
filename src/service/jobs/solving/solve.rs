//! One solve on a thread of its own, never on the runtime's.
//!
//! Increments leave it over a bounded channel: a store that is slow makes the solver wait, not the memory grow. A panic
//! ends here and becomes the text of this one job.

use crate::model::decode;
use crate::resources::budget::{Breach, Budget};
use crate::resources::cancel::CancelFlag;
use crate::resources::panics;
use crate::service::jobs::solving::branches;
use crate::service::jobs::solving::checkpoints::PutDown;
use crate::service::jobs::solving::context::SolveContext;
use crate::service::jobs::solving::given::Given;
use crate::service::jobs::solving::sent::{Sent, SolveEnd};
use crate::service::jobs::solving::solver::{ResumeError, Solver};
use crate::service::store::{Claim, Line, Task};
use crate::studies::error_against_time::Run;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use tokio::sync::{mpsc, oneshot};

#[cfg(panic = "abort")]
compile_error!("a panic in a solve would end the service: build with panic = \"unwind\"");

/// Increments between solver and store: enough to solve on while a batch is written.
const IN_FLIGHT: usize = 4096;
/// Their bytes, roughly: an increment with its branch is hardly larger than [`OF_MODEL`] times its model, so large models
/// get fewer places.
const IN_FLIGHT_BYTES: usize = 32 << 20;
const OF_MODEL: usize = 4;
const FEWEST_IN_FLIGHT: usize = 8;
/// Recursion over a model is shallow, but the main thread's stack is what the solver is tested with.
const STACK_BYTES: usize = 8 << 20;

/// A solve under way.
pub struct Solve {
    pub sent: mpsc::Receiver<Sent>,
    pub end: oneshot::Receiver<SolveEnd>,
}

/// Starts the thread. A path goes on from its checkpoint, or, where there is none that can be read, from its start;
/// increments up to `claim.last` are stored already and not sent again. A study goes on from `stored`, the lines of its
/// finished runs. Checkpoints are made no sooner than the flush interval after one another.
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
                // Nobody claims one: its runs are claimed.
                Task::Sweep => SolveEnd::Silent,
                Task::Study => study(context.solver.as_ref(), &claim_of_thread, &stored, &cancel, &sender),
            };
            let ended = match catch_unwind(AssertUnwindSafe(|| budget.during(solve))) {
                Ok(Ok(ended)) => ended,
                Ok(Err(Breach::Cancelled)) => SolveEnd::Cancelled,
                Ok(Err(breach)) => SolveEnd::Exceeded(breach),
                Err(panic) => SolveEnd::Panicked(panics::text(panic.as_ref())),
            };
            // Nobody waits for the end when the runtime is going down.
            let _ = end_sender.send(ended);
        },
    )?;
    Ok(Solve { sent, end })
}

fn places(model_bytes: usize) -> usize {
    (IN_FLIGHT_BYTES / OF_MODEL / model_bytes.max(1)).clamp(FEWEST_IN_FLIGHT, IN_FLIGHT)
}

fn run(context: &SolveContext, claim: &Claim, cancel: CancelFlag, sender: &mpsc::Sender<Sent>) -> SolveEnd {
    let solver = context.solver.as_ref();
    let mut request = match decode::decode(claim.request.as_bytes()) {
        Ok(request) => request,
        Err(errors) => return SolveEnd::Refused(errors),
    };
    // A job that follows another has that one's request, but for this.
    request.analysis.max_increments = claim.max_increments;
    let anew = |why: &dyn std::error::Error| tracing::warn!(%why, "the path is traced from its start once more");
    match claim.checkpoint.as_ref().map(PutDown::read) {
        Some(Ok(from)) => {
            let mut given = Given::new(context, claim, sender);
            given.go_on_from(&from);
            tracing::info!(increment = from.at.path.index(), "goes on from its checkpoint");
            match solver.resume(&request, from.at, cancel.clone(), &mut |step, place| given.take(step, place)) {
                Ok(report) => return given.end(report),
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
    let mut given = Given::new(context, claim, sender);
    match solver.solve(&request, beginning, cancel.clone(), &mut |step, place| given.take(step, place)) {
        Ok(report) => given.end(report),
        // On the way to the point where it begins.
        Err(_) if cancel.is_cancelled() => SolveEnd::Cancelled,
        Err(errors) => SolveEnd::Refused(errors),
    }
}

fn study(
    solver: &dyn Solver,
    claim: &Claim,
    stored: &[Line],
    cancel: &CancelFlag,
    sender: &mpsc::Sender<Sent>,
) -> SolveEnd {
    let request = match decode::study(claim.request.as_bytes()) {
        Ok(request) => request,
        Err(errors) => return SolveEnd::Refused(errors),
    };
    let done: Vec<Run> = match stored.iter().map(|line| serde_json::from_str(&line.body)).collect() {
        Ok(done) => done,
        Err(error) => return SolveEnd::Unreadable(error.to_string()),
    };
    let mut unwritable = None;
    let reported = solver.study(&request, done, cancel, &mut |run| match serde_json::to_string(run) {
        Ok(body) => match sender.blocking_send(Sent::Line(Line { index: run.index, body, branch: None }, None)) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        },
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
