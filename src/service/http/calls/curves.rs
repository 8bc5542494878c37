//! Curves of limit points, bifurcation points and contact changes: submit, continue from a job, list, read, follow, cancel, delete; their rows, table and picture.

use crate::model::request::curve::{CurveRequest, CurveSettings};
use crate::service::http::answer::problem::Problem;
use crate::service::http::document;
use crate::service::http::input::extract::{JsonText, Parameters, bounded, idempotency_key, index};
use crate::service::http::state::service::Service;
use crate::service::http::tasks::findings::{FindingsSoFar, MOST_OF_A_TABLE, StoredFindings, WithFindings, too_large};
use crate::service::http::tasks::requester::{ListByStatus, Requester};
use crate::service::http::tasks::resource::Resource;
use crate::service::http::tasks::stream::stream_lines;
use crate::service::http::tasks::submission::{Submission, SubmitParameters, accepted};
use crate::service::http::tasks::target::{MOST_ROWS, RowParameters, Target};
use crate::service::http::view::curve::{Curve, CurveList, CurveRows, address};
use crate::service::http::view::job::Job;
use crate::service::http::view::stream::ServerEvent;
use crate::service::jobs::queue::curves::{self, CurvePlan};
use crate::service::jobs::{Caller, JobsError, Posted};
use crate::service::store::{JobRecord, Task};
use crate::studies::critical_curves::{CurveFound, CurveRow};
use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use uuid::Uuid;

impl Resource for Curve {
    const TASK: Task = Task::Curve;
    const ADDRESS: fn(Uuid) -> String = address;
    type Listed = Self;

    async fn validated(service: &Service, request: Posted) -> Result<Response, Problem> {
        Ok(Json(service.jobs.validate_curve(request).await?).into_response())
    }

    async fn submitted(
        service: &Service,
        caller: &Caller,
        request: Posted,
        idempotency_key: Option<String>,
    ) -> Result<JobRecord, JobsError> {
        service.jobs.submit_curve(caller, request, idempotency_key).await
    }
}

impl WithFindings for Curve {
    type Findings = CurveFound;

    async fn stored_findings(target: &Target<Self>) -> Result<StoredFindings<CurveFound>, Problem> {
        let (id, curve) = (target.id, target.find().await?);
        let lines = target.service.jobs.lines(id, None, MOST_OF_A_TABLE).await?;
        let bytes = curve.bytes() + lines.iter().map(|line| line.body.len()).sum::<usize>();
        if bytes > MOST_OF_A_TABLE {
            return Err(too_large(&(address(id) + "/rows")));
        }
        let is_finished = curve.status.is_ended();
        Ok(StoredFindings { bytes, is_finished, read: Box::new(move || Ok(curves::found(curve, &lines)?)) })
    }
}

/// Queue a curve of limit points or others, or only check it.
///
/// A limit point, bifurcation point or contact change of the model's path is followed as a number of the model varies: each
/// point is found from its neighbours on the curve, without a path of its own. Where the points change their kind, or the
/// path to them its changes of contact, this is located in the parameter, and the path is traced once more to go on from
/// there.
#[utoipa::path(
    post, path = "/v1/curves", tag = document::CURVES, operation_id = "submit_curve",
    params(SubmitParameters),
    request_body = CurveRequest,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Curve),
        (status = 200, description = "With `validate=true`: what would be done.", body = CurvePlan),
    )
)]
pub async fn submit(submission: Submission<Curve>) -> Result<Response, Problem> {
    submission.submit().await
}

/// Queue a curve of a limit point, bifurcation point or contact change of this job.
///
/// The curve has the model and the analysis of the job; with `increment` it starts at the point stored there. It
/// stands on its own, so that the job may be deleted. `Idempotency-Key` works as with `POST /v1/jobs`.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/continue", tag = document::JOBS, operation_id = "continue_job",
    params(("id" = Uuid, Path, description = "The job of which a point is followed.")),
    request_body = CurveSettings,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Curve),
    )
)]
pub async fn continue_job(target: Target<Job>, JsonText(request): JsonText) -> Result<Response, Problem> {
    let Target { service, caller, id, headers, .. } = target;
    let curve = service.jobs.continue_job(&caller, id, request, idempotency_key(&headers)?).await?;
    accepted::<Curve>(&service, curve).await
}

/// List curves, newest first.
#[utoipa::path(
    get, path = "/v1/curves", tag = document::CURVES, operation_id = "list_curves", params(ListByStatus),
    responses((status = 200, description = "A page of curves.", body = CurveList))
)]
pub async fn list(
    requester: Requester,
    Parameters(parameters): Parameters<ListByStatus>,
) -> Result<Json<CurveList>, Problem> {
    let (curves, next_cursor) = requester.page::<Curve>(parameters.into()).await?;
    Ok(Json(CurveList { curves, next_cursor }))
}

/// One curve: status, progress, what it follows, and how it ended.
#[utoipa::path(
    get, path = "/v1/curves/{id}", tag = document::CURVES, operation_id = "get_curve",
    responses((status = 200, description = "The curve.", body = Curve))
)]
pub async fn get(target: Target<Curve>) -> Result<Response, Problem> {
    let curve = target.find().await?;
    target.shown::<Curve>(curve).await
}

/// Points found so far, in the order in which they were.
#[utoipa::path(
    get, path = "/v1/curves/{id}/rows", tag = document::CURVES, operation_id = "list_curve_rows",
    params(RowParameters),
    responses((status = 200, description = "A page of rows, empty when there are no more for now.", body = CurveRows))
)]
pub async fn rows(
    target: Target<Curve>,
    Parameters(parameters): Parameters<RowParameters>,
) -> Result<Response, Problem> {
    let after = index("after", parameters.after)?;
    let limit = bounded("limit", parameters.limit, MOST_ROWS, MOST_ROWS)?;
    target.lines(after, limit, |rows, next_after| CurveRows { rows, next_after }).await
}

/// Follow a curve: its points as they are found, then its end.
///
/// Server-sent events: `row` events, one a point, whose id is its place in the order of finding; then one `end` event with the
/// curve. `Last-Event-ID` and a service that goes down are as for a job's stream.
///
/// With `Accept: application/x-ndjson`: one point a line, and a last line with the curve, which has no `value`.
#[utoipa::path(
    get, path = "/v1/curves/{id}/stream", tag = document::CURVES, operation_id = "stream_curve",
    params(("Last-Event-ID" = Option<u64>, Header, description = "Id of the last row received.")),
    responses((status = 200, description = "Points in the order in which they are found.", content(
        (ServerEvent = "text/event-stream"),
        (CurveRow = "application/x-ndjson")
    )))
)]
pub async fn stream(target: Target<Curve>) -> Result<Response, Problem> {
    stream_lines(target).await
}

/// Stop a curve within one iteration; what it has found is kept. An ended curve stays as it is.
#[utoipa::path(
    post, path = "/v1/curves/{id}/cancel", tag = document::CURVES, operation_id = "cancel_curve",
    responses((status = 202, description = "The curve; a running one ends shortly.", body = Curve))
)]
pub async fn cancel(target: Target<Curve>) -> Result<Response, Problem> {
    target.cancel().await
}

/// Stop a curve and drop what is stored.
#[utoipa::path(
    delete, path = "/v1/curves/{id}", tag = document::CURVES, operation_id = "delete_curve",
    responses((status = 204, description = "The curve is gone."))
)]
pub async fn delete(target: Target<Curve>) -> Result<StatusCode, Problem> {
    target.delete().await
}

/// The points found so far, in order along the curve, as CSV.
#[utoipa::path(
    get, path = "/v1/curves/{id}/table.csv", tag = document::CURVES, operation_id = "get_curve_table_csv",
    responses((status = 200, description = "The table; one line a point.", body = String, content_type = "text/csv"))
)]
pub async fn table_csv(target: Target<Curve>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::csv).await
}

/// The points found so far, in order along the curve, as columns of text.
#[utoipa::path(
    get, path = "/v1/curves/{id}/table.txt", tag = document::CURVES, operation_id = "get_curve_table_txt",
    responses((status = 200, description = "The table, for a reader.", body = String, content_type = "text/plain"))
)]
pub async fn table_txt(target: Target<Curve>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::text).await
}

/// The load at the points against the parameter.
#[utoipa::path(
    get, path = "/v1/curves/{id}/picture.svg", tag = document::CURVES, operation_id = "get_curve_picture",
    responses((status = 200, description = "The picture.", body = String, content_type = "image/svg+xml"))
)]
pub async fn picture(target: Target<Curve>) -> Result<Response, Problem> {
    target.found(FindingsSoFar::picture).await
}
