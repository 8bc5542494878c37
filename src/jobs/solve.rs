//! One solve on a thread of its own, never on the runtime's.
//!
//! Increments leave it over a bounded channel: a store that is slow makes the solver wait, not the memory grow. A panic
//! ends here and becomes the text of this one job.

use super::Solver;
use crate::cancel::CancelFlag;
use crate::model::{InputErrors, decode};
use crate::output::json_line;
use crate::path::{Increment, Report};
use crate::store::{Claim, Line};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// Increments between solver and store: enough to solve on while a batch is written.
const IN_FLIGHT: usize = 512;
/// Their bytes, roughly: an increment is hardly larger than its model, so large models get fewer places.
const IN_FLIGHT_BYTES: usize = 32 << 20;
const FEWEST_IN_FLIGHT: usize = 8;
/// Recursion over a model is shallow, but the main thread's stack is what the solver is tested with.
const STACK_BYTES: usize = 8 << 20;

/// How a solve ended.
#[derive(Debug)]
pub enum SolveEnd {
    Reported(Report),
    /// The stored request is no longer accepted, for example after an upgrade.
    Refused(InputErrors),
    Panicked(String),
    Unwritable(String),
    /// Without a report: nobody listened any more, or a defect.
    Silent,
}

/// A solve under way.
pub struct Solve {
    pub lines: mpsc::Receiver<Line>,
    pub end: oneshot::Receiver<SolveEnd>,
}

/// Starts the thread. Increments up to `claim.last_index` are stored already: they are computed again (the run is
/// deterministic) and not sent.
pub fn start(solver: Arc<dyn Solver>, claim: &Claim, cancel: CancelFlag) -> std::io::Result<Solve> {
    let (line_sender, lines) = mpsc::channel(places(claim.request.len()));
    let (end_sender, end) = oneshot::channel();
    let (request, stored) = (claim.request.clone(), claim.last_index);
    let span = tracing::Span::current();
    std::thread::Builder::new().name(format!("solve-{}", claim.lease.job)).stack_size(STACK_BYTES).spawn(
        move || {
            let _entered = span.enter();
            let ended = catch_unwind(AssertUnwindSafe(|| run(solver.as_ref(), &request, stored, cancel, &line_sender)))
                .unwrap_or_else(|panic| SolveEnd::Panicked(panic_text(panic.as_ref())));
            // Nobody waits for the end when the runtime is going down.
            let _ = end_sender.send(ended);
        },
    )?;
    Ok(Solve { lines, end })
}

fn places(model_bytes: usize) -> usize {
    (IN_FLIGHT_BYTES / model_bytes.max(1)).clamp(FEWEST_IN_FLIGHT, IN_FLIGHT)
}

fn run(
    solver: &dyn Solver,
    request: &str,
    stored: Option<u64>,
    cancel: CancelFlag,
    lines: &mpsc::Sender<Line>,
) -> SolveEnd {
    let request = match decode::decode(request.as_bytes()) {
        Ok(request) => request,
        Err(errors) => return SolveEnd::Refused(errors),
    };
    let mut unwritable = None;
    let mut accept = |increment: Increment| {
        if stored.is_some_and(|stored| increment.index <= stored) {
            return ControlFlow::Continue(());
        }
        match json_line(&increment) {
            Ok(body) => match lines.blocking_send(Line { index: increment.index, body }) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            },
            Err(error) => {
                unwritable = Some(error.to_string());
                ControlFlow::Break(())
            }
        }
    };
    let reported = solver.solve(&request, cancel, &mut accept);
    match (unwritable, reported) {
        (Some(error), _) => SolveEnd::Unwritable(error),
        (None, Ok(Some(report))) => SolveEnd::Reported(report),
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
