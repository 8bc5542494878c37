//! What is done with a request before it is queued: read, checked, planned.

use super::{Jobs, JobsError, Limits, Solver};
use crate::model::request::Explore;
use crate::model::{InputError, InputErrors, decode};
use crate::path::Plan;
use serde::de::IgnoredAny;
use std::string::FromUtf8Error;
use std::sync::Arc;

/// A request as it came, and what is held for as long as it is: the room that it takes.
pub struct Posted {
    pub text: Vec<u8>,
    pub room: Room,
}

/// Given back when it is dropped.
pub type Room = Option<Box<dyn Send>>;

impl From<Vec<u8>> for Posted {
    fn from(text: Vec<u8>) -> Self {
        Self { text, room: None }
    }
}

impl Jobs {
    /// Reads and checks what was posted, on a thread of its own: that takes time that the runtime's threads do not have. So
    /// many at a time as there are processors, and whether or not the client is still there, since what has begun cannot be
    /// stopped.
    pub(super) async fn checked<T: Send + 'static>(
        &self,
        posted: Posted,
        check: impl FnOnce(&dyn Solver, &Limits, Vec<u8>) -> Result<T, JobsError> + Send + 'static,
    ) -> Result<(T, Room), JobsError> {
        // Nobody closes it.
        let turn = Arc::clone(&self.checks).acquire_owned().await.ok();
        let (solver, limits) = (Arc::clone(&self.solver), self.settings.limits);
        let Posted { text, room } = posted;
        tokio::task::spawn_blocking(move || {
            let _turn = turn;
            check(solver.as_ref(), &limits, text).map(|checked| (checked, room))
        })
        .await?
    }
}

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

pub fn prepare(solver: &dyn Solver, limits: &Limits, request: Vec<u8>) -> Result<Prepared, JobsError> {
    let decoded = decode::decode(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    limits.check(&decoded.model, decoded.analysis.max_increments).map_err(JobsError::Input)?;
    let plan = solver.plan(&decoded).map_err(JobsError::Input)?;
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
