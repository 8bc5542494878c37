//! The outcome of a command: its exit status, or why it failed.

use crate::model::InputErrors;
use crate::result::plan::Warning;
use std::io::Write;
use std::process::ExitCode;

pub(crate) const FAILED: u8 = 1;

pub(crate) const BAD_INPUT: u8 = 2;

/// Why a command failed.
#[derive(Debug)]
pub enum Failure {
    /// Mistakes in the input, one line each.
    Input(Vec<String>),
    /// Mistakes in a document, each with its place.
    Document(InputErrors),
    /// Any other reason.
    Other(String),
}

impl Failure {
    pub(crate) fn other(error: impl std::fmt::Display) -> Self {
        Self::Other(error.to_string())
    }
}

pub(crate) type Outcome = Result<ExitCode, Failure>;

/// Tells what may be a mistake.
pub(crate) fn tell(warnings: &[Warning]) {
    warnings.iter().for_each(|warning| eprintln!("warning: {}: {}", warning.pointer, warning.detail));
}

/// Writes to standard output, which may be closed.
pub(crate) fn say(text: impl std::fmt::Display) -> Result<(), Failure> {
    write!(std::io::stdout(), "{text}").map_err(|error| Failure::Other(format!("standard output: {error}")))
}
