//! What is done with a request before it is queued: read, checked, planned.

use super::{JobsError, Solver};
use crate::model::{InputErrors, decode};
use crate::path::Plan;
use serde::de::IgnoredAny;

/// A request that can be queued.
#[derive(Debug)]
pub struct Prepared {
    /// As posted.
    pub text: String,
    pub name: Option<String>,
    pub plan: Plan,
    pub max_increments: u64,
}

pub fn prepare(solver: &dyn Solver, request: Vec<u8>) -> Result<Prepared, JobsError> {
    let text = String::from_utf8(request).map_err(|error| JobsError::NotJson(error.to_string()))?;
    let decoded = decode::decode(text.as_bytes()).map_err(|errors| wrong_input(&text, errors))?;
    let plan = solver.plan(&decoded).map_err(JobsError::Input)?;
    Ok(Prepared { text, name: decoded.model.name, plan, max_increments: decoded.analysis.max_increments })
}

/// Text that is no JSON at all is told apart from JSON that is no job.
fn wrong_input(text: &str, errors: InputErrors) -> JobsError {
    match serde_json::from_str::<IgnoredAny>(text) {
        Ok(_) => JobsError::Input(errors),
        Err(error) => JobsError::NotJson(error.to_string()),
    }
}
