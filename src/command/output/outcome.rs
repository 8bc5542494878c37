//! How a command ends: its exit status, or why it failed.

use std::io::Write;
use std::process::ExitCode;

pub(crate) const FAILED: u8 = 1;

pub(crate) const BAD_INPUT: u8 = 2;

/// How a command ended, when not well.
#[derive(Debug)]
pub enum Failure {
    /// The input is at fault: one line each.
    Input(Vec<String>),
    /// Something else is.
    Other(String),
}

impl Failure {
    pub(crate) fn other(error: impl std::fmt::Display) -> Self {
        Self::Other(error.to_string())
    }
}

pub(crate) type Outcome = Result<ExitCode, Failure>;

/// Writes to standard output, whose reader may have gone.
pub(crate) fn say(text: impl std::fmt::Display) -> Result<(), Failure> {
    write!(std::io::stdout(), "{text}").map_err(|error| Failure::Other(format!("standard output: {error}")))
}
