//! Sweeps: many jobs that are queued together.

use super::submission::{not_text, wrong_input};
use super::{Caller, Jobs, JobsError, Limits, Posted, Solver, queued};
use crate::metrics::Write;
use crate::model::sweep::Variation;
use crate::model::{InputError, InputErrors, RunMistakes, Sweep};
use crate::store::{JobRecord, NewJob, NewRun, NewSweep, Task};
use crate::sweeps::{Found, Row};

/// Bytes of the requests of a sweep's runs in all: each is stored with its job.
pub const MOST_BYTES: usize = 256 << 20;

/// A sweep that can be queued.
struct Prepared {
    text: String,
    name: Option<String>,
    variation: Variation,
    runs: Vec<NewRun>,
}

impl Jobs {
    /// What would be varied, every run checked; nothing is queued. Also answers how many runs there are.
    pub async fn validate_sweep(&self, request: impl Into<Posted>) -> Result<(Variation, u64), JobsError> {
        let (prepared, _room) = self.checked(request.into(), prepare).await?;
        Ok((prepared.variation, prepared.runs.len() as u64))
    }

    pub async fn submit_sweep(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (Prepared { text, name, variation, runs }, _room) = self.checked(request.into(), prepare).await?;
        let whole = NewJob {
            task: Task::Sweep,
            owner: caller.owner().map(str::to_owned),
            name,
            plan: serde_json::to_string(&variation)?,
            request: text,
            max_increments: runs.len() as u64,
            max_attempts: self.settings.max_attempts,
            most_queued: self.settings.limits.queued,
            priority: 0,
            idempotency_key,
            explore: None,
        };
        let sweep = NewSweep { whole, runs };
        queued(self.metrics.work.timed(Write::Submit, self.store.submit_sweep(sweep)).await?)
    }

    /// What a sweep has found so far, in the order of its runs.
    ///
    /// # Errors
    /// A store that fails, or holds what is none of a sweep's.
    pub async fn sweep_so_far(&self, sweep: &JobRecord) -> Result<Found, JobsError> {
        let variation: Variation = serde_json::from_str(&sweep.plan)?;
        let lines = self.lines(sweep.id, None).await?;
        let mut rows: Vec<Row> = lines.iter().map(|line| serde_json::from_str(&line.body)).collect::<Result<_, _>>()?;
        rows.sort_by_key(|row| row.run);
        Ok(Found { name: sweep.name.clone(), variation, rows })
    }
}

fn prepare(solver: &dyn Solver, limits: &Limits, request: Vec<u8>) -> Result<Prepared, JobsError> {
    let sweep = Sweep::read(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    let refused = |detail| JobsError::Input(InputErrors(vec![InputError::new("/sweep/replace", detail)]));
    if sweep.runs() > limits.queued {
        let most = limits.queued;
        return Err(refused(format!("these are {} runs; this service queues at most {most} jobs", sweep.runs())));
    }
    let (mut runs, mut bytes, mut mistakes) = (Vec::new(), 0, RunMistakes::of(&sweep));
    for run in 0..sweep.runs() {
        match prepare_run(solver, limits, &sweep, run) {
            Ok(new) => {
                bytes += new.request.len() + new.plan.len();
                if bytes > MOST_BYTES {
                    return Err(refused(format!("the requests of its runs have more than {MOST_BYTES} bytes in all")));
                }
                runs.push(new);
                mistakes.note(run, None);
            }
            Err(JobsError::Input(errors)) => mistakes.note(run, Some(errors)),
            Err(other) => return Err(other),
        }
        if mistakes.are_enough() {
            break;
        }
    }
    mistakes.result().map_err(JobsError::Input)?;
    let Sweep { name, variation, .. } = sweep;
    Ok(Prepared { text: String::from_utf8(request).map_err(not_text)?, name, variation, runs })
}

fn prepare_run(solver: &dyn Solver, limits: &Limits, sweep: &Sweep, run: u64) -> Result<NewRun, JobsError> {
    let wrong = |errors| JobsError::Input(sweep.located(run, errors));
    let crate::model::sweep::Run { text, request } = sweep.run(run).map_err(JobsError::Input)?;
    let max_increments = request.analysis.max_increments;
    limits.check(&request.model, max_increments).map_err(wrong)?;
    let plan = serde_json::to_string(&solver.plan(&request).map_err(wrong)?)?;
    let values = serde_json::to_string(&sweep.variation.values(run))?;
    Ok(NewRun { name: request.model.name, request: text, plan, values, max_increments })
}
