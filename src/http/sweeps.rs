//! Sweeps: submit, list, read, follow, cancel, delete; their rows, table and picture.

use super::extract::{JobId, JsonText, Parameters, Taken, bounded, idempotency_key, index};
use super::findings::SoFar;
use super::problem::{Kind, Problem};
use super::tasks::{ListByStatus, SubmitParameters, accepted};
use super::view::ServerEvent;
use super::view_sweep::{Sweep, SweepList, SweepPlan, SweepRows, address};
use super::{Service, document, tag, tasks};
use crate::jobs::{Caller, sweeps};
use crate::model::SweepRequest;
use crate::store::{Page, Task};
use crate::sweeps::{Found, Row};
use axum::Extension;
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use uuid::Uuid;

const ROWS: u32 = 1_000;
const PAGE_BYTES: usize = 1 << 20;
/// Bytes of what a table or a picture is made of: it is held in memory.
const MOST_OF_A_TABLE: usize = 64 << 20;

/// Queue a sweep, or only check it.
///
/// One model with other values in places of it: a job for each combination, all of them queued together or none. The jobs
/// are like any others; what is found of each is the load at the first limit point of its path.
#[utoipa::path(
    post, path = "/v1/sweeps", tag = document::SWEEPS, operation_id = "submit_sweep",
    params(
        SubmitParameters,
        ("Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255, pattern = "^[ -~]+$",
         description = "Sent again with the same body, it answers the sweep of the first time; with another body it is refused.")
    ),
    request_body = SweepRequest,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Sweep,
         headers(("Location" = String, description = "The sweep's address."))),
        (status = 200, description = "With `validate=true`: what would be done.", body = SweepPlan),
    )
)]
pub async fn submit(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    Parameters(parameters): Parameters<SubmitParameters>,
    headers: HeaderMap,
    JsonText(request): JsonText,
) -> Result<Response, Problem> {
    let key = idempotency_key(&headers)?;
    if parameters.validate {
        let (variation, runs) = service.jobs.validate_sweep(request).await?;
        let bytes = variation.len();
        let make = move || {
            let variation = serde_json::from_str(&variation)?;
            Ok::<_, Problem>(Json(SweepPlan { runs, variation }).into_response())
        };
        return service.aside.make(bytes, make).await;
    }
    accepted::<Sweep>(&service, service.jobs.submit_sweep(&caller, request, key).await?, address).await
}

/// List sweeps, newest first.
#[utoipa::path(
    get, path = "/v1/sweeps", tag = document::SWEEPS, operation_id = "list_sweeps", params(ListByStatus),
    responses((status = 200, description = "A page of sweeps.", body = SweepList))
)]
pub async fn list(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    Parameters(parameters): Parameters<ListByStatus>,
) -> Result<Json<SweepList>, Problem> {
    let (sweeps, next_cursor) = parameters.page(&service, &caller, Task::Sweep).await?;
    Ok(Json(SweepList { sweeps, next_cursor }))
}

/// One sweep: status, progress, and what it varies.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}", tag = document::SWEEPS, operation_id = "get_sweep",
    params(("id" = Uuid, Path, description = "The sweep's id.")),
    responses((status = 200, description = "The sweep.", body = Sweep))
)]
pub async fn get(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    tasks::shown::<Sweep>(&service, headers, service.jobs.find(&caller, Task::Sweep, id).await?).await
}

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RowParameters {
    /// Only rows past this place: `next_after` of the page before.
    after: Option<u64>,
    /// Rows at most.
    #[param(minimum = 1, maximum = 1_000, default = 1_000)]
    limit: Option<u32>,
}

impl Taken for RowParameters {
    const TAKEN: &'static [(&'static str, &'static str)] =
        &[("after", "the place of a row, 0 or more,"), ("limit", "a whole number from 1 to 1000")];
}

/// Runs that have ended so far, in the order in which they did.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/rows", tag = document::SWEEPS, operation_id = "list_sweep_rows",
    params(("id" = Uuid, Path, description = "The sweep's id."), RowParameters),
    responses((status = 200, description = "A page of rows, empty when there are no more for now.", body = SweepRows))
)]
pub async fn rows(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    Parameters(parameters): Parameters<RowParameters>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let after = index("after", parameters.after)?;
    let rows = bounded("limit", parameters.limit, ROWS, ROWS)?;
    let is_finished = service.jobs.standing(&caller, Task::Sweep, id).await?.status.is_ended();
    let lines = service.jobs.store().increments(id, after, Page { rows, bytes: PAGE_BYTES }).await?;
    let next_after = lines.last().map(|line| line.index).or(after);
    let make = move |rows| tag::json(&headers, is_finished, &SweepRows { rows, next_after });
    tasks::of_lines(&service, lines, make).await
}

/// Follow a sweep: its runs as they end, then its own end.
///
/// Server-sent events: `row` events, one a run, whose id is the place in the order of ending; then one `end` event with the
/// sweep. `Last-Event-ID` and a service that goes down are as for a job's stream.
///
/// With `Accept: application/x-ndjson`: one run a line, and a last line with the sweep, which has no `run`.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/stream", tag = document::SWEEPS, operation_id = "stream_sweep",
    params(
        ("id" = Uuid, Path, description = "The sweep's id."),
        ("Last-Event-ID" = Option<u64>, Header, description = "Id of the last row received.")
    ),
    responses((status = 200, description = "Runs in the order in which they end.", content(
        (ServerEvent = "text/event-stream"),
        (Row = "application/x-ndjson")
    )))
)]
pub async fn stream(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    super::stream::answer(service, &caller, Task::Sweep, id, &headers).await
}

/// Cancel the runs of a sweep that have not ended; what was found is kept. An ended sweep stays as it is.
#[utoipa::path(
    post, path = "/v1/sweeps/{id}/cancel", tag = document::SWEEPS, operation_id = "cancel_sweep",
    params(("id" = Uuid, Path, description = "The sweep's id.")),
    responses((status = 202, description = "The sweep; runs at work end shortly.", body = Sweep))
)]
pub async fn cancel(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
) -> Result<Response, Problem> {
    tasks::cancel::<Sweep>(&service, &caller, Task::Sweep, id).await
}

/// Stop a sweep, and drop it and its jobs.
#[utoipa::path(
    delete, path = "/v1/sweeps/{id}", tag = document::SWEEPS, operation_id = "delete_sweep",
    params(("id" = Uuid, Path, description = "The sweep's id.")),
    responses((status = 204, description = "The sweep is gone."))
)]
pub async fn delete(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
) -> Result<StatusCode, Problem> {
    tasks::delete(&service, &caller, Task::Sweep, id).await
}

/// The runs that have ended, as CSV.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/table.csv", tag = document::SWEEPS, operation_id = "get_sweep_table_csv",
    params(("id" = Uuid, Path, description = "The sweep's id.")),
    responses((status = 200, description = "The table; one line a run.", body = String, content_type = "text/csv"))
)]
pub async fn table_csv(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    found(&service, &caller, id, move |found| found.csv(&headers)).await
}

/// The runs that have ended, as columns of text.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/table.txt", tag = document::SWEEPS, operation_id = "get_sweep_table_txt",
    params(("id" = Uuid, Path, description = "The sweep's id.")),
    responses((status = 200, description = "The table, for a reader.", body = String, content_type = "text/plain"))
)]
pub async fn table_txt(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    found(&service, &caller, id, move |found| found.text(&headers)).await
}

/// The first limit load against the first parameter, one line for each set of values of the others.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/picture.svg", tag = document::SWEEPS, operation_id = "get_sweep_picture",
    params(("id" = Uuid, Path, description = "The sweep's id.")),
    responses((status = 200, description = "The picture.", body = String, content_type = "image/svg+xml"))
)]
pub async fn picture(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    found(&service, &caller, id, move |found| found.picture(&headers)).await
}

/// An answer of what a sweep has found so far.
async fn found(
    service: &Service,
    caller: &Caller,
    id: Uuid,
    make: impl FnOnce(SoFar<Found>) -> Result<Response, Problem> + Send + 'static,
) -> Result<Response, Problem> {
    let task = Task::Sweep;
    let sweep = service.jobs.find(caller, task, id).await?;
    let lines = service.jobs.lines(id, None, MOST_OF_A_TABLE).await?;
    let bytes = sweep.bytes() + lines.iter().map(|line| line.body.len()).sum::<usize>();
    if bytes > MOST_OF_A_TABLE {
        let detail =
            format!("its rows have more than {MOST_OF_A_TABLE} bytes; read them page by page at {}/rows", address(id));
        return Err(Problem::new(Kind::AnswerTooLarge, detail));
    }
    let is_finished = sweep.status.is_ended();
    let make = move || make(SoFar { task, id, findings: sweeps::found(sweep, &lines)?, is_finished });
    service.aside.make(bytes, make).await
}
