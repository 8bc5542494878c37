//! The records that are written to a store and read from it, independent of the database engine.

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

    /// Whether the job has ended; it does not change any more.
    pub fn is_ended(self) -> bool {
        match self {
            Self::Queued | Self::Running => false,
            Self::Completed | Self::Stopped | Self::Cancelled | Self::Failed => true,
        }
    }
}

/// The task of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Task {
    /// A job that traces one path; its lines are increments.
    Path,
    /// A job that traces many paths; its lines are the traced paths.
    Study,
    /// A group of jobs, its runs; its lines are the runs that have ended.
    Sweep,
    /// A job that follows a limit point in a parameter; its lines are the points of the curve.
    Curve,
}

impl Task {
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Study => "study",
            Self::Sweep => "sweep",
            Self::Curve => "curve",
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Path, Self::Study, Self::Sweep, Self::Curve].into_iter().find(|task| task.name() == name)
    }
}

/// A job to be queued.
#[derive(Debug, Clone)]
pub struct NewJob {
    pub task: Task,
    /// The owner; idempotency keys are separate for each owner.
    pub owner: Option<String>,
    pub name: Option<String>,
    /// The request as posted.
    pub request: String,
    /// JSON.
    pub plan: String,
    /// The short form of the plan for lists, JSON; `None` if lists show the whole plan.
    pub summary: Option<String>,
    pub max_increments: u64,
    /// The number of counted losses in a row, without anything stored in between, after which the job fails.
    pub max_attempts: u32,
    /// It is refused where so many wait already.
    pub most_queued: u64,
    pub priority: i32,
    pub idempotency_key: Option<String>,
    /// The job is the first of an exploration.
    pub explore: Option<Explore>,
}

/// A sweep to be stored: the record of the whole, and its runs in order, which share its owner and priority.
#[derive(Debug, Clone)]
pub struct NewSweep {
    pub whole: NewJob,
    pub runs: Vec<NewRun>,
    /// Further runs that may be added.
    pub refine: u64,
}

/// Further runs of a sweep whose runs have all ended, or its end.
#[derive(Debug, Clone)]
pub struct SweepRefinement {
    pub sweep: Uuid,
    /// The number of runs so far.
    pub before: u64,
    /// What is varied with them, JSON, and its short form.
    pub plan: String,
    pub summary: Option<String>,
    /// None: the sweep ends.
    pub runs: Vec<NewRun>,
}

/// A run of a sweep to be queued.
#[derive(Debug, Clone)]
pub struct NewRun {
    /// The name of the model.
    pub name: Option<String>,
    pub request: String,
    /// JSON.
    pub plan: String,
    /// A JSON array: the values of the varied parameters.
    pub values: String,
    /// JSON: the responses that the sweep asks for; `None` if there are none.
    pub asked: Option<String>,
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

/// A job to be queued that follows another; it shares all other members with its parent.
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

/// A checkpoint from which another direction can be followed; its format is opaque to the store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Branch {
    pub body: String,
    /// One line: the new part of the trail since the previous branch.
    pub trail: Option<String>,
    /// Directions that an exploration follows from here.
    pub alternatives: Vec<u64>,
}

/// A stored branch or checkpoint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    pub body: String,
    /// The lines of the whole trail up to that point.
    pub trail: String,
}

/// A checkpoint from which a job can be resumed; its format is opaque to the store. The newest one of a job is kept until the
/// job ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checkpoint {
    /// The index of the increment, which need not be stored itself if not all increments are recorded.
    pub index: u64,
    pub body: String,
    /// One line: the new part of the trail since the previous checkpoint.
    pub trail: Option<String>,
    /// The trail starts again with this checkpoint.
    pub begins_trail: bool,
}

/// A job's place in an exploration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Membership {
    /// The job with which the exploration began.
    pub family: Uuid,
    pub generation: u64,
    pub explore: Explore,
    /// The alternatives of the job have been processed.
    pub explored: bool,
    /// Alternatives of this job that were not queued because of the bounds of the exploration.
    pub not_queued: u64,
    /// Jobs queued in the whole family so far, the first not counted.
    pub family_queued: u64,
    /// Alternatives in the whole family that were not queued so far.
    pub family_not_queued: u64,
}

#[derive(Debug, Clone)]
pub enum Submitted {
    Created(JobRecord),
    /// The key was used before with the same request, whose job this is.
    Repeated(JobRecord),
    /// The key was used before with another request.
    KeyReused,
    QueueFull {
        most: u64,
    },
}

/// The result of a call that queues a failed job again.
#[derive(Debug, Clone)]
pub enum Retried {
    Queued(JobRecord),
    /// The job has not failed, or is a run of a sweep, whose rows are written once.
    NotRetryable(JobRecord),
    QueueFull {
        most: u64,
    },
}

/// Which ended jobs are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keep {
    /// Jobs that ended within this time.
    For(Duration),
    /// The given number of jobs that ended last.
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
    /// Of a path, increments after the point of index 0; of others, rows.
    pub fn lines_done(&self) -> u64 {
        match self.task {
            Task::Path => self.last_index.unwrap_or(0),
            Task::Study | Task::Sweep | Task::Curve => self.last_index.map_or(0, |index| index + 1),
        }
    }

    /// Bytes of the texts of the record.
    pub fn bytes(&self) -> usize {
        let texts = [&self.owner, &self.name, &self.report, &self.stop_reason, &self.error];
        self.plan.len() + texts.into_iter().flatten().map(String::len).sum::<usize>()
    }
}

/// The progress of a job. An ended job has all its increments.
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
    /// Only jobs of this owner.
    pub owner: Option<String>,
    pub status: Option<Status>,
    /// Only runs of this sweep.
    pub sweep: Option<Uuid>,
    /// Only jobs that follow this one.
    pub parent: Option<Uuid>,
    /// Only jobs older than this one.
    pub before: Option<Uuid>,
    /// The most jobs, and about the most bytes, of the page.
    pub page: Page,
}

/// A page of jobs in the short form of lists: a summary replaces its plan, names and errors are truncated, and only paths have
/// their report.
#[derive(Debug, Clone)]
pub struct Listed {
    pub jobs: Vec<JobRecord>,
    /// There are further jobs.
    pub more: bool,
}

/// A place in the order of changes: the number of a change, and the job that it is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct FeedPosition {
    pub change: u64,
    pub id: Uuid,
}

/// A change of a job, study or sweep.
#[derive(Debug, Clone)]
pub struct FeedEntry {
    pub at: FeedPosition,
    pub task: Task,
    /// As it is now, without its plan and report; `None`: it was deleted.
    pub job: Option<JobRecord>,
}

/// Changes in order.
#[derive(Debug, Clone)]
pub struct FeedPage {
    pub entries: Vec<FeedEntry>,
    /// Where the next page begins.
    pub end: FeedPosition,
    /// There are further changes by now.
    pub more: bool,
    /// There was no position, or one of another database: what changed before the end is not told.
    pub begins: bool,
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
    /// Stored beside the increment; absent from lines that are read.
    pub branch: Option<Branch>,
}

impl Line {
    /// A line without a branch.
    pub fn alone(&self) -> Self {
        Self { index: self.index, body: self.body.clone(), branch: None }
    }

    /// Bytes that count towards the storage limit. Checkpoints do not count, as they are replaced and deleted.
    pub fn bytes(&self) -> u64 {
        let branch =
            self.branch.as_ref().map_or(0, |branch| branch.body.len() + branch.trail.as_ref().map_or(0, String::len));
        (self.body.len() + branch) as u64
    }
}

/// What a worker stores in a transaction.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Batch {
    /// In order.
    pub lines: Vec<Line>,
    /// In order; each is stored after the lines up to its increment.
    pub checkpoints: Vec<Checkpoint>,
    /// The first limit load among the lines, as JSON; the store keeps the first one of a job.
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

/// The right to write to a job. A lease is valid while the job names this worker and this attempt, until it expires. An
/// expired lease allows no writes, whether or not another worker has claimed the job meanwhile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lease {
    pub job: Uuid,
    pub worker: String,
    pub attempt: u32,
}

/// A claimed job.
#[derive(Debug, Clone)]
pub struct Claim {
    pub lease: Lease,
    pub task: Task,
    pub request: String,
    pub max_increments: u64,
    /// JSON: the responses that the sweep of the job asks for.
    pub asked: Option<String>,
    /// Increments up to this one are stored already, from an earlier attempt.
    pub last: Option<Line>,
    /// The body of the last branch that an earlier attempt stored.
    pub last_branch: Option<String>,
    /// The newest checkpoint of an earlier attempt.
    pub checkpoint: Option<Origin>,
    /// Where the job begins, if it follows another.
    pub origin: Option<(Parent, Origin)>,
    /// The alternatives of the job are to be queued as jobs.
    pub explores: bool,
    /// The time in the queue, if this is the first start of the job.
    pub waited: Option<Duration>,
    /// The running time of earlier attempts.
    pub ran: Duration,
    /// Bytes stored by earlier attempts: see [`Line::bytes`].
    pub stored_bytes: u64,
}

/// The result of a write under a lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeaseAnswer {
    Held {
        cancel_requested: bool,
    },
    /// The job was deleted or claimed by another worker; nothing was written.
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
    /// JSON: the responses that the sweep of the job asks for, by name.
    pub responses: Option<String>,
}

impl Ending {
    pub fn failed(error: impl Into<String>) -> Self {
        Self { status: Status::Failed, stop_reason: None, report: None, error: Some(error.into()), responses: None }
    }
}
