//! The jobs of a service: submit, read, cancel, retry and delete.

use crate::result::plan::Plan;
use crate::service::jobs::configuration::settings::Settings;
use crate::service::jobs::queue::caller::Caller;
use crate::service::jobs::queue::checks::{Checks, Posted};
use crate::service::jobs::queue::error::JobsError;
use crate::service::jobs::queue::submission;
use crate::service::jobs::solving::context::SolveContext;
use crate::service::jobs::solving::running::Running;
use crate::service::jobs::solving::solver::Solver;
use crate::service::metrics::{Metrics, Write};
use crate::service::store::contract::interface::Store;
use crate::service::store::{JobRecord, Line, Page, Retried, Standing, StoreError, Task};
use std::sync::Arc;
use uuid::Uuid;

/// Stored lines are read page by page.
const PAGE: Page = Page { rows: 1000, bytes: 4 << 20 };

/// The jobs of this service; cheap to clone.
#[derive(Clone)]
pub struct Jobs {
    pub(crate) store: Arc<dyn Store>,
    pub(crate) solver: Arc<dyn Solver>,
    pub(crate) settings: Settings,
    pub(crate) running: Running,
    pub(crate) metrics: Arc<Metrics>,
    pub(super) checks: Checks,
}

impl Jobs {
    pub fn new(store: Arc<dyn Store>, solver: Arc<dyn Solver>, settings: Settings) -> Self {
        let checks = Checks::new(Arc::clone(&solver), settings.limits);
        Self { store, solver, settings, running: Running::default(), metrics: Arc::default(), checks }
    }

    /// Whether a worker of this process is locating a bifurcation point of the job at the moment.
    pub fn is_locating_bifurcation(&self, id: Uuid) -> bool {
        self.running.is_locating_bifurcation(id)
    }

    pub fn store(&self) -> &dyn Store {
        self.store.as_ref()
    }

    pub fn metrics(&self) -> &Metrics {
        &self.metrics
    }

    /// What a solve needs of this service.
    pub fn solve_context(&self) -> SolveContext {
        SolveContext {
            solver: Arc::clone(&self.solver),
            running: self.running.clone(),
            metrics: Arc::clone(&self.metrics),
            bounds: self.settings.limits.bounds,
            flush_interval: self.settings.flush_interval,
        }
    }

    /// The plan of a request; nothing is queued.
    pub async fn validate(&self, request: impl Into<Posted>) -> Result<Plan, JobsError> {
        Ok(submission::prepared(&self.checks, request.into(), submission::prepare).await?.0.plan)
    }

    pub async fn submit(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (prepared, _room) = submission::prepared(&self.checks, request.into(), submission::prepare).await?;
        let job = prepared.into_job(caller, Task::Path, &self.settings, idempotency_key)?;
        submission::queued(self.metrics.work.timed(Write::Submit, self.store.submit(job)).await?)
    }

    /// The job of the given task and id, if the caller sees it.
    pub async fn find(&self, caller: &Caller, task: Task, id: Uuid) -> Result<JobRecord, JobsError> {
        let seen = |job: &JobRecord| job.task == task && caller.sees(job.owner.as_deref());
        self.store.job(id).await?.filter(seen).ok_or_else(|| absent(task, id))
    }

    /// The status and last stored index of a job that the caller sees; its large texts are not read.
    pub async fn standing(&self, caller: &Caller, task: Task, id: Uuid) -> Result<Standing, JobsError> {
        let seen = |job: &Standing| job.task == task && caller.sees(job.owner.as_deref());
        self.store.standing(id).await?.filter(seen).ok_or_else(|| absent(task, id))
    }

    /// The stored lines of a job past the index `after`, in order. Reading ends once they have more than `most` bytes.
    pub async fn lines(&self, id: Uuid, mut after: Option<u64>, most: usize) -> Result<Vec<Line>, StoreError> {
        let (mut lines, mut bytes) = (Vec::new(), 0);
        loop {
            let page = self.store.increments(id, after, PAGE).await?;
            let Some(last) = page.last() else { return Ok(lines) };
            after = Some(last.index);
            bytes += page.iter().map(|line| line.body.len()).sum::<usize>();
            lines.extend(page);
            if bytes > most {
                return Ok(lines);
            }
        }
    }

    pub async fn cancel(&self, caller: &Caller, task: Task, id: Uuid) -> Result<JobRecord, JobsError> {
        self.standing(caller, task, id).await?;
        if task == Task::Sweep {
            self.store.cancel_sweep(id).await?.into_iter().for_each(|run| self.running.cancel(run));
        }
        let job = self.store.request_cancel(id).await?.ok_or_else(|| absent(task, id))?;
        // A job that runs in another process is cancelled at the next renewal of its lease; a job of this process at once.
        self.running.cancel(id);
        Ok(job)
    }

    /// Queues a failed job again: it resumes from its last checkpoint.
    pub async fn retry(&self, caller: &Caller, id: Uuid) -> Result<JobRecord, JobsError> {
        self.standing(caller, Task::Path, id).await?;
        let most = self.settings.limits.queued;
        match self.store.retry(id, most).await?.ok_or_else(|| absent(Task::Path, id))? {
            Retried::Queued(job) => Ok(job),
            Retried::NotRetryable(job) => Err(JobsError::NotRetryable(Box::new(job))),
            Retried::QueueFull { most } => Err(JobsError::QueueFull(most)),
        }
    }

    pub async fn delete(&self, caller: &Caller, task: Task, id: Uuid) -> Result<(), JobsError> {
        self.standing(caller, task, id).await?;
        let deleted = self.store.delete(id).await?;
        self.running.cancel(id);
        if deleted { Ok(()) } else { Err(absent(task, id)) }
    }
}

fn absent(task: Task, id: Uuid) -> JobsError {
    match task {
        Task::Path => JobsError::NoJob(id),
        Task::Study => JobsError::NoStudy(id),
        Task::Sweep => JobsError::NoSweep(id),
        Task::Curve => JobsError::NoCurve(id),
    }
}
