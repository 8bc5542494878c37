//! Sweeps: many jobs that are queued together.

use crate::model::request::sweep::Variation;
use crate::model::{InputError, InputErrors, RunMistakes, Sweep, VariationSummary};
use crate::result::plan::Warning;
use crate::service::jobs::configuration::limits::MOST_SWEEP_BYTES;
use crate::service::jobs::queue::checks::{Check, CheckContext, Whole};
use crate::service::jobs::queue::submission::{Prepared, not_text, queued, wrong_input};
use crate::service::jobs::solving::solver::Before;
use crate::service::jobs::{Caller, Jobs, JobsError, Posted};
use crate::service::metrics::Write;
use crate::service::store::{JobRecord, Line, NewRun, NewSweep, SweepRefinement, Task};
use crate::studies::sweeps::{Found, ResponseFinder, Row, further_values};
use serde_json::value::{RawValue, to_raw_value};
use uuid::Uuid;

impl Jobs {
    /// Checks a sweep with all of its runs and answers its [`Variation`] as JSON and the number of runs; nothing is queued.
    pub async fn validate_sweep(&self, request: impl Into<Posted>) -> Result<(String, u64), JobsError> {
        let ((prepared, runs, _), _held) = self.checks.run(request.into(), Preparation::Posted).await?;
        Ok((serde_json::to_string(&prepared.plan)?, runs.len() as u64))
    }

    pub async fn submit_sweep(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let ((prepared, runs, refine), _held) = self.checks.run(request.into(), Preparation::Posted).await?;
        let whole = prepared.into_job(caller, Task::Sweep, &self.settings, idempotency_key)?;
        let sweep = NewSweep { whole, runs, refine };
        queued(self.metrics.work.timed(Write::Submit, self.store.submit_sweep(sweep)).await?)
    }

    /// Queues the next runs of a sweep whose runs so far have ended, and answers their number; where there are none the sweep
    /// ends.
    ///
    /// # Errors
    /// The store fails; the same call later does what is left.
    pub(crate) async fn refine_sweep(&self, id: Uuid) -> Result<usize, JobsError> {
        let (Some(record), Some(request)) = (self.store.job(id).await?, self.store.request(id).await?) else {
            return Ok(0);
        };
        let (plan, before) = (record.plan.clone(), record.max_increments);
        let lines = self.lines(id, None, usize::MAX).await?;
        let choose = move |request: Vec<u8>| {
            Whole::of(move |context: &CheckContext<'_>| refinement(context, id, &request, &found(record, &lines)?))
        };
        let refinement = match self.checks.run(Posted::from(request.into_bytes()), choose).await {
            Ok((refinement, _held)) => refinement,
            // What cannot be refined ends with what it has found.
            Err(error @ (JobsError::Input(_) | JobsError::CheckTime(_))) => {
                tracing::warn!(sweep = %id, %error, "the refinement ends");
                SweepRefinement { sweep: id, before, plan, summary: None, runs: Vec::new() }
            }
            Err(other) => return Err(other),
        };
        let count = refinement.runs.len();
        Ok(if self.store.refine_sweep(refinement).await? { count } else { 0 })
    }
}

/// The findings of a sweep, in the order of its runs; `lines` are all of its stored lines.
///
/// # Errors
/// The stored plan or lines cannot be read.
pub fn found(sweep: JobRecord, lines: &[Line]) -> serde_json::Result<Found> {
    let variation: Variation = serde_json::from_str(&sweep.plan)?;
    let mut rows: Vec<Row> = lines.iter().map(|line| serde_json::from_str(&line.body)).collect::<Result<_, _>>()?;
    rows.sort_by_key(|row| row.run);
    Ok(Found { name: sweep.name, variation, rows })
}

/// The sweep, its runs, and how many further ones may be added.
type CheckedSweep = (Prepared<Box<RawValue>>, Vec<NewRun>, u64);

/// The check of a sweep, run by run.
enum Preparation {
    Posted(Vec<u8>),
    Begun(Box<Begun>),
}

/// A sweep whose runs have been checked in part.
struct Begun {
    request: Vec<u8>,
    sweep: Sweep,
    runs: Vec<NewRun>,
    /// The number of checked runs.
    checked: u64,
    /// Bytes of the requests and plans of the checked runs.
    bytes: usize,
    mistakes: RunMistakes,
    /// The scene of the last run, which the next one may reuse.
    before: Before,
}

impl Check for Preparation {
    type Checked = CheckedSweep;

    fn go_on(&mut self, context: &CheckContext<'_>) -> Result<Option<Self::Checked>, JobsError> {
        let mut begun = match std::mem::replace(self, Self::Posted(Vec::new())) {
            Self::Posted(request) => Box::new(Begun::read(context, request)?),
            Self::Begun(begun) => begun,
        };
        while begun.go_on(context)? {
            if context.is_over_time() {
                *self = Self::Begun(begun);
                return Ok(None);
            }
        }
        begun.end().map(Some)
    }
}

impl Begun {
    fn read(context: &CheckContext<'_>, request: Vec<u8>) -> Result<Self, JobsError> {
        let sweep = Sweep::read(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
        if sweep.runs() > context.limits.queued {
            let most = context.limits.queued;
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

    /// Checks the next run; answers whether further runs have to be checked.
    fn go_on(&mut self, context: &CheckContext<'_>) -> Result<bool, JobsError> {
        context.go_on()?;
        let run = self.checked;
        match prepare_run(context, &self.sweep, &mut self.before, run) {
            Ok((new, warnings)) => {
                self.bytes += new.request.len() + new.plan.len();
                if self.bytes > MOST_SWEEP_BYTES {
                    return Err(refused(format!(
                        "the requests of its runs have more than {MOST_SWEEP_BYTES} bytes in all"
                    )));
                }
                self.runs.push(new);
                self.mistakes.note(run, None);
                self.mistakes.warn(&self.sweep, run, warnings);
            }
            Err(JobsError::Input(errors)) => self.mistakes.note(run, Some(errors)),
            Err(other) => return Err(other),
        }
        self.checked += 1;
        Ok(self.checked < self.sweep.runs() && !self.mistakes.are_enough())
    }

    fn end(self) -> Result<CheckedSweep, JobsError> {
        let Self { request, mut sweep, runs, mistakes, .. } = self;
        sweep.variation.warnings = mistakes.result(&sweep).map_err(JobsError::Input)?;
        let (summary, refine) = (summary(&sweep)?, sweep.variation.refine);
        // Written here, on a blocking thread, as it can be large.
        let plan = to_raw_value(&sweep.variation)?;
        let (text, max_increments) = (String::from_utf8(request).map_err(not_text)?, runs.len() as u64);
        Ok((Prepared { text, name: sweep.name, plan, summary, max_increments, explore: None }, runs, refine))
    }
}

fn summary(sweep: &Sweep) -> serde_json::Result<Option<String>> {
    serde_json::to_string(&VariationSummary::of(&sweep.variation)).map(Some)
}

/// Chooses and checks the next runs of a sweep whose runs so far have the findings `found`. There are none where no further
/// value is expected to tell anything, where as many as were asked for have been added, and where the model cannot have one of
/// the values: what has been found stays.
fn refinement(
    context: &CheckContext<'_>,
    id: Uuid,
    request: &[u8],
    found: &Found,
) -> Result<SweepRefinement, JobsError> {
    let mut sweep = Sweep::read(request).map_err(JobsError::Input)?;
    let posted = sweep.runs();
    if let [parameter] = found.variation.parameters.as_slice() {
        let added = parameter.values.iter().skip(usize::try_from(posted).unwrap_or(usize::MAX)).cloned().collect();
        sweep.add_values(added).map_err(JobsError::Input)?;
    }
    let before = sweep.runs();
    let most = usize::try_from(sweep.variation.refine.saturating_sub(before - posted)).unwrap_or(usize::MAX);
    let values = further_values(&sweep.variation, &found.rows, most);
    let chosen = sweep.add_values(values).map_err(JobsError::Input)?;
    let mut last = Before::default();
    let mut runs = Vec::new();
    for run in chosen {
        context.go_on()?;
        match prepare_run(context, &sweep, &mut last, run) {
            Ok((new, _)) => runs.push(new),
            Err(JobsError::Input(errors)) => {
                tracing::info!(sweep = %id, %errors, "the refinement ends");
                runs.clear();
                break;
            }
            Err(other) => return Err(other),
        }
    }
    if runs.is_empty() {
        sweep.drop_values_after(usize::try_from(before).unwrap_or(usize::MAX));
    }
    sweep.variation.warnings.clone_from(&found.variation.warnings);
    let plan = serde_json::to_string(&sweep.variation)?;
    Ok(SweepRefinement { sweep: id, before, plan, summary: summary(&sweep)?, runs })
}

fn refused(detail: String) -> JobsError {
    JobsError::Input(InputErrors(vec![InputError::new("/sweep/replace", detail)]))
}

/// A checked run, and what may be a mistake in it.
fn prepare_run(
    context: &CheckContext<'_>,
    sweep: &Sweep,
    before: &mut Before,
    run: u64,
) -> Result<(NewRun, Vec<Warning>), JobsError> {
    let wrong = |errors| JobsError::Input(sweep.located(run, errors));
    let crate::model::runs::Run { text, request } = sweep.run(run).map_err(JobsError::Input)?;
    let max_increments = request.analysis.max_increments;
    context.limits.check(&request.model, max_increments).map_err(wrong)?;
    let planned = context.solver.plan_after(before, &request).map_err(wrong)?;
    let plan = serde_json::to_string(&planned)?;
    let values = serde_json::to_string(&sweep.variation.values(run))?;
    let responses = &sweep.variation.responses;
    ResponseFinder::new(responses, &request).map_err(JobsError::Input)?;
    let asked = (!responses.is_empty()).then(|| serde_json::to_string(responses)).transpose()?;
    Ok((NewRun { name: request.model.name, request: text, plan, values, asked, max_increments }, planned.warnings))
}
