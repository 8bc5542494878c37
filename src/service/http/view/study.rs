//! Studies as they are answered.

use crate::service::http::view::submitted::Submitted;
use crate::service::store::JobRecord;
use crate::studies::error_against_time::{StudyPlan, StudyReport};
use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};
use utoipa::ToSchema;
use uuid::Uuid;

/// A study, without what it has found. Its status is `stopped` only where a limit of this service was reached (`error` says
/// which): how a path ends is a finding.
#[derive(Debug, Serialize, ToSchema)]
pub struct Study {
    #[serde(flatten)]
    pub submitted: Submitted,
    pub progress: StudyProgress,
    #[schema(value_type = StudyPlan)]
    pub plan: Box<RawValue>,
    pub links: StudyLinks,
}

/// A study with what it has found so far.
#[derive(Debug, Serialize, ToSchema)]
pub struct StudyWithReport {
    #[serde(flatten)]
    pub study: Study,
    /// Null before the first path.
    #[schema(value_type = Option<StudyReport>)]
    pub report: Option<Box<RawValue>>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct StudyProgress {
    /// Paths traced so far.
    pub runs: u64,
    /// Paths in all, but for the reference's.
    pub of: u64,
}

/// Addresses of what belongs to a study.
#[derive(Debug, Serialize, ToSchema)]
pub struct StudyLinks {
    #[serde(rename = "self")]
    pub itself: String,
    pub stream: String,
    pub table_csv: String,
    pub table_txt: String,
    pub picture: String,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct StudyList {
    /// Newest first.
    pub studies: Vec<Study>,
    /// Pass it as `cursor` for the next page; null on the last one.
    pub next_cursor: Option<Uuid>,
}

impl TryFrom<JobRecord> for Study {
    type Error = serde_json::Error;

    fn try_from(record: JobRecord) -> Result<Self, serde_json::Error> {
        let itself = address(record.id);
        Ok(Self {
            submitted: Submitted::from(&record),
            progress: StudyProgress { runs: record.lines_done(), of: record.max_increments },
            plan: RawValue::from_string(record.plan)?,
            links: StudyLinks {
                stream: format!("{itself}/stream"),
                table_csv: format!("{itself}/table.csv"),
                table_txt: format!("{itself}/table.txt"),
                picture: format!("{itself}/picture.svg"),
                itself,
            },
        })
    }
}

/// With the report that was stored at the end.
impl TryFrom<JobRecord> for StudyWithReport {
    type Error = serde_json::Error;

    fn try_from(mut record: JobRecord) -> Result<Self, serde_json::Error> {
        let report = record.report.take().map(RawValue::from_string).transpose()?;
        Ok(Self { study: record.try_into()?, report })
    }
}

impl StudyWithReport {
    /// With the report as it is now.
    pub fn so_far(record: JobRecord, report: Option<&StudyReport>) -> Result<Self, serde_json::Error> {
        Ok(Self { study: record.try_into()?, report: report.map(to_raw_value).transpose()? })
    }
}

pub fn address(id: Uuid) -> String {
    format!("/v1/studies/{id}")
}
