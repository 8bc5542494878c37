//! The stored request of a job.

use crate::model::JobRequest;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use axum::http::header;
use axum::response::Response;

/// The job's request: model and analysis, ready to post again.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/request", tag = document::JOBS, operation_id = "get_request",
    responses((status = 200, description = "The request; of a job that follows another, that job's.", body = JobRequest))
)]
pub async fn request(target: Target<Job>) -> Result<Response, Problem> {
    target.standing().await?;
    let Target { service, id, headers, .. } = target;
    let text = service.jobs.store().request(id).await?.ok_or_else(|| Problem::not_found(format_args!("such job")))?;
    // The request never changes, so that its tag holds before the job has ended.
    let bytes = text.len();
    let make = move || tag::bytes(&headers, true, [(header::CONTENT_TYPE, "application/json")], text);
    service.offload.run(bytes, make).await
}
