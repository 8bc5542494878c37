//! One solve on a thread of its own, never on the runtime's.
//!
//! Increments leave it over a bounded channel: a store that is slow makes the solver wait, not the memory grow. A panic
//! ends here and becomes the text of this one job.

use super::Solver;
use super::branches::{self, Recorder};
use super::explore::Alternatives;
use super::solver::Accept;
use crate::cancel::CancelFlag;
use crate::judged::JudgedReport;
use crate::model::{InputErrors, decode};
use crate::output::json_line;
use crate::store::{Claim, Line, Task};
use crate::studies::{self, Run};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// Increments between solver and store: enough to solve on while a batch is written.
const IN_FLIGHT: usize = 512;
/// Their bytes, roughly: an increment with its branch is hardly larger than [`OF_MODEL`] times its model, so large models
/// get fewer places.
const IN_FLIGHT_BYTES: usize = 32 << 20;
const OF_MODEL: usize = 4;
const FEWEST_IN_FLIGHT: usize = 8;
/// Recursion over a model is shallow, but the main thread's stack is what the solver is tested with.
const STACK_BYTES: usize = 8 << 20;

/// How a solve ended.
#[derive(Debug)]
pub enum SolveEnd {
    Reported(Box<JudgedReport>),
    /// The stored request is no longer accepted, for example after an upgrade.
    Refused(InputErrors),
    Panicked(String),
    Unwritable(String),
    /// Where the job begins, or what it has found already, cannot be read.
    Unreadable(String),
    /// A study has ended, complete or cancelled.
    Studied(studies::Report),
    /// Cancelled before there was anything to report.
    Cancelled,
    /// Without a report: nobody listened any more, or a defect.
    Silent,
}

/// A solve under way.
pub struct Solve {
    pub lines: mpsc::Receiver<Line>,
    pub end: oneshot::Receiver<SolveEnd>,
}

/// Starts the thread. Increments up to `claim.last_index` are stored already: they are computed again (the run is
/// deterministic) and not sent. A study goes on from `stored`, the lines of its finished runs.
pub fn start(solver: Arc<dyn Solver>, claim: &Claim, stored: Vec<Line>, cancel: CancelFlag) -> std::io::Result<Solve> {
    let (line_sender, lines) = mpsc::channel(places(claim.request.len()));
    let (end_sender, end) = oneshot::channel();
    let claim_of_thread = claim.clone();
    let span = tracing::Span::current();
    std::thread::Builder::new().name(format!("solve-{}", claim.lease.job)).stack_size(STACK_BYTES).spawn(
        move || {
            let _entered = span.enter();
            let ended = catch_unwind(AssertUnwindSafe(|| match claim_of_thread.task {
                Task::Path => run(solver.as_ref(), &claim_of_thread, cancel, &line_sender),
                Task::Study => study(solver.as_ref(), &claim_of_thread, &stored, &cancel, &line_sender),
            }))
            .unwrap_or_else(|panic| SolveEnd::Panicked(panic_text(panic.as_ref())));
            // Nobody waits for the end when the runtime is going down.
            let _ = end_sender.send(ended);
        },
    )?;
    Ok(Solve { lines, end })
}

fn places(model_bytes: usize) -> usize {
    (IN_FLIGHT_BYTES / OF_MODEL / model_bytes.max(1)).clamp(FEWEST_IN_FLIGHT, IN_FLIGHT)
}

fn run(solver: &dyn Solver, claim: &Claim, cancel: CancelFlag, lines: &mpsc::Sender<Line>) -> SolveEnd {
    let mut request = match decode::decode(claim.request.as_bytes()) {
        Ok(request) => request,
        Err(errors) => return SolveEnd::Refused(errors),
    };
    // A job that follows another has that one's request, but for this.
    request.analysis.max_increments = claim.max_increments;
    let beginning = match claim.origin.as_ref().map(|(parent, origin)| branches::beginning(parent, origin)).transpose()
    {
        Ok(beginning) => beginning,
        Err(error) => return SolveEnd::Unreadable(error.to_string()),
    };
    let mut recorder = Recorder::default();
    let mut alternatives = claim.explores.then(|| Alternatives::of(claim.origin.is_some()));
    let mut unwritable = None;
    let accept: Accept<'_> = &mut |judged, junction| {
        // What is stored already is looked at too: what comes after depends on it.
        let stored = claim.last_index.is_some_and(|stored| judged.increment.index <= stored);
        let junction = junction();
        let open = junction.as_ref().map_or(&[][..], |junction| &junction.open);
        let followed =
            alternatives.as_mut().map_or_else(Vec::new, |alternatives| alternatives.at(&judged.increment, open));
        let branch = junction.map(|junction| recorder.branch(junction.checkpoint, followed)).transpose();
        let line = branch.and_then(|branch| {
            let body = if stored { String::new() } else { json_line(&judged)? };
            Ok(Line { index: judged.increment.index, body, branch })
        });
        match line {
            Ok(_) if stored => ControlFlow::Continue(()),
            Ok(line) => match lines.blocking_send(line) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            },
            Err(error) => {
                unwritable = Some(error.to_string());
                ControlFlow::Break(())
            }
        }
    };
    let reported = solver.solve(&request, beginning, cancel, accept);
    match (unwritable, reported) {
        (Some(error), _) => SolveEnd::Unwritable(error),
        (None, Ok(Some(report))) => SolveEnd::Reported(Box::new(report)),
        (None, Ok(None)) => SolveEnd::Silent,
        (None, Err(errors)) => SolveEnd::Refused(errors),
    }
}

fn study(
    solver: &dyn Solver,
    claim: &Claim,
    stored: &[Line],
    cancel: &CancelFlag,
    lines: &mpsc::Sender<Line>,
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
        Ok(body) => match lines.blocking_send(Line { index: run.index, body, branch: None }) {
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

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(text), _) => (*text).to_owned(),
        (None, Some(text)) => text.clone(),
        (None, None) => "a panic without text".to_owned(),
    }
}
