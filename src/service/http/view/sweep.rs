//! Sweeps as they are answered.

use crate::model::VariationSummary;
use crate::model::request::response::Response;
use crate::model::request::sweep::{Combine, SweepParameter};
use crate::result::plan::Warning;
use crate::service::http::view::submitted::Submitted;
use crate::service::store::JobRecord;
use crate::studies::sweeps::Row;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::ToSchema;
use uuid::Uuid;

/// A sweep, without what it has found. It runs until all of its runs have ended, however they do.
#[derive(Debug, Serialize, ToSchema)]
pub struct Sweep {
    #[serde(flatten)]
    pub submitted: Submitted,
    pub progress: SweepProgress,
    #[serde(flatten)]
    pub variation: Variation,
    pub links: SweepLinks,
}

/// What is varied, and how: passed on as it is stored.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
pub struct Variation {
    /// In the order of the request.
    #[schema(value_type = Vec<SweepParameter>)]
    parameters: Box<RawValue>,
    combine: Combine,
    /// What is told of each path, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<IndexMap<String, Response>>)]
    responses: Option<Box<RawValue>>,
    /// Further runs at most, where the first response changes most; absent where none are asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    refine: Option<u64>,
    /// The labels of the units of responses that have one, where the model names its units; by the names of the responses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<IndexMap<String, String>>, nullable = false)]
    response_units: Option<Box<RawValue>>,
    /// What is valid in its runs and may be a mistake; absent where nothing is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<Warning>,
}

/// A sweep as it is listed: what it varies is shortened.
#[derive(Debug, Serialize, ToSchema)]
pub struct ListedSweep {
    #[serde(flatten)]
    pub submitted: Submitted,
    pub progress: SweepProgress,
    #[serde(flatten)]
    pub variation: VariationSummary,
    pub links: SweepLinks,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct SweepProgress {
    /// Runs that have ended.
    pub ended: u64,
    /// Runs in all, those among them that a refinement has added so far.
    pub of: u64,
}

/// Addresses of what belongs to a sweep.
#[derive(Debug, Serialize, ToSchema)]
pub struct SweepLinks {
    #[serde(rename = "self")]
    pub itself: String,
    pub rows: String,
    pub stream: String,
    /// Its runs as jobs.
    pub jobs: String,
    pub table_csv: String,
    pub table_txt: String,
    pub picture: String,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct SweepList {
    /// Newest first.
    pub sweeps: Vec<ListedSweep>,
    /// Pass it as `cursor` for the next page; null on the last one.
    pub next_cursor: Option<Uuid>,
}

/// Runs that have ended, in the order in which they did.
#[derive(Debug, Serialize, ToSchema)]
pub struct SweepRows {
    /// Empty when there are no more for now.
    #[schema(value_type = Vec<Row>)]
    pub rows: Vec<Box<RawValue>>,
    /// Pass it as `after` for the next page: the place of the last row of this one, or what was asked for when it is empty.
    pub next_after: Option<u64>,
}

/// What a sweep would do.
#[derive(Debug, Serialize, ToSchema)]
pub struct SweepPlan {
    /// Jobs that would be queued.
    pub runs: u64,
    #[serde(flatten)]
    pub variation: Variation,
}

impl TryFrom<JobRecord> for Sweep {
    type Error = serde_json::Error;

    fn try_from(record: JobRecord) -> Result<Self, serde_json::Error> {
        Ok(Self {
            submitted: Submitted::from(&record),
            progress: SweepProgress::of(&record),
            variation: serde_json::from_str(&record.plan)?,
            links: SweepLinks::of(record.id),
        })
    }
}

/// Of a record as lists have it.
impl TryFrom<JobRecord> for ListedSweep {
    type Error = serde_json::Error;

    fn try_from(record: JobRecord) -> Result<Self, serde_json::Error> {
        Ok(Self {
            submitted: Submitted::from(&record),
            progress: SweepProgress::of(&record),
            variation: VariationSummary::read(&record.plan)?,
            links: SweepLinks::of(record.id),
        })
    }
}

impl SweepProgress {
    fn of(record: &JobRecord) -> Self {
        Self { ended: record.lines_done(), of: record.max_increments }
    }
}

impl SweepLinks {
    fn of(id: Uuid) -> Self {
        let itself = address(id);
        Self {
            rows: format!("{itself}/rows"),
            stream: format!("{itself}/stream"),
            jobs: format!("/v1/jobs?sweep={id}"),
            table_csv: format!("{itself}/table.csv"),
            table_txt: format!("{itself}/table.txt"),
            picture: format!("{itself}/picture.svg"),
            itself,
        }
    }
}

pub fn address(id: Uuid) -> String {
    format!("/v1/sweeps/{id}")
}
