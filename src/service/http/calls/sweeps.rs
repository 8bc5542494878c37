//! Sweeps: submit, list, read, follow, cancel, delete; their rows, table and picture.

use crate::model::SweepRequest;
use crate::service::http::answer::problem::Problem;
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, bounded, index};
use crate::service::http::state::service::Service;
use crate::service::http::tasks::findings::{FindingsSoFar, MOST_OF_A_TABLE, StoredFindings, WithFindings, too_large};
use crate::service::http::tasks::requester::{ListByStatus, Requester};
use crate::service::http::tasks::resource::Resource;
use crate::service::http::tasks::stream::stream_lines;
use crate::service::http::tasks::submission::{Submission, SubmitParameters};
use crate::service::http::tasks::target::{MOST_ROWS, RowParameters, Target};
use crate::service::http::view::stream::ServerEvent;
use crate::service::http::view::sweep::{ListedSweep, Sweep, SweepList, SweepPlan, SweepRows, address};
use crate::service::jobs::queue::sweeps;
use crate::service::jobs::{Caller, JobsError, Posted};
use crate::service::store::{JobRecord, Task};
use crate::studies::sweeps::{Found, Row};
use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use uuid::Uuid;

impl Resource for Sweep {
    const TASK: Task = Task::Sweep;
    const ADDRESS: fn(Uuid) -> String = address;
    type Listed = ListedSweep;

    async fn validated(service: &Service, request: Posted) -> Result<Response, Problem> {
        let (variation, runs) = service.jobs.validate_sweep(request).await?;
        let bytes = variation.len();
        let make = move || {
            let variation = serde_json::from_str(&variation)?;
            Ok::<_, Problem>(Json(SweepPlan { runs, variation }).into_response())
        };
        service.offload.run(bytes, make).await
    }

    async fn submitted(
        service: &Service,
        caller: &Caller,
        request: Posted,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        service.jobs.submit_sweep(caller, request, idempotency_key).await
    }
}

impl WithFindings for Sweep {
    type Findings = Found;

    async fn stored_findings(target: &Target<Self>) -> Result<StoredFindings<Found>, Problem> {
        let (id, sweep) = (target.id, target.find().await?);
        let lines = target.service.jobs.lines(id, None, MOST_OF_A_TABLE).await?;
        let bytes = sweep.bytes() + lines.iter().map(|line| line.body.len()).sum::<usize>();
        if bytes > MOST_OF_A_TABLE {
            return Err(too_large(&(address(id) + "/rows")));
        }
        let is_finished = sweep.status.is_ended();
        Ok(StoredFindings { bytes, is_finished, read: Box::new(move || Ok(sweeps::found(sweep, &lines)?)) })
    }
}

/// Queue a sweep, or only check it.
///
/// One model with other values in places of it: a job for each combination, all of them queued together or none. The jobs
/// are like any others; what is found of each is the load at the first limit point of its path.
#[utoipa::path(
    post, path = "/v1/sweeps", tag = document::SWEEPS, operation_id = "submit_sweep",
    params(SubmitParameters),
    request_body = SweepRequest,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Sweep),
        (status = 200, description = "With `validate=true`: what would be done.", body = SweepPlan),
    )
)]
pub async fn submit(submission: Submission<Sweep>) -> Result<Response, Problem> {
    submission.submit().await
}

/// List sweeps, newest first.
#[utoipa::path(
    get, path = "/v1/sweeps", tag = document::SWEEPS, operation_id = "list_sweeps", params(ListByStatus),
    responses((status = 200, description = "A page of sweeps.", body = SweepList))
)]
pub async fn list(
    requester: Requester,
    Parameters(parameters): Parameters<ListByStatus>,
) -> Result<Json<SweepList>, Problem> {
    let (sweeps, next_cursor) = requester.page::<Sweep>(parameters.into()).await?;
    Ok(Json(SweepList { sweeps, next_cursor }))
}

/// One sweep: status, progress, and what it varies.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}", tag = document::SWEEPS, operation_id = "get_sweep",
    responses((status = 200, description = "The sweep.", body = Sweep))
)]
pub async fn get(target: Target<Sweep>) -> Result<Response, Problem> {
    let sweep = target.find().await?;
    target.shown::<Sweep>(sweep).await
}

/// Runs that have ended so far, in the order in which they did.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/rows", tag = document::SWEEPS, operation_id = "list_sweep_rows",
    params(RowParameters),
    responses((status = 200, description = "A page of rows, empty when there are no more for now.", body = SweepRows))
)]
pub async fn rows(
    target: Target<Sweep>,
    Parameters(parameters): Parameters<RowParameters>,
) -> Result<Response, Problem> {
    let after = index("after", parameters.after)?;
    let limit = bounded("limit", parameters.limit, MOST_ROWS, MOST_ROWS)?;
    target.lines(after, limit, |rows, next_after| SweepRows { rows, next_after }).await
}

/// Follow a sweep: its runs as they end, then its own end.
///
/// Server-sent events: `row` events, one a run, whose id is the place in the order of ending; then one `end` event with the
/// sweep. `Last-Event-ID` and a service that goes down are as for a job's stream.
///
/// With `Accept: application/x-ndjson`: one run a line, and a last line with the sweep, which has no `run`.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/stream", tag = document::SWEEPS, operation_id = "stream_sweep",
    params(("Last-Event-ID" = Option<u64>, Header, description = "Id of the last row received.")),
    responses((status = 200, description = "Runs in the order in which they end.", content(
        (ServerEvent = "text/event-stream"),
        (Row = "application/x-ndjson")
    )))
)]
pub async fn stream(target: Target<Sweep>) -> Result<Response, Problem> {
    stream_lines(target).await
}

/// Cancel the runs of a sweep that have not ended; what was found is kept. An ended sweep stays as it is.
#[utoipa::path(
    post, path = "/v1/sweeps/{id}/cancel", tag = document::SWEEPS, operation_id = "cancel_sweep",
    responses((status = 202, description = "The sweep; runs at work end shortly.", body = Sweep))
)]
pub async fn cancel(target: Target<Sweep>) -> Result<Response, Problem> {
    target.cancel().await
}

/// Stop a sweep, and drop it and its jobs.
#[utoipa::path(
    delete, path = "/v1/sweeps/{id}", tag = document::SWEEPS, operation_id = "delete_sweep",
    responses((status = 204, description = "The sweep is gone."))
)]
pub async fn delete(target: Target<Sweep>) -> Result<StatusCode, Problem> {
    target.delete().await
}

/// The runs that have ended, as CSV.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/table.csv", tag = document::SWEEPS, operation_id = "get_sweep_table_csv",
    responses((status = 200, description = "The table; one line a run.", body = String, content_type = "text/csv"))
)]
pub async fn table_csv(target: Target<Sweep>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::csv).await
}

/// The runs that have ended, as columns of text.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/table.txt", tag = document::SWEEPS, operation_id = "get_sweep_table_txt",
    responses((status = 200, description = "The table, for a reader.", body = String, content_type = "text/plain"))
)]
pub async fn table_txt(target: Target<Sweep>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::text).await
}

/// The first limit load against the first parameter, one line for each set of values of the others.
#[utoipa::path(
    get, path = "/v1/sweeps/{id}/picture.svg", tag = document::SWEEPS, operation_id = "get_sweep_picture",
    responses((status = 200, description = "The picture.", body = String, content_type = "image/svg+xml"))
)]
pub async fn picture(target: Target<Sweep>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::picture).await
}
