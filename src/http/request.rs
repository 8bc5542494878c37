//! What a job was asked to do.

use super::extract::JobId;
use super::problem::Problem;
use super::{Service, document, tag};
use crate::jobs::Caller;
use crate::model::JobRequest;
use crate::store::Task;
use axum::Extension;
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::Response;

/// The job's request: model and analysis, ready to post again.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/request", tag = document::JOBS, operation_id = "get_request",
    params(("id" = Uuid, Path, description = "The job's id.")),
    responses((status = 200, description = "The request; of a job that follows another, that job's.", body = JobRequest))
)]
pub async fn request(
    State(service): State<Service>,
    Extension(caller): Extension<Caller>,
    JobId(id): JobId,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    service.jobs.standing(&caller, Task::Path, id).await?;
    let text = service.jobs.store().request(id).await?.ok_or_else(|| Problem::not_found(format_args!("such job")))?;
    // It never changes, whatever becomes of the job.
    let bytes = text.len();
    service
        .aside
        .make(bytes, move || tag::bytes(&headers, true, [(header::CONTENT_TYPE, "application/json")], text))
        .await
}
