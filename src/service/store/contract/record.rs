//! What goes into a store and comes out of it; no engine shows through.

use crate::model::request::Explore;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use std::time::Duration;
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

/// What a job does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Task {
    /// Traces one path; its lines are increments.
    Path,
    /// Traces many; its lines are the paths that have been traced.
    Study,
    /// Stands for jobs of its own; its lines are those that have ended.
    Sweep,
}

impl Task {
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Study => "study",
            Self::Sweep => "sweep",
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Path, Self::Study, Self::Sweep].into_iter().find(|task| task.name() == name)
    }
}

/// A job to be queued.
#[derive(Debug, Clone)]
pub struct NewJob {
    pub task: Task,
    /// Whose it is; keys of different owners do not meet.
    pub owner: Option<String>,
    pub name: Option<String>,
    /// The request as posted.
    pub request: String,
    /// JSON.
    pub plan: String,
    /// What lists show of the plan, JSON; none where they show all of it.
    pub summary: Option<String>,
    pub max_increments: u64,
    /// Workers that it may lose in a row, nothing stored between, but for those of which it is not suspected.
    pub max_attempts: u32,
    /// It is refused where so many wait already.
    pub most_queued: u64,
    pub priority: i32,
    pub idempotency_key: Option<String>,
    /// The job begins a family.
    pub explore: Option<Explore>,
}

/// A sweep to be stored: what stands for all of it, and its runs in order, which have its name, owner and priority.
#[derive(Debug, Clone)]
pub struct NewSweep {
    pub whole: NewJob,
    pub runs: Vec<NewRun>,
}

/// A run of a sweep to be queued.
#[derive(Debug, Clone)]
pub struct NewRun {
    /// The model's own.
    pub name: Option<String>,
    pub request: String,
    /// JSON.
    pub plan: String,
    /// A JSON array: what it has in the places that the sweep varies.
    pub values: String,
    pub max_increments: u64,
}

/// The place of a job among the runs of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunOf {
    pub sweep: Uuid,
    pub run: u64,
}

/// The direction of another job that a job follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parent {
    pub job: Uuid,
    pub increment: u64,
    pub direction: u64,
}

/// A job that follows another, to be queued; what is not here it has from its parent.
#[derive(Debug, Clone)]
pub struct NewFollower {
    pub parent: Parent,
    /// The parent's, if absent.
    pub owner: Option<String>,
    /// The parent's, if absent.
    pub max_increments: Option<u64>,
    pub idempotency_key: Option<String>,
    /// It is refused where so many wait already.
    pub most_queued: u64,
}

/// What it takes to go on from an increment along another direction; opaque here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Branch {
    pub body: String,
    /// One line: what is new since the branch before.
    pub trail: Option<String>,
    /// Directions that an exploration follows from here.
    pub alternatives: Vec<u64>,
}

/// A branch, or a checkpoint, as it is read back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    pub body: String,
    /// Lines: everything up to that point.
    pub trail: String,
}

/// What it takes to go on with a job from an increment of its own; opaque here. Of a job the newest is kept, until it ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checkpoint {
    /// Of the increment, which need not be stored itself, where few are; those up to it are.
    pub index: u64,
    pub body: String,
    /// One line: what is new since the checkpoint before.
    pub trail: Option<String>,
    /// What the trail held before is of no use any more.
    pub begins_trail: bool,
}

/// A job's place in an exploration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Membership {
    /// The job with which the exploration began.
    pub family: Uuid,
    pub generation: u64,
    pub explore: Explore,
    /// Its alternatives have been looked at.
    pub explored: bool,
    /// Alternatives of this job for which there was no room.
    pub not_queued: u64,
    /// Jobs queued in the whole family so far, the first not counted.
    pub family_queued: u64,
    /// Alternatives in the whole family for which there was no room so far.
    pub family_not_queued: u64,
}

#[derive(Debug, Clone)]
pub enum Submitted {
    Created(JobRecord),
    /// The same key came before with the same request: this is its job.
    Repeated(JobRecord),
    /// The same key came before with another request.
    KeyReused,
    QueueFull {
        most: u64,
    },
}

/// What became of a call to queue a failed job again.
#[derive(Debug, Clone)]
pub enum Retried {
    Queued(JobRecord),
    /// It has not failed, or is a run of a sweep, whose rows are written once.
    NotRetryable(JobRecord),
    QueueFull {
        most: u64,
    },
}

/// Which ended jobs are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// Those that ended no longer ago.
    For(Duration),
    /// So many that ended last.
    Newest(u64),
}

/// A job as stored, without its request and increments.
#[derive(Debug, Clone)]
pub struct JobRecord {
    pub id: Uuid,
    pub task: Task,
    pub owner: Option<String>,
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
    /// Times it was started.
    pub attempt: u32,
    pub max_attempts: u32,
    /// Workers that it has lost in a row, nothing stored between.
    pub losses: u32,
    /// Those of them that speak against it: it was the only one lost then, or had lost a worker before. At `max_attempts` it
    /// fails.
    pub counted_losses: u32,
    pub cancel_requested: bool,
    pub created_at: Timestamp,
    pub started_at: Option<Timestamp>,
    pub ended_at: Option<Timestamp>,
    /// The sweep that it is a run of.
    pub run: Option<RunOf>,
    pub parent: Option<Parent>,
    /// Jobs that follow this one.
    pub children: u64,
    pub membership: Option<Membership>,
}

impl JobRecord {
    /// Of its texts.
    pub fn bytes(&self) -> usize {
        let texts = [&self.owner, &self.name, &self.report, &self.stop_reason, &self.error];
        self.plan.len() + texts.into_iter().flatten().map(String::len).sum::<usize>()
    }
}

/// How far a job has come. What has ended has all its increments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Standing {
    pub task: Task,
    pub owner: Option<String>,
    pub status: Status,
    pub last_index: Option<u64>,
}

/// Which jobs to list.
#[derive(Debug, Clone)]
pub struct ListFilter {
    pub task: Task,
    /// Only jobs of this one's.
    pub owner: Option<String>,
    pub status: Option<Status>,
    /// Only runs of this sweep.
    pub sweep: Option<Uuid>,
    /// Only jobs that follow this one.
    pub parent: Option<Uuid>,
    /// Only jobs older than this one.
    pub before: Option<Uuid>,
    /// Past the first no more than so many of them, and about so many bytes.
    pub page: Page,
}

/// A page of jobs as lists show them: what can be large is shortened. A plan that has a summary is that, names and errors are
/// cut, and only paths have their report.
#[derive(Debug, Clone)]
pub struct Listed {
    pub jobs: Vec<JobRecord>,
    /// There are others past these.
    pub more: bool,
}

/// How much to read at once.
#[derive(Debug, Clone, Copy)]
pub struct Page {
    pub rows: u32,
    pub bytes: usize,
}

/// An increment: its index and its JSON text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    pub index: u64,
    pub body: String,
    /// Stored beside the increment, and not read back with it.
    pub branch: Option<Branch>,
}

impl Line {
    /// Without what is stored beside it.
    pub fn alone(&self) -> Self {
        Self { index: self.index, body: self.body.clone(), branch: None }
    }

    /// Bytes for which there is a limit; checkpoints are replaced and dropped, and do not count.
    pub fn bytes(&self) -> u64 {
        let branch =
            self.branch.as_ref().map_or(0, |branch| branch.body.len() + branch.trail.as_ref().map_or(0, String::len));
        (self.body.len() + branch) as u64
    }
}

/// What a worker stores at once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Batch {
    /// In order.
    pub lines: Vec<Line>,
    /// In order; none before lines up to its increment that are not stored.
    pub checkpoints: Vec<Checkpoint>,
    /// The first limit load among the lines, as JSON; of a job the first of all is kept.
    pub first_limit: Option<String>,
}

impl Batch {
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.checkpoints.is_empty()
    }
}

impl From<Vec<Line>> for Batch {
    fn from(lines: Vec<Line>) -> Self {
        Self { lines, ..Self::default() }
    }
}

/// The right to write to a job: valid while the job still names this worker and this attempt, and until the time that it
/// was given or last prolonged for has passed. After that nothing can be written with it, whether or not the job has been
/// given to another meanwhile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lease {
    pub job: Uuid,
    pub worker: String,
    pub attempt: u32,
}

/// A job taken from the queue.
#[derive(Debug, Clone)]
pub struct Claim {
    pub lease: Lease,
    pub task: Task,
    pub request: String,
    pub max_increments: u64,
    /// Increments up to this one are stored already, from an earlier attempt.
    pub last: Option<Line>,
    /// The body of the last branch that an earlier attempt stored.
    pub last_branch: Option<String>,
    /// The newest checkpoint of an earlier attempt.
    pub checkpoint: Option<Origin>,
    /// Where the job begins, if it follows another.
    pub origin: Option<(Parent, Origin)>,
    /// Its alternatives are to be followed by jobs of their own.
    pub explores: bool,
    /// How long it waited in the queue, if this is its first start.
    pub waited: Option<Duration>,
    /// How long its attempts before this one ran.
    pub ran: Duration,
    /// Bytes that they stored: see [`Line::bytes`].
    pub stored_bytes: u64,
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
