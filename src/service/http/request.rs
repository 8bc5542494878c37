//! What a job was asked to do.

use crate::model::JobRequest;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::tasks::Asked;
use crate::service::http::view::Job;
use axum::http::header;
use axum::response::Response;

/// The job's request: model and analysis, ready to post again.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/request", tag = document::JOBS, operation_id = "get_request",
    params(("id" = Uuid, Path, description = "The job's id.")),
    responses((status = 200, description = "The request; of a job that follows another, that job's.", body = JobRequest))
)]
pub async fn request(asked: Asked<Job>) -> Result<Response, Problem> {
    asked.standing().await?;
    let Asked { service, id, headers, .. } = asked;
    let text = service.jobs.store().request(id).await?.ok_or_else(|| Problem::not_found(format_args!("such job")))?;
    // It never changes, whatever becomes of the job.
    let bytes = text.len();
    let make = move || tag::bytes(&headers, true, [(header::CONTENT_TYPE, "application/json")], text);
    service.aside.make(bytes, make).await
}
