//! The output of a solve: lines and checkpoints, and how it ended.

use crate::check::judged::JudgedReport;
use crate::model::InputErrors;
use crate::resources::budget::Breach;
use crate::service::store::{Checkpoint, Line};
use crate::studies::critical_curves::CurveSummary;
use crate::studies::error_against_time;

/// How a solve ended.
#[derive(Debug)]
pub enum SolveEnd {
    Reported(Box<JudgedReport>),
    /// The stored request is no longer accepted, for example after an upgrade.
    Refused(InputErrors),
    Panicked(String),
    Unwritable(String),
    /// The recomputed increment of this index differs from the stored one, or the path does not reach it.
    Differs(u64),
    /// The stored beginning of the job, or its stored lines, cannot be read.
    Unreadable(String),
    /// A study has ended, completed or cancelled.
    Studied(error_against_time::StudyReport),
    /// A curve has ended, completed or cancelled.
    Curved(CurveSummary),
    /// There is no limit point to follow, or it cannot be followed.
    NoCurve(InputErrors),
    /// Cancelled before there was a report.
    Cancelled,
    /// The solve would have exceeded a bound before there was a path with a report.
    Exceeded(Breach),
    /// Ended without a report: the receiver was gone, or the solver has a defect.
    Silent,
}

/// A piece of output, in the order in which it is to be stored.
#[derive(Debug)]
pub enum SolveOutput {
    /// An increment, a row of a study or a point of a curve; with the load of a limit point, as JSON.
    Line(Line, Option<String>),
    Checkpoint(Checkpoint),
}

impl SolveOutput {
    pub fn index(&self) -> u64 {
        match self {
            Self::Line(line, _) => line.index,
            Self::Checkpoint(checkpoint) => checkpoint.index,
        }
    }
}
