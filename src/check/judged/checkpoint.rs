//! A checkpoint of a judged path: the path at a point, and the history of its judge.

use crate::check::judged::alternatives::Alternatives;
use crate::check::judged::increment::JudgedIncrement;
use crate::check::judged::report::MeasureReport;
use crate::check::measure::{HistoryError, JudgeHistory};
use crate::continuation::path::checkpoint::{Checkpoint, CheckpointError};
use serde::{Deserialize, Serialize};

/// A checkpoint of a judged path. Its parts have version numbers.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedCheckpoint {
    /// The path at one of its points.
    pub path: Checkpoint,
    /// What the measure needs of the points before.
    pub history: JudgeHistory,
    /// The maxima of the measure up to here.
    pub measure: MeasureReport,
    /// The properties by which known alternatives are recognised at the next increment.
    #[serde(default, skip_serializing_if = "Alternatives::is_fresh")]
    pub alternatives: Alternatives,
    /// The current increment, if it is not recorded: it is emitted if it turns out to be the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<Box<JudgedIncrement>>,
}

/// Why a judged path cannot be resumed, or a direction of it cannot be followed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JudgedCheckpointError {
    /// The path itself.
    #[error(transparent)]
    Path(#[from] CheckpointError),
    /// The history of its measure.
    #[error(transparent)]
    History(#[from] HistoryError),
}
