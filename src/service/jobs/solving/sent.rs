//! What leaves a solve: lines and checkpoints on its way, and how it ended.

use crate::check::judged::JudgedReport;
use crate::model::InputErrors;
use crate::resources::budget::Breach;
use crate::service::store::{Checkpoint, Line};
use crate::studies::error_against_time;

/// How a solve ended.
#[derive(Debug)]
pub enum SolveEnd {
    Reported(Box<JudgedReport>),
    /// The stored request is no longer accepted, for example after an upgrade.
    Refused(InputErrors),
    Panicked(String),
    Unwritable(String),
    /// This increment is stored and comes out otherwise now, or not at all.
    Differs(u64),
    /// Where the job begins, or what it has found already, cannot be read.
    Unreadable(String),
    /// A study has ended, complete or cancelled.
    Studied(error_against_time::Report),
    /// Cancelled before there was anything to report.
    Cancelled,
    /// It would have gone past a bound where there is no path to report it.
    Exceeded(Breach),
    /// Without a report: nobody listened any more, or a defect.
    Silent,
}

/// What leaves a solve, in the order in which it is to be stored.
#[derive(Debug)]
pub enum Sent {
    /// An increment, or a row of a study, and, of a limit point, the load there, as JSON.
    Line(Line, Option<String>),
    Checkpoint(Checkpoint),
}

impl Sent {
    pub fn index(&self) -> u64 {
        match self {
            Self::Line(line, _) => line.index,
            Self::Checkpoint(checkpoint) => checkpoint.index,
        }
    }
}
