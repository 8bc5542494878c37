//! The findings of a sweep.

use crate::model::request::sweep::Variation;
use crate::studies::sweeps::LimitLoad;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = SweepRow))]
pub struct Row {
    /// From 0; in a grid those of the last parameter change fastest.
    pub run: u64,
    /// The job that traces it, at a service.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub job: Option<String>,
    /// In the order of the parameters.
    pub values: Vec<Value>,
    /// `completed`, `stopped`, `cancelled` or `failed`.
    pub status: String,
    /// Why the path ended, where it did so by itself.
    pub stop_reason: Option<String>,
    /// Why there is no path, or no whole one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Index of the last increment; null before the first.
    pub last_index: Option<u64>,
    /// The first limit point; null where there is none, or none yet.
    pub first_limit: Option<LimitLoad>,
    /// By the names of the sweep's `responses`: numbers, or texts such as a status; null where the path does not reach the
    /// place, or has no such value there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub responses: Option<IndexMap<String, Value>>,
}

/// A sweep with its runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    pub name: Option<String>,
    #[serde(flatten)]
    pub variation: Variation,
    /// In the order of the runs; at a service, of those that have ended.
    pub rows: Vec<Row>,
}
