//! What is answered, as JSON.

use crate::check::judged::{JudgedIncrement, JudgedReport};
use crate::result::plan::Plan;
use crate::result::stop_reason::StopReason;
use crate::service::store::{JobRecord, Status};
use jiff::Timestamp;
use serde::Serialize;
use serde_json::value::RawValue;
use utoipa::ToSchema;
use uuid::Uuid;

/// What jobs and studies have in common.
#[derive(Debug, Serialize, ToSchema)]
pub struct Submitted {
    pub id: Uuid,
    /// The name of the token that it was posted with; null where the service asked for none.
    pub owner: Option<String>,
    /// The model's own name.
    pub name: Option<String>,
    pub status: Status,
    /// Why it failed, or which limit of this service stopped it.
    pub error: Option<String>,
    /// A cancel was asked for; it ends within one iteration.
    pub cancel_requested: bool,
    /// Times it was started.
    pub attempt: u32,
    /// Workers that it has lost in a row (their process ended, or did not answer in time), nothing stored between.
    pub losses: u32,
    /// Those of them that speak against it: it was the only job that was lost then, or had lost a worker before.
    pub counted_losses: u32,
    /// So many of those, and it fails.
    pub max_attempts: u32,
    #[schema(value_type = String, format = DateTime)]
    pub created_at: Timestamp,
    #[schema(value_type = Option<String>, format = DateTime)]
    pub started_at: Option<Timestamp>,
    #[schema(value_type = Option<String>, format = DateTime)]
    pub ended_at: Option<Timestamp>,
}

impl From<&JobRecord> for Submitted {
    fn from(record: &JobRecord) -> Self {
        Self {
            id: record.id,
            owner: record.owner.clone(),
            name: record.name.clone(),
            status: record.status,
            error: record.error.clone(),
            cancel_requested: record.cancel_requested,
            attempt: record.attempt,
            losses: record.losses,
            counted_losses: record.counted_losses,
            max_attempts: record.max_attempts,
            created_at: record.created_at,
            started_at: record.started_at,
            ended_at: record.ended_at,
        }
    }
}

/// A job, without its increments.
#[derive(Debug, Serialize, ToSchema)]
pub struct Job {
    #[serde(flatten)]
    pub submitted: Submitted,
    pub progress: Progress,
    /// What the scene needs, and what is left out and why.
    #[schema(value_type = Plan)]
    pub plan: Box<RawValue>,
    /// Why the path ended, or was ended by a limit of this service; null before that, and for failed jobs.
    #[schema(value_type = Option<JobStopReason>)]
    pub stop_reason: Option<String>,
    /// Null before the path ends, and where it was not the path that did.
    #[schema(value_type = Option<JudgedReport>)]
    pub report: Option<Box<RawValue>>,
    /// The direction of another job that this one follows; null for a job that starts at rest.
    pub parent: Option<Parent>,
    /// The sweep that it is a run of; null for others.
    pub sweep: Option<RunOf>,
    /// Jobs of the same owner that follow a direction of this one; `GET /v1/jobs?parent=` lists them.
    pub children: u64,
    /// Of jobs whose analysis says `explore`, and of those queued for it.
    pub explore: Option<Exploration>,
    pub links: Links,
}

/// Why a job has stopped.
#[derive(Debug, Serialize, ToSchema)]
#[serde(untagged)]
pub enum JobStopReason {
    Path(StopReason),
    Limit(LimitReached),
}

/// A limit of this service; what is stored of the job stands.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitReached {
    /// It has run for as long as a job may.
    TimeLimit,
    /// More would be stored of it than may be.
    StorageLimit,
}

/// What a job follows. The other job may have been deleted since; what it gave is kept with this one.
#[derive(Debug, Serialize, ToSchema)]
pub struct Parent {
    pub job: Uuid,
    pub increment: u64,
    /// Place in the increment's `directions`.
    pub direction: u64,
}

/// A place in a sweep.
#[derive(Debug, Serialize, ToSchema)]
pub struct RunOf {
    pub sweep: Uuid,
    pub run: u64,
}

/// A job's part in following the directions that were not taken.
#[derive(Debug, Serialize, ToSchema)]
pub struct Exploration {
    /// The job with which it began.
    pub family: Uuid,
    /// 0 for that job, 1 for those that follow its directions, and so on to `depth`.
    pub generation: u64,
    pub depth: u64,
    pub max_jobs: u64,
    /// The alternatives of this job have been looked at: it and those queued before it have ended.
    pub done: bool,
    /// Alternatives of this job that are not followed, because of `max_jobs` or, in the last generation, `depth`.
    pub not_queued: u64,
    /// Jobs queued in the whole family so far, the first not counted.
    pub family_queued: u64,
    /// Alternatives in the whole family that are not followed, so far.
    pub family_not_queued: u64,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Progress {
    /// Increments up to the last one that is stored, those not recorded among them.
    pub increments: u64,
    /// Index of the last one that is stored; null before the first.
    pub last_index: Option<u64>,
    /// What the request bounds them by.
    pub max_increments: u64,
    /// A smooth bifurcation point is just now being located, or the directions there are, by a worker of the process that is
    /// asked: until that is done no increment comes. Absent where it is not so.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub locating_bifurcation: bool,
}

/// Addresses of what belongs to a job.
#[derive(Debug, Serialize, ToSchema)]
pub struct Links {
    #[serde(rename = "self")]
    pub itself: String,
    pub increments: String,
    pub stream: String,
    pub path_csv: String,
}

impl TryFrom<JobRecord> for Job {
    type Error = serde_json::Error;

    fn try_from(record: JobRecord) -> Result<Self, serde_json::Error> {
        let itself = address(record.id);
        Ok(Self {
            submitted: Submitted::from(&record),
            progress: Progress {
                increments: record.last_index.map_or(0, |index| index + 1),
                last_index: record.last_index,
                max_increments: record.max_increments,
                locating_bifurcation: false,
            },
            plan: RawValue::from_string(record.plan)?,
            stop_reason: record.stop_reason,
            report: record.report.map(RawValue::from_string).transpose()?,
            parent: record.parent.map(|parent| Parent {
                job: parent.job,
                increment: parent.increment,
                direction: parent.direction,
            }),
            sweep: record.run.map(|run| RunOf { sweep: run.sweep, run: run.run }),
            children: record.children,
            explore: record.membership.map(|member| Exploration {
                family: member.family,
                generation: member.generation,
                depth: member.explore.depth,
                max_jobs: member.explore.max_jobs,
                done: member.explored,
                not_queued: member.not_queued,
                family_queued: member.family_queued,
                family_not_queued: member.family_not_queued,
            }),
            links: Links {
                increments: format!("{itself}/increments"),
                stream: format!("{itself}/stream"),
                path_csv: format!("{itself}/path.csv"),
                itself,
            },
        })
    }
}

pub fn address(id: Uuid) -> String {
    format!("/v1/jobs/{id}")
}

#[derive(Debug, Serialize, ToSchema)]
pub struct JobList {
    /// Newest first.
    pub jobs: Vec<Job>,
    /// Pass it as `cursor` for the next page; null on the last one.
    pub next_cursor: Option<Uuid>,
}

/// One event of a stream (WHATWG HTML, section 9.2); what is absent was not sent.
#[derive(Debug, Serialize, ToSchema)]
pub struct ServerEvent {
    /// `increment` or `row`, then `end`; `deleted` where that ends it.
    #[schema(nullable = false)]
    pub event: Option<String>,
    /// The index, of an increment or row.
    #[schema(nullable = false)]
    pub id: Option<String>,
    /// JSON: the increment or the row; of `end`, the job, the study or the sweep.
    #[schema(nullable = false)]
    pub data: Option<String>,
    /// Milliseconds after which it is worth coming back.
    #[schema(nullable = false)]
    pub retry: Option<u64>,
}

/// Stored increments, in order.
#[derive(Debug, Serialize, ToSchema)]
pub struct IncrementPage {
    /// Empty when there are no more for now.
    #[schema(value_type = Vec<JudgedIncrement>)]
    pub increments: Vec<Box<RawValue>>,
    /// Pass it as `after` for the next page: the last index of this one, or what was asked for when it is empty.
    pub next_after: Option<u64>,
}

/// A built-in scene.
#[derive(Debug, Serialize, ToSchema)]
pub struct SceneSummary {
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// Where its job request is, ready to post.
    pub link: String,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct SceneList {
    pub scenes: Vec<SceneSummary>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Health {
    /// Always `alive`.
    pub status: &'static str,
    pub version: &'static str,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Readiness {
    /// Always `ready`; what is not ready answers 503.
    pub status: &'static str,
    /// Workers alive in this process.
    pub workers: usize,
}
