//! From a request to a running solve: the queue's front (submit, cancel, delete) and the workers behind it.
//!
//! [`caller`] says on whose behalf, [`solver`] is the seam to the path tracer, [`submission`] what is done with a request before it is queued, [`solve`]
//! one solve on a thread of its own, [`batch`] its increments on their way to the store, [`worker`] the loop around both,
//! [`given`] makes what a solve gives ready for the store, [`checkpoints`] says where it can be taken up after a loss, [`cadence`] how often,
//! [`limits`] what is taken and how much a job may use, [`retention`] what is kept of ended jobs;
//! [`trail`] how the states that it has passed are stored once; [`crew`] all workers of a process, [`demonstration`] the built-in scenes as jobs; [`follow`] jobs that follow a direction
//! of another, [`branches`] the points they begin from, [`explore`] which of them are queued unasked; [`studies`] are jobs of
//! another task. Called by `http` and `command`; knows `store`, `judged`, `studies`, `path`, `model`
//! and, for what is counted and timed, `metrics`.

pub mod batch;
pub mod branches;
pub mod cadence;
pub mod caller;
pub mod checkpoints;
pub mod crew;
pub mod demonstration;
pub mod explore;
pub mod follow;
pub mod given;
pub mod limits;
pub mod retention;
pub mod running;
pub mod settings;
pub mod solve;
pub mod solver;
pub mod studies;
pub mod submission;
pub mod trail;
pub mod worker;

use crate::metrics::{Metrics, Write};
use crate::model::InputErrors;
use crate::path::Plan;
use crate::store::{JobRecord, NewJob, Store, StoreError, Submitted, Task};
use running::Running;
use std::num::NonZeroUsize;
use std::sync::Arc;
use tokio::sync::Semaphore;
use uuid::Uuid;

pub use caller::Caller;
pub use crew::Crew;
pub use limits::Limits;
pub use settings::Settings;
pub use solver::{PathSolver, Solver};
pub use submission::Posted;

/// Why a request was not carried out.
#[derive(Debug, thiserror::Error)]
pub enum JobsError {
    #[error("the request is not JSON: {0}")]
    NotJson(InputErrors),
    #[error("the model cannot be solved")]
    Input(InputErrors),
    #[error("this idempotency key came before with another request")]
    KeyReused,
    #[error("{0} jobs wait already")]
    QueueFull(u64),
    #[error("there is nothing to follow")]
    Follow(InputErrors),
    #[error("no job {0}")]
    NoJob(Uuid),
    #[error("no study {0}")]
    NoStudy(Uuid),
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("a task ended early: {0}")]
    Task(#[from] tokio::task::JoinError),
    #[error("a plan could not be written: {0}")]
    Write(#[from] serde_json::Error),
}

/// The jobs of this service; cheap to clone.
#[derive(Clone)]
pub struct Jobs {
    pub(crate) store: Arc<dyn Store>,
    pub(crate) solver: Arc<dyn Solver>,
    pub(crate) settings: Settings,
    pub(crate) running: Running,
    pub(crate) metrics: Arc<Metrics>,
    /// Requests that are read and checked at a time.
    checks: Arc<Semaphore>,
}

impl Jobs {
    pub fn new(store: Arc<dyn Store>, solver: Arc<dyn Solver>, settings: Settings) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let checks = Arc::new(Semaphore::new(processors));
        Self { store, solver, settings, running: Running::default(), metrics: Arc::default(), checks }
    }

    pub fn store(&self) -> &dyn Store {
        self.store.as_ref()
    }

    pub fn metrics(&self) -> &Metrics {
        &self.metrics
    }

    /// The plan of a request; nothing is queued.
    pub async fn validate(&self, request: impl Into<Posted>) -> Result<Plan, JobsError> {
        Ok(self.checked(request.into(), submission::prepare).await?.0.plan)
    }

    pub async fn submit(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (prepared, _room) = self.checked(request.into(), submission::prepare).await?;
        let job = NewJob {
            task: Task::Path,
            owner: caller.owner().map(str::to_owned),
            name: prepared.name,
            plan: serde_json::to_string(&prepared.plan)?,
            request: prepared.text,
            max_increments: prepared.max_increments,
            max_attempts: self.settings.max_attempts,
            most_queued: self.settings.limits.queued,
            priority: 0,
            idempotency_key,
            explore: prepared.explore,
        };
        queued(self.metrics.work.timed(Write::Submit, self.store.submit(job)).await?)
    }

    /// A job of that task that the caller sees.
    pub async fn find(&self, caller: &Caller, task: Task, id: Uuid) -> Result<JobRecord, JobsError> {
        let found = self.store.job(id).await?.filter(|job| job.task == task && caller.sees(job));
        found.ok_or_else(|| absent(task, id))
    }

    pub async fn cancel(&self, caller: &Caller, task: Task, id: Uuid) -> Result<JobRecord, JobsError> {
        self.find(caller, task, id).await?;
        let job = self.store.request_cancel(id).await?.ok_or_else(|| absent(task, id))?;
        // A job that runs elsewhere learns of it when its lease is renewed; one that runs here need not wait.
        self.running.cancel(id);
        Ok(job)
    }

    pub async fn delete(&self, caller: &Caller, task: Task, id: Uuid) -> Result<(), JobsError> {
        self.find(caller, task, id).await?;
        let deleted = self.store.delete(id).await?;
        self.running.cancel(id);
        if deleted { Ok(()) } else { Err(absent(task, id)) }
    }
}

fn absent(task: Task, id: Uuid) -> JobsError {
    match task {
        Task::Path => JobsError::NoJob(id),
        Task::Study => JobsError::NoStudy(id),
    }
}

fn queued(submitted: Submitted) -> Result<JobRecord, JobsError> {
    match submitted {
        Submitted::Created(job) => {
            tracing::info!(job = %job.id, "queued");
            Ok(job)
        }
        Submitted::Repeated(job) => Ok(job),
        Submitted::KeyReused => Err(JobsError::KeyReused),
        Submitted::QueueFull { most } => Err(JobsError::QueueFull(most)),
    }
}
