//! Sweeps: many jobs that are queued together.

use crate::model::request::sweep::Variation;
use crate::model::{InputError, InputErrors, RunMistakes, Sweep, VariationSummary};
use crate::service::jobs::configuration::limits::MOST_SWEEP_BYTES;
use crate::service::jobs::queue::checks::{Check, Desk};
use crate::service::jobs::queue::submission::{Prepared, not_text, queued, wrong_input};
use crate::service::jobs::solving::solver::Before;
use crate::service::jobs::{Caller, Jobs, JobsError, Posted};
use crate::service::metrics::Write;
use crate::service::store::{JobRecord, Line, NewRun, NewSweep, Task};
use crate::studies::sweeps::{Found, Row};
use serde_json::value::{RawValue, to_raw_value};

impl Jobs {
    /// What would be varied, a [`Variation`] as JSON, every run checked; nothing is queued. Also answers how many runs there are.
    pub async fn validate_sweep(&self, request: impl Into<Posted>) -> Result<(String, u64), JobsError> {
        let ((prepared, runs), _held) = self.checks.run(request.into(), Preparation::Posted).await?;
        Ok((serde_json::to_string(&prepared.plan)?, runs.len() as u64))
    }

    pub async fn submit_sweep(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let ((prepared, runs), _held) = self.checks.run(request.into(), Preparation::Posted).await?;
        let whole = prepared.into_job(caller, Task::Sweep, &self.settings, idempotency_key)?;
        let sweep = NewSweep { whole, runs };
        queued(self.metrics.work.timed(Write::Submit, self.store.submit_sweep(sweep)).await?)
    }
}

/// What a sweep has found, in the order of its runs; `lines` are all of it that is stored.
///
/// # Errors
/// What is stored is none of a sweep's.
pub fn found(sweep: JobRecord, lines: &[Line]) -> serde_json::Result<Found> {
    let variation: Variation = serde_json::from_str(&sweep.plan)?;
    let mut rows: Vec<Row> = lines.iter().map(|line| serde_json::from_str(&line.body)).collect::<Result<_, _>>()?;
    rows.sort_by_key(|row| row.run);
    Ok(Found { name: sweep.name, variation, rows })
}

/// Reads and checks a sweep, run by run.
enum Preparation {
    Posted(Vec<u8>),
    Begun(Box<Begun>),
}

/// A sweep of which some runs have been checked.
struct Begun {
    request: Vec<u8>,
    sweep: Sweep,
    runs: Vec<NewRun>,
    /// Runs that have been checked.
    checked: u64,
    /// Of the requests and plans of the runs.
    bytes: usize,
    mistakes: RunMistakes,
    /// Of the last run.
    before: Before,
}

impl Check for Preparation {
    /// The whole, and its runs.
    type Checked = (Prepared<Box<RawValue>>, Vec<NewRun>);

    fn go_on(&mut self, desk: &Desk<'_>) -> Result<Option<Self::Checked>, JobsError> {
        let mut begun = match std::mem::replace(self, Self::Posted(Vec::new())) {
            Self::Posted(request) => Box::new(Begun::read(desk, request)?),
            Self::Begun(begun) => begun,
        };
        while begun.go_on(desk)? {
            if desk.is_over_time() {
                *self = Self::Begun(begun);
                return Ok(None);
            }
        }
        begun.end().map(Some)
    }
}

impl Begun {
    fn read(desk: &Desk<'_>, request: Vec<u8>) -> Result<Self, JobsError> {
        let sweep = Sweep::read(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
        if sweep.runs() > desk.limits.queued {
            let most = desk.limits.queued;
            return Err(refused(format!("these are {} runs; this service queues at most {most} jobs", sweep.runs())));
        }
        Ok(Self {
            request,
            sweep,
            runs: Vec::new(),
            checked: 0,
            bytes: 0,
            mistakes: RunMistakes::default(),
            before: Before::default(),
        })
    }

    /// Checks the next run; answers whether there are others.
    fn go_on(&mut self, desk: &Desk<'_>) -> Result<bool, JobsError> {
        desk.go_on()?;
        let run = self.checked;
        match prepare_run(desk, &self.sweep, &mut self.before, run) {
            Ok(new) => {
                self.bytes += new.request.len() + new.plan.len();
                if self.bytes > MOST_SWEEP_BYTES {
                    return Err(refused(format!(
                        "the requests of its runs have more than {MOST_SWEEP_BYTES} bytes in all"
                    )));
                }
                self.runs.push(new);
                self.mistakes.note(run, None);
            }
            Err(JobsError::Input(errors)) => self.mistakes.note(run, Some(errors)),
            Err(other) => return Err(other),
        }
        self.checked += 1;
        Ok(self.checked < self.sweep.runs() && !self.mistakes.are_enough())
    }

    fn end(self) -> Result<(Prepared<Box<RawValue>>, Vec<NewRun>), JobsError> {
        let Self { request, sweep, runs, mistakes, .. } = self;
        mistakes.result(&sweep).map_err(JobsError::Input)?;
        let summary = Some(serde_json::to_string(&VariationSummary::of(&sweep.variation))?);
        // Written here, away from the runtime's threads: it can be large.
        let plan = to_raw_value(&sweep.variation)?;
        let (text, max_increments) = (String::from_utf8(request).map_err(not_text)?, runs.len() as u64);
        Ok((Prepared { text, name: sweep.name, plan, summary, max_increments, explore: None }, runs))
    }
}

fn refused(detail: String) -> JobsError {
    JobsError::Input(InputErrors(vec![InputError::new("/sweep/replace", detail)]))
}

fn prepare_run(desk: &Desk<'_>, sweep: &Sweep, before: &mut Before, run: u64) -> Result<NewRun, JobsError> {
    let wrong = |errors| JobsError::Input(sweep.located(run, errors));
    let crate::model::runs::Run { text, request } = sweep.run(run).map_err(JobsError::Input)?;
    let max_increments = request.analysis.max_increments;
    desk.limits.check(&request.model, max_increments).map_err(wrong)?;
    let plan = serde_json::to_string(&desk.solver.plan_after(before, &request).map_err(wrong)?)?;
    let values = serde_json::to_string(&sweep.variation.values(run))?;
    Ok(NewRun { name: request.model.name, request: text, plan, values, max_increments })
}
