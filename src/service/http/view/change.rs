//! Changes of jobs, studies, sweeps and curves, as the feed has them.

use crate::service::http::view::job::{Parent, RunOf};
use crate::service::http::view::submitted::Submitted;
use crate::service::http::view::{curve, job, study, sweep};
use crate::service::store::{FeedPosition, JobRecord, Task};
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

/// What has changed.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TaskKind {
    Job,
    Study,
    Sweep,
    Curve,
}

impl From<Task> for TaskKind {
    fn from(task: Task) -> Self {
        match task {
            Task::Path => Self::Job,
            Task::Study => Self::Study,
            Task::Sweep => Self::Sweep,
            Task::Curve => Self::Curve,
        }
    }
}

/// A job, study, sweep or curve after a change of its status or progress; several changes shortly after one another are told as one.
#[derive(Debug, Serialize, ToSchema)]
pub struct ChangedTask {
    pub kind: TaskKind,
    #[serde(flatten)]
    pub submitted: Submitted,
    pub progress: Done,
    pub stop_reason: Option<String>,
    /// Of a job: the direction of another job that it follows.
    pub parent: Option<Parent>,
    /// Of a job: the sweep that it is a run of.
    pub sweep: Option<RunOf>,
    /// Its address.
    pub link: String,
}

/// How far it is.
#[derive(Debug, Serialize, ToSchema)]
pub struct Done {
    /// Of a job, increments after the first point; of a study, rows; of a sweep, runs that have ended; of a curve,
    /// points.
    pub done: u64,
    /// The most that there will be; a curve may have more.
    pub of: u64,
}

/// A job, study, sweep or curve that was deleted.
#[derive(Debug, Serialize, ToSchema)]
pub struct DeletedTask {
    pub kind: TaskKind,
    pub id: Uuid,
}

/// One event of the feed (WHATWG HTML, section 9.2); what is absent was not sent.
#[derive(Debug, Serialize, ToSchema)]
pub struct ChangeEvent {
    /// `begin`, `changed` or `deleted`.
    #[schema(nullable = false)]
    pub event: Option<String>,
    /// The place of the change, for `Last-Event-ID`.
    #[schema(nullable = false)]
    pub id: Option<String>,
    /// JSON: of `changed` and `deleted`, what the name says; of `begin`, an object without members.
    #[schema(nullable = false)]
    pub data: Option<String>,
    /// Milliseconds after which it is worth coming back.
    #[schema(nullable = false)]
    pub retry: Option<u64>,
}

impl From<JobRecord> for ChangedTask {
    fn from(record: JobRecord) -> Self {
        let address = match record.task {
            Task::Path => job::address(record.id),
            Task::Study => study::address(record.id),
            Task::Sweep => sweep::address(record.id),
            Task::Curve => curve::address(record.id),
        };
        Self {
            kind: record.task.into(),
            submitted: Submitted::from(&record),
            progress: Done { done: record.lines_done(), of: record.max_increments },
            parent: record.parent.map(Parent::from),
            sweep: record.run.map(RunOf::from),
            stop_reason: record.stop_reason,
            link: address,
        }
    }
}

/// The id of an event: the number of the change, and what has changed.
pub fn event_id(at: FeedPosition) -> String {
    format!("{}-{}", at.change, at.id.simple())
}

/// The place of an event by its id.
pub fn position(id: &str) -> Option<FeedPosition> {
    let (change, job) = id.split_once('-')?;
    let change = change.parse().ok().filter(|change| i64::try_from(*change).is_ok())?;
    Some(FeedPosition { change, id: job.parse().ok()? })
}
