//! What is done with a request before it is queued: read, checked, planned.

use super::JobsError;
use super::checks::Desk;
use crate::model::request::Explore;
use crate::model::{InputError, InputErrors, decode};
use crate::path::Plan;
use serde::de::IgnoredAny;
use std::string::FromUtf8Error;

/// A request that can be queued.
#[derive(Debug)]
pub struct Prepared {
    /// As posted.
    pub text: String,
    pub name: Option<String>,
    pub plan: Plan,
    pub max_increments: u64,
    pub explore: Option<Explore>,
}

pub fn prepare(desk: &Desk<'_>, request: Vec<u8>) -> Result<Prepared, JobsError> {
    let decoded = decode::decode(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    desk.limits.check(&decoded.model, decoded.analysis.max_increments).map_err(JobsError::Input)?;
    desk.go_on()?;
    let plan = desk.solver.plan(&decoded).map_err(JobsError::Input)?;
    let text = String::from_utf8(request).map_err(not_text)?;
    let max_increments = decoded.analysis.max_increments;
    Ok(Prepared { text, name: decoded.model.name, plan, max_increments, explore: decoded.analysis.explore })
}

/// Text that is no JSON at all is told apart from JSON that is not what was asked for.
pub(super) fn wrong_input(request: &[u8], errors: InputErrors, otherwise: fn(InputErrors) -> JobsError) -> JobsError {
    // Bytes first: what serde_json skips it does not check for being UTF-8.
    let is_json = std::str::from_utf8(request).is_ok_and(|text| serde_json::from_str::<IgnoredAny>(text).is_ok());
    if is_json { otherwise(errors) } else { JobsError::NotJson(errors) }
}

pub(super) fn not_text(error: FromUtf8Error) -> JobsError {
    JobsError::NotJson(InputErrors(vec![InputError::new("", error.to_string())]))
}
