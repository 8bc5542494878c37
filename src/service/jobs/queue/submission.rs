//! Preparation of a request before it is queued: it is read, checked and planned.

use crate::model::request::Explore;
use crate::model::{InputError, InputErrors, decode};
use crate::result::plan::Plan;
use crate::service::jobs::configuration::settings::Settings;
use crate::service::jobs::queue::checks::{CheckContext, Checks, Room, Whole};
use crate::service::jobs::{Caller, JobsError, Posted};
use crate::service::store::{JobRecord, NewJob, Submitted, Task};
use serde::Serialize;
use serde::de::IgnoredAny;
use std::string::FromUtf8Error;

/// A checked request, with its plan.
#[derive(Debug)]
pub(super) struct Prepared<P> {
    /// The text of the request, as posted.
    pub text: String,
    pub name: Option<String>,
    pub plan: P,
    /// A short form of a large plan, for lists.
    pub summary: Option<String>,
    pub max_increments: u64,
    pub explore: Option<Explore>,
}

/// Reads and checks a posted request in one piece.
pub(super) async fn prepared<P: Send + 'static>(
    checks: &Checks,
    request: Posted,
    prepare: fn(&CheckContext<'_>, Vec<u8>) -> Result<Prepared<P>, JobsError>,
) -> Result<(Prepared<P>, Room), JobsError> {
    let check = move |text| Whole::of(move |context: &CheckContext<'_>| prepare(context, text));
    let (prepared, held) = checks.run(request, check).await?;
    Ok((prepared, held.leave()))
}

impl<P: Serialize> Prepared<P> {
    /// The job to be queued for a caller.
    pub(super) fn into_job(
        self,
        caller: &Caller,
        task: Task,
        settings: &Settings,
        idempotency_key: Option<String>,
    ) -> Result<NewJob, JobsError> {
        let Self { text, name, plan, summary, max_increments, explore } = self;
        Ok(NewJob {
            task,
            owner: caller.owner().map(str::to_owned),
            name,
            plan: serde_json::to_string(&plan)?,
            request: text,
            max_increments,
            max_attempts: settings.max_attempts,
            summary,
            most_queued: settings.limits.queued,
            priority: 0,
            idempotency_key,
            explore,
        })
    }
}

pub(super) fn prepare(context: &CheckContext<'_>, request: Vec<u8>) -> Result<Prepared<Plan>, JobsError> {
    let decoded = decode::decode(&request).map_err(|errors| wrong_input(&request, errors, JobsError::Input))?;
    context.limits.check(&decoded.model, decoded.analysis.max_increments).map_err(JobsError::Input)?;
    context.go_on()?;
    let plan = context.solver.plan(&decoded).map_err(JobsError::Input)?;
    let text = String::from_utf8(request).map_err(not_text)?;
    let (max_increments, explore) = (decoded.analysis.max_increments, decoded.analysis.explore);
    Ok(Prepared { text, name: decoded.model.name, plan, summary: None, max_increments, explore })
}

/// The error of a request that cannot be decoded: text that is no JSON, or JSON with mistakes (`otherwise`).
pub(super) fn wrong_input(request: &[u8], errors: InputErrors, otherwise: fn(InputErrors) -> JobsError) -> JobsError {
    // The encoding first: serde_json does not check the encoding of ignored parts.
    let is_json = std::str::from_utf8(request).is_ok_and(|text| serde_json::from_str::<IgnoredAny>(text).is_ok());
    if is_json { otherwise(errors) } else { JobsError::NotJson(errors) }
}

pub(super) fn not_text(error: FromUtf8Error) -> JobsError {
    JobsError::NotJson(InputErrors(vec![InputError::new("", error.to_string())]))
}

/// The record of a submitted job, if the store has queued it now or before under the same idempotency key.
pub(super) fn queued(submitted: Submitted) -> Result<JobRecord, JobsError> {
    match submitted {
        Submitted::Created(job) => {
            tracing::info!(job = %job.id, "queued");
            Ok(job)
        }
        Submitted::Repeated(job) => Ok(job),
        Submitted::KeyReused => Err(JobsError::KeyReused),
        Submitted::QueueFull { most } => Err(JobsError::QueueFull(most)),
    }
}
