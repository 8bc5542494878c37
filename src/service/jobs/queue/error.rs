//! The errors of requests about jobs.

use crate::model::InputErrors;
use crate::service::store::{JobRecord, StoreError};
use std::time::Duration;
use uuid::Uuid;

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
    /// The client no longer waits for the answer.
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
    #[error("no curve {0}")]
    NoCurve(Uuid),
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("a task ended early: {0}")]
    Task(#[from] tokio::task::JoinError),
    #[error("a plan could not be written: {0}")]
    Write(#[from] serde_json::Error),
}
