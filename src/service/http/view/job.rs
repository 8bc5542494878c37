//! Jobs as they are answered.

use crate::check::judged::{JudgedIncrement, JudgedReport};
use crate::result::plan::Plan;
use crate::result::stop_reason::StopReason;
use crate::service::http::view::submitted::Submitted;
use crate::service::store::{self, JobRecord};
use serde::Serialize;
use serde_json::value::RawValue;
use utoipa::ToSchema;
use uuid::Uuid;

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
    /// Increments after the first point, up to the last one that is stored, those not recorded among them.
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
    pub results_pvd: String,
    pub results_parquet: String,
    /// With `png` in the place of `svg` the picture is of pixels.
    pub picture: String,
}

impl TryFrom<JobRecord> for Job {
    type Error = serde_json::Error;

    fn try_from(record: JobRecord) -> Result<Self, serde_json::Error> {
        let itself = address(record.id);
        Ok(Self {
            submitted: Submitted::from(&record),
            progress: Progress {
                increments: record.lines_done(),
                last_index: record.last_index,
                max_increments: record.max_increments,
                locating_bifurcation: false,
            },
            plan: RawValue::from_string(record.plan)?,
            stop_reason: record.stop_reason,
            report: record.report.map(RawValue::from_string).transpose()?,
            parent: record.parent.map(Parent::from),
            sweep: record.run.map(RunOf::from),
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
                results_pvd: format!("{itself}/results.pvd"),
                results_parquet: format!("{itself}/results.parquet"),
                picture: format!("{itself}/picture.svg"),
                itself,
            },
        })
    }
}

impl From<store::Parent> for Parent {
    fn from(store::Parent { job, increment, direction }: store::Parent) -> Self {
        Self { job, increment, direction }
    }
}

impl From<store::RunOf> for RunOf {
    fn from(store::RunOf { sweep, run }: store::RunOf) -> Self {
        Self { sweep, run }
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

/// Stored increments, in order.
#[derive(Debug, Serialize, ToSchema)]
pub struct IncrementPage {
    /// Empty when there are no more for now.
    #[schema(value_type = Vec<JudgedIncrement>)]
    pub increments: Vec<Box<RawValue>>,
    /// Pass it as `after` for the next page: the last index of this one, or what was asked for when it is empty.
    pub next_after: Option<u64>,
}
