//! What goes into a store and comes out of it; no engine shows through.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use uuid::Uuid;

/// Where a job is in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = JobStatus)]
pub enum Status {
    Queued,
    Running,
    /// A stage's or the analysis' own end was reached.
    Completed,
    /// The path cannot go on; the stop reason says why and the points so far stand.
    Stopped,
    Cancelled,
    /// A defect or an outside fault, with its text.
    Failed,
}

impl Status {
    pub const ALL: [Self; 6] =
        [Self::Queued, Self::Running, Self::Completed, Self::Stopped, Self::Cancelled, Self::Failed];

    pub fn name(self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Running => "running",
            Self::Completed => "completed",
            Self::Stopped => "stopped",
            Self::Cancelled => "cancelled",
            Self::Failed => "failed",
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|status| status.name() == name)
    }

    /// Nothing of the job changes any more.
    pub fn is_ended(self) -> bool {
        match self {
            Self::Queued | Self::Running => false,
            Self::Completed | Self::Stopped | Self::Cancelled | Self::Failed => true,
        }
    }
}

/// A job to be queued.
#[derive(Debug, Clone)]
pub struct NewJob {
    pub name: Option<String>,
    /// The request as posted.
    pub request: String,
    /// JSON.
    pub plan: String,
    pub max_increments: u64,
    pub max_attempts: u32,
    pub priority: i32,
    pub idempotency_key: Option<String>,
}

#[derive(Debug, Clone)]
pub enum Submitted {
    Created(JobRecord),
    /// The same key came before with the same request: this is its job.
    Repeated(JobRecord),
    /// The same key came before with another request.
    KeyReused,
}

/// A job as stored, without its request and increments.
#[derive(Debug, Clone)]
pub struct JobRecord {
    pub id: Uuid,
    pub name: Option<String>,
    pub status: Status,
    /// JSON.
    pub plan: String,
    /// JSON.
    pub report: Option<String>,
    pub stop_reason: Option<String>,
    pub error: Option<String>,
    pub max_increments: u64,
    pub last_index: Option<u64>,
    pub attempt: u32,
    pub max_attempts: u32,
    pub cancel_requested: bool,
    pub created_at: Timestamp,
    pub started_at: Option<Timestamp>,
    pub ended_at: Option<Timestamp>,
}

/// Which jobs to list.
#[derive(Debug, Clone, Copy)]
pub struct ListFilter {
    pub status: Option<Status>,
    /// Only jobs older than this one.
    pub before: Option<Uuid>,
    pub limit: u32,
}

/// How much to read at once.
#[derive(Debug, Clone, Copy)]
pub struct Page {
    pub rows: u32,
    pub bytes: usize,
}

/// A stored increment: its index and its JSON text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    pub index: u64,
    pub body: String,
}

/// The right to write to a job: valid while the job still names this worker and this attempt.
#[derive(Debug, Clone)]
pub struct Lease {
    pub job: Uuid,
    pub worker: String,
    pub attempt: u32,
}

/// A job taken from the queue.
#[derive(Debug, Clone)]
pub struct Claim {
    pub lease: Lease,
    pub request: String,
    /// Increments up to this index are stored already, from an earlier attempt.
    pub last_index: Option<u64>,
}

/// What became of a write under a lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeaseAnswer {
    Held {
        cancel_requested: bool,
    },
    /// The job is gone or another's; nothing was written.
    Lost,
}

/// How a job ended.
#[derive(Debug, Clone)]
pub struct Ending {
    pub status: Status,
    pub stop_reason: Option<String>,
    /// JSON.
    pub report: Option<String>,
    pub error: Option<String>,
}

impl Ending {
    pub fn failed(error: impl Into<String>) -> Self {
        Self { status: Status::Failed, stop_reason: None, report: None, error: Some(error.into()) }
    }
}
