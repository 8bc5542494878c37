//! What jobs, studies and sweeps have in common: how they are submitted, listed, cancelled and dropped.

use super::Service;
use super::extract::{Taken, bounded};
use super::problem::Problem;
use crate::jobs::Caller;
use crate::store::{JobRecord, ListFilter, Status, Task};
use axum::Json;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use uuid::Uuid;

const LIST_DEFAULT: u32 = 50;
const LIST_LARGEST: u32 = 200;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct SubmitParameters {
    /// Check the request and answer its plan; queue nothing.
    #[serde(default)]
    pub(super) validate: bool,
}

impl Taken for SubmitParameters {
    const TAKEN: &'static [(&'static str, &'static str)] = &[("validate", "`true` or `false`")];
}

/// Of lists that are chosen from by status alone.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ListByStatus {
    /// Only those with this status.
    status: Option<Status>,
    /// `next_cursor` of the page before.
    cursor: Option<Uuid>,
    #[param(minimum = 1, maximum = 200, default = 50)]
    limit: Option<u32>,
}

impl Taken for ListByStatus {
    const TAKEN: &'static [(&'static str, &'static str)] = &[
        ("status", "`queued`, `running`, `completed`, `stopped`, `cancelled` or `failed`"),
        ("cursor", "the `next_cursor` of the page before, a UUID,"),
        ("limit", "a whole number from 1 to 200"),
    ];
}

impl ListByStatus {
    /// The page that is asked for, of what is the caller's.
    ///
    /// # Errors
    /// A limit out of its bounds, or a store that fails.
    pub(super) async fn page<T: View>(
        self,
        service: &Service,
        caller: &Caller,
        task: Task,
    ) -> Result<(Vec<T>, Option<Uuid>), Problem> {
        let owner = caller.seen_owner().map(str::to_owned);
        let Self { status, cursor: before, limit } = self;
        page(service, limit, |limit| ListFilter { task, owner, status, sweep: None, parent: None, before, limit }).await
    }
}

/// A record as it is answered.
pub(super) trait View: TryFrom<JobRecord, Error = serde_json::Error> + Serialize {}

impl<T: TryFrom<JobRecord, Error = serde_json::Error> + Serialize> View for T {}

/// The answer to what has been queued: where it is, and what it is.
pub(super) fn accepted<T: View>(record: JobRecord, address: fn(Uuid) -> String) -> Result<Response, Problem> {
    let location = address(record.id);
    Ok((StatusCode::ACCEPTED, [(header::LOCATION, location)], Json(T::try_from(record)?)).into_response())
}

/// What is listed, newest first, up to so many, and the cursor of the next page.
pub(super) async fn page<T: View>(
    service: &Service,
    limit: Option<u32>,
    filter: impl FnOnce(u32) -> ListFilter,
) -> Result<(Vec<T>, Option<Uuid>), Problem> {
    let limit = bounded("limit", limit, LIST_DEFAULT, LIST_LARGEST)?;
    // One more than asked for tells whether there is a next page.
    let mut records = service.jobs.store().jobs(filter(limit + 1)).await?;
    let more = records.len() > limit as usize;
    records.truncate(limit as usize);
    let next_cursor = records.last().map(|record| record.id).filter(|_| more);
    Ok((records.into_iter().map(T::try_from).collect::<Result<_, _>>()?, next_cursor))
}

/// Stops one that has not ended, and answers it.
pub(super) async fn cancel<T: View>(
    service: &Service,
    caller: &Caller,
    task: Task,
    id: Uuid,
) -> Result<(StatusCode, Json<T>), Problem> {
    let record = service.jobs.cancel(caller, task, id).await?;
    Ok((StatusCode::ACCEPTED, Json(record.try_into()?)))
}

/// Stops and drops one.
pub(super) async fn delete(service: &Service, caller: &Caller, task: Task, id: Uuid) -> Result<StatusCode, Problem> {
    service.jobs.delete(caller, task, id).await?;
    Ok(StatusCode::NO_CONTENT)
}
