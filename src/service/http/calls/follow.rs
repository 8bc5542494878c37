//! Queues a job that follows a direction of another job.

use crate::model::FollowRequest;
use crate::service::http::answer::problem::Problem;
use crate::service::http::document;
use crate::service::http::input::extract::{JsonText, idempotency_key};
use crate::service::http::tasks::submission::accepted;
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use axum::response::Response;

/// Queue a job that follows a direction listed at a stored increment of this one.
///
/// It has the model and the analysis of this job. Its first increment, of index 0 and kind `start`, is the point itself:
/// loads, energies and arc length are carried over, and the counts by which a stage may end. The directions of an
/// increment can be followed as soon as it is stored; the new job stands on its own, so that this one may be deleted.
/// `Idempotency-Key` works as with `POST /v1/jobs`.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/follow", tag = document::JOBS, operation_id = "follow_direction",
    params(("id" = Uuid, Path, description = "The job whose direction is followed.")),
    request_body = FollowRequest,
    responses(
        (status = 202, description = "Queued, or queued before under the same idempotency key.", body = Job),
    )
)]
pub async fn follow(target: Target<Job>, JsonText(request): JsonText) -> Result<Response, Problem> {
    let Target { service, caller, id, headers, .. } = target;
    let job = service.jobs.follow(&caller, id, request, idempotency_key(&headers)?).await?;
    accepted::<Job>(&service, job).await
}
