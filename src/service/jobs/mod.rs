//! From a request to a running solve: the queue's front (submit, cancel, delete) and the workers behind it.
//!
//! [`caller`] says on whose behalf, [`solver`] is the seam to the path tracer, [`submission`] what is done with a request before it is queued,
//! [`checks`] when and for how long, [`lanes`] in which order between clients, [`solve`]
//! one solve on a thread of its own, [`sent`] what leaves it, [`batch`] its increments on their way to the store, [`worker`] the loop around both,
//! [`given`] makes what a solve gives ready for the store, [`checkpoints`] says where it can be taken up after a loss, [`cadence`] how often,
//! [`limits`] what is taken and how much a job may use, [`retention`] what is kept of ended jobs;
//! [`trail`] how the states that it has passed are stored once; [`crew`] all workers of a process, [`demonstration`] the built-in scenes as jobs; [`follow`] jobs that follow a direction
//! of another, [`branches`] the points they begin from, [`explore`] which of them are queued unasked; [`studies`] are jobs of
//! another task, [`sweeps`] stand for many. Called by `http` and `command`; knows `store`, `judged`, `studies`, `continuation`, `model`
//! and, for what is counted and timed, `metrics`.

pub mod batch;
pub mod branches;
pub mod cadence;
pub mod caller;
pub mod checkpoints;
pub mod checks;
pub mod crew;
pub mod demonstration;
pub mod explore;
pub mod follow;
pub mod given;
pub mod lanes;
pub mod limits;
pub mod retention;
pub mod running;
pub mod sent;
pub mod settings;
pub mod solve;
pub mod solver;
pub mod studies;
pub mod submission;
pub mod sweeps;
pub mod trail;
pub mod worker;

use crate::model::InputErrors;
use crate::result::plan::Plan;
use crate::service::metrics::{Metrics, Write};
use crate::service::store::contract::interface::Store;
use crate::service::store::{JobRecord, Retried, Standing, StoreError, Submitted, Task};
use checks::Checks;
use running::Running;
use std::sync::Arc;
use std::time::Duration;
use uuid::Uuid;

pub use caller::Caller;
pub use checks::Posted;
pub use crew::Crew;
pub use lanes::Client;
pub use limits::Limits;
pub use settings::Settings;
pub use solver::{PathSolver, Solver};

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
    #[error("checking it takes longer than {0:?}")]
    CheckTime(Duration),
    /// Nobody waits for the answer.
    #[error("the check was stopped")]
    Abandoned,
    #[error("there is nothing to follow")]
    Follow(InputErrors),
    #[error("job {} cannot be queued again", .0.id)]
    NotRetryable(Box<JobRecord>),
    #[error("no job {0}")]
    NoJob(Uuid),
    #[error("no study {0}")]
    NoStudy(Uuid),
    #[error("no sweep {0}")]
    NoSweep(Uuid),
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
    checks: Checks,
}

impl Jobs {
    pub fn new(store: Arc<dyn Store>, solver: Arc<dyn Solver>, settings: Settings) -> Self {
        let (running, checks) = (Running::default(), Checks::default());
        Self { store, solver, settings, running, metrics: Arc::default(), checks }
    }

    /// Whether a worker of this process is just now locating a bifurcation point of the job.
    pub fn is_locating_bifurcation(&self, id: Uuid) -> bool {
        self.running.is_locating_bifurcation(id)
    }

    pub fn store(&self) -> &dyn Store {
        self.store.as_ref()
    }

    pub fn metrics(&self) -> &Metrics {
        &self.metrics
    }

    /// The plan of a request; nothing is queued.
    pub async fn validate(&self, request: impl Into<Posted>) -> Result<Plan, JobsError> {
        Ok(self.prepared(request.into(), submission::prepare).await?.0.plan)
    }

    pub async fn submit(
        &self,
        caller: &Caller,
        request: impl Into<Posted>,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        let (prepared, _room) = self.prepared(request.into(), submission::prepare).await?;
        let job = self.new_job(caller, Task::Path, prepared, idempotency_key)?;
        queued(self.metrics.work.timed(Write::Submit, self.store.submit(job)).await?)
    }

    /// A job of that task that the caller sees.
    pub async fn find(&self, caller: &Caller, task: Task, id: Uuid) -> Result<JobRecord, JobsError> {
        let seen = |job: &JobRecord| job.task == task && caller.sees(job.owner.as_deref());
        self.store.job(id).await?.filter(seen).ok_or_else(|| absent(task, id))
    }

    /// How far a job has come that the caller sees; what can be large of it is not read.
    pub async fn standing(&self, caller: &Caller, task: Task, id: Uuid) -> Result<Standing, JobsError> {
        let seen = |job: &Standing| job.task == task && caller.sees(job.owner.as_deref());
        self.store.standing(id).await?.filter(seen).ok_or_else(|| absent(task, id))
    }

    pub async fn cancel(&self, caller: &Caller, task: Task, id: Uuid) -> Result<JobRecord, JobsError> {
        self.standing(caller, task, id).await?;
        if task == Task::Sweep {
            self.store.cancel_sweep(id).await?.into_iter().for_each(|run| self.running.cancel(run));
        }
        let job = self.store.request_cancel(id).await?.ok_or_else(|| absent(task, id))?;
        // A job that runs elsewhere learns of it when its lease is renewed; one that runs here need not wait.
        self.running.cancel(id);
        Ok(job)
    }

    /// Queues a failed job again: it goes on from what it has stored.
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
