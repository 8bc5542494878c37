//! What jobs, studies and sweeps have in common: how they are submitted, listed, cancelled and dropped.

use super::Service;
use super::extract::{Taken, bounded};
use super::problem::Problem;
use super::tag;
use crate::jobs::Caller;
use crate::store::{JobRecord, Line, ListFilter, Listed, Page, Status, Task};
use axum::Json;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use uuid::Uuid;

const LIST_DEFAULT: u32 = 50;
const LIST_LARGEST: u32 = 200;
/// A page ends early when what it lists is large.
const LIST_BYTES: usize = 1 << 20;

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
        page(service, limit, |page| ListFilter { task, owner, status, sweep: None, parent: None, before, page }).await
    }
}

/// A record as it is answered.
pub(super) trait View: TryFrom<JobRecord, Error = serde_json::Error> + Serialize + Send + 'static {}

impl<T: TryFrom<JobRecord, Error = serde_json::Error> + Serialize + Send + 'static> View for T {}

/// The answer to what has been queued: where it is, and what it is.
pub(super) async fn accepted<T: View>(
    service: &Service,
    record: JobRecord,
    address: fn(Uuid) -> String,
) -> Result<Response, Problem> {
    let location = address(record.id);
    let made = service.aside.make(record.bytes(), move || Ok::<_, Problem>(Json(T::try_from(record)?).into_response()));
    Ok((StatusCode::ACCEPTED, [(header::LOCATION, location)], made.await?).into_response())
}

/// One of them, with a tag where it has ended.
pub(super) async fn shown<T: View>(
    service: &Service,
    headers: HeaderMap,
    record: JobRecord,
) -> Result<Response, Problem> {
    let (bytes, is_finished) = (record.bytes(), record.status.is_ended());
    service.aside.make(bytes, move || tag::json(&headers, is_finished, &T::try_from(record)?)).await
}

/// What is listed, newest first, up to so many, and the cursor of the next page.
pub(super) async fn page<T: View>(
    service: &Service,
    limit: Option<u32>,
    filter: impl FnOnce(Page) -> ListFilter,
) -> Result<(Vec<T>, Option<Uuid>), Problem> {
    let rows = bounded("limit", limit, LIST_DEFAULT, LIST_LARGEST)?;
    let Listed { jobs, more } = service.jobs.store().jobs(filter(Page { rows, bytes: LIST_BYTES })).await?;
    let next_cursor = jobs.last().map(|record| record.id).filter(|_| more);
    let bytes = jobs.iter().map(JobRecord::bytes).sum();
    let made = service.aside.make(bytes, move || jobs.into_iter().map(T::try_from).collect::<Result<_, _>>());
    Ok((made.await?, next_cursor))
}

/// Stops one that has not ended, and answers it.
pub(super) async fn cancel<T: View>(
    service: &Service,
    caller: &Caller,
    task: Task,
    id: Uuid,
) -> Result<Response, Problem> {
    let record = service.jobs.cancel(caller, task, id).await?;
    let made = service.aside.make(record.bytes(), move || Ok::<_, Problem>(Json(T::try_from(record)?).into_response()));
    Ok((StatusCode::ACCEPTED, made.await?).into_response())
}

/// Stops and drops one.
pub(super) async fn delete(service: &Service, caller: &Caller, task: Task, id: Uuid) -> Result<StatusCode, Problem> {
    service.jobs.delete(caller, task, id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// An answer made of stored lines, which are passed on as they stand.
pub(super) async fn of_lines(
    service: &Service,
    lines: Vec<Line>,
    make: impl FnOnce(Vec<Box<RawValue>>) -> Result<Response, Problem> + Send + 'static,
) -> Result<Response, Problem> {
    let bytes = lines.iter().map(|line| line.body.len()).sum();
    let made = move || make(lines.into_iter().map(|line| RawValue::from_string(line.body)).collect::<Result<_, _>>()?);
    service.aside.make(bytes, made).await
}
