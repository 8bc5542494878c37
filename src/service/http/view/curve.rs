//! Curves of limit points and others as they are answered.

use crate::service::http::view::submitted::Submitted;
use crate::service::jobs::queue::curves::CurvePlan;
use crate::service::store::JobRecord;
use crate::studies::critical_curves::{CurveRow, CurveSummary};
use serde::Serialize;
use serde_json::value::RawValue;
use utoipa::ToSchema;
use uuid::Uuid;

/// A curve of limit points or others. Its status is `stopped` where there is no such point to follow, or it cannot be followed, and
/// where a limit of this service was reached; `error` says which. How far the curve goes is a finding.
#[derive(Debug, Serialize, ToSchema)]
pub struct Curve {
    #[serde(flatten)]
    pub submitted: Submitted,
    pub progress: CurveProgress,
    /// `no_limit_point` where there is none, or it cannot be followed.
    pub stop_reason: Option<String>,
    #[schema(value_type = CurvePlan)]
    pub plan: Box<RawValue>,
    /// Null before the end, and where it was cancelled.
    #[schema(value_type = Option<CurveSummary>)]
    pub report: Option<Box<RawValue>>,
    pub links: CurveLinks,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct CurveProgress {
    /// Points found so far.
    pub points: u64,
    /// Points at the longest step; there may be more.
    pub of: u64,
}

/// Addresses of what belongs to a curve.
#[derive(Debug, Serialize, ToSchema)]
pub struct CurveLinks {
    #[serde(rename = "self")]
    pub itself: String,
    pub rows: String,
    pub stream: String,
    pub table_csv: String,
    pub table_txt: String,
    pub picture: String,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct CurveList {
    /// Newest first.
    pub curves: Vec<Curve>,
    /// Pass it as `cursor` for the next page; null on the last one.
    pub next_cursor: Option<Uuid>,
}

/// Points of a curve, in the order in which they were found.
#[derive(Debug, Serialize, ToSchema)]
pub struct CurveRows {
    /// Empty when there are no more for now.
    #[schema(value_type = Vec<CurveRow>)]
    pub rows: Vec<Box<RawValue>>,
    /// Pass it as `after` for the next page: the place of the last row of this one, or what was asked for when it is empty.
    pub next_after: Option<u64>,
}

impl TryFrom<JobRecord> for Curve {
    type Error = serde_json::Error;

    fn try_from(record: JobRecord) -> Result<Self, serde_json::Error> {
        let itself = address(record.id);
        Ok(Self {
            submitted: Submitted::from(&record),
            progress: CurveProgress { points: record.lines_done(), of: record.max_increments },
            stop_reason: record.stop_reason,
            plan: RawValue::from_string(record.plan)?,
            report: record.report.map(RawValue::from_string).transpose()?,
            links: CurveLinks {
                rows: format!("{itself}/rows"),
                stream: format!("{itself}/stream"),
                table_csv: format!("{itself}/table.csv"),
                table_txt: format!("{itself}/table.txt"),
                picture: format!("{itself}/picture.svg"),
                itself,
            },
        })
    }
}

pub fn address(id: Uuid) -> String {
    format!("/v1/curves/{id}")
}
