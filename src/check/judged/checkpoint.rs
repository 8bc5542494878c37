//! A path put down at a point together with what its judge remembers.

use crate::check::judged::alternatives::Alternatives;
use crate::check::judged::increment::JudgedIncrement;
use crate::check::judged::report::MeasureReport;
use crate::check::measure::{HistoryError, JudgeHistory};
use crate::continuation::path::checkpoint::{Checkpoint, CheckpointError};
use serde::{Deserialize, Serialize};

/// A judged path at one of its points. The parts carry their versions.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgedCheckpoint {
    pub path: Checkpoint,
    pub history: JudgeHistory,
    /// What the measure has said of the path up to here.
    pub measure: MeasureReport,
    /// By what the directions are known that are not new at the next increment.
    #[serde(default, skip_serializing_if = "Alternatives::is_fresh")]
    pub alternatives: Alternatives,
    /// The increment at which the path is, where it is not recorded: it is given after all if it proves to be the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<Box<JudgedIncrement>>,
}

/// Why a judged path cannot be taken up, or a direction of it not followed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JudgedCheckpointError {
    #[error(transparent)]
    Path(#[from] CheckpointError),
    #[error(transparent)]
    History(#[from] HistoryError),
}
