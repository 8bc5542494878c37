//! Traces all runs of a sweep on the cores of this machine.

use crate::check::judged::{JudgedIncrement, JudgedPath};
use crate::continuation::scene::Scene;
use crate::model::{InputErrors, RunMistakes, Sweep};
use crate::output::columns::name_of;
use crate::resources::budget::{self, Budget};
use crate::resources::cancel::CancelFlag;
use crate::resources::panics;
use crate::result::plan::Warning;
use crate::result::stop_reason::Outcome;
use crate::studies::sweeps::{LimitLoad, ResponseFinder, Row};
use std::num::NonZeroUsize;
use std::ops::{ControlFlow, Range};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// The usual size of the stack of a main thread, with which the solver is tested.
const STACK_BYTES: usize = 8 << 20;

/// Receives the increments of the runs, from several threads; those of a run in order. Breaks to end the sweep.
pub type Accept<'a> = &'a (dyn Fn(u64, &JudgedIncrement) -> ControlFlow<()> + Sync);

/// Traces these runs, as many at a time as there are threads; the findings do not depend on their number. `done` is called for each
/// run that has ended.
///
/// # Errors
/// Mistakes in the runs; [`check`] tells them before the first one is traced.
pub fn run(
    sweep: &Sweep,
    runs: Range<u64>,
    threads: NonZeroUsize,
    accept: Accept<'_>,
    done: &(dyn Fn(&Row) + Sync),
) -> Result<Vec<Row>, InputErrors> {
    let rows = on_threads(runs, threads, |run| {
        let traced = catch_unwind(AssertUnwindSafe(|| trace(sweep, run, accept)));
        let row = traced.unwrap_or_else(|panic| Ok(panicked(sweep, run, &panics::text(panic.as_ref()))))?;
        done(&row);
        Ok(row)
    });
    rows.into_iter().collect()
}

/// Checks these runs and answers what may be a mistake in them.
///
/// # Errors
/// Mistakes in the runs.
pub fn check(sweep: &Sweep, runs: Range<u64>, threads: NonZeroUsize) -> Result<Vec<Warning>, InputErrors> {
    let checked = on_threads(runs.clone(), threads, |run| {
        let request = sweep.run(run)?.request;
        ResponseFinder::new(&sweep.variation.responses, &request)?;
        Scene::new(&request).map_err(|errors| sweep.located(run, errors)).map(|scene| scene.plan().warnings.clone())
    });
    let mut mistakes = RunMistakes::default();
    for (run, checked) in runs.zip(checked) {
        match checked {
            Ok(warnings) => {
                mistakes.note(run, None);
                mistakes.warn(sweep, run, warnings);
            }
            Err(errors) => mistakes.note(run, Some(errors)),
        }
    }
    mistakes.result(sweep)
}

fn trace(sweep: &Sweep, run: u64, accept: Accept<'_>) -> Result<Row, InputErrors> {
    let request = sweep.run(run)?.request;
    let scene = Scene::new(&request).map_err(|errors| sweep.located(run, errors))?;
    let cancel = CancelFlag::default();
    let mut path = JudgedPath::new(&request, &scene, cancel.clone());
    let (mut first_limit, mut last_index) = (None, None);
    let mut responses = ResponseFinder::new(&sweep.variation.responses, &request)?;
    for judged in path.by_ref() {
        if first_limit.is_none() {
            first_limit = LimitLoad::at(&judged.increment);
        }
        responses.take(&judged.increment, Some(&judged.measure));
        last_index = Some(judged.increment.index);
        if accept(run, &judged).is_break() {
            cancel.cancel();
        }
    }
    let reason = path.report().map(|judged| judged.report.stop_reason);
    let (status, error) = match reason.map(|reason| reason.outcome()) {
        Some(Outcome::Completed) => ("completed", None),
        Some(Outcome::Stopped) => ("stopped", None),
        Some(Outcome::Cancelled) => ("cancelled", None),
        None => ("failed", Some("the path ended without a report, which is a defect".to_owned())),
    };
    Ok(Row {
        run,
        job: None,
        values: sweep.variation.values(run),
        status: status.to_owned(),
        stop_reason: reason.and_then(|reason| name_of(&reason).ok()),
        error,
        last_index,
        first_limit,
        responses: responses.found(),
    })
}

/// A panic only fails one run.
fn panicked(sweep: &Sweep, run: u64, text: &str) -> Row {
    Row {
        run,
        job: None,
        values: sweep.variation.values(run),
        status: "failed".to_owned(),
        stop_reason: None,
        error: Some(format!("the solver panicked: {text}")),
        last_index: None,
        first_limit: None,
        responses: None,
    }
}

/// Calls `work` for each of these numbers on the given number of threads; the results are in order.
fn on_threads<T: Send>(numbers: Range<u64>, threads: NonZeroUsize, work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    // Each thread has its own.
    let bounds = budget::bounds();
    let next = AtomicU64::new(numbers.start);
    let results = Mutex::new(Vec::new());
    let take_part = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= numbers.end {
                return;
            }
            let budget = Budget::new(CancelFlag::default(), bounds);
            let result = budget.during(|| work(number)).unwrap_or_else(|breach| budget::end(breach));
            results.lock().unwrap_or_else(PoisonError::into_inner).push((number, result));
        }
    };
    std::thread::scope(|scope| {
        let others =
            threads.get().min(usize::try_from(numbers.end - numbers.start).unwrap_or(usize::MAX)).saturating_sub(1);
        for _ in 0..others {
            // If no further thread can be started, there are fewer.
            if std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, take_part).is_err() {
                break;
            }
        }
        take_part();
    });
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}
