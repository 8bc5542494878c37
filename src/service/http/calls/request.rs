//! The stored request of a job.

use crate::model::{JobRequest, decode};
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, QueryParameters};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use axum::http::header;
use axum::response::Response;
use serde::Deserialize;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct RequestParameters {
    /// Whether the parts of a mesh, and the nodes of sets and surfaces, stand in place of their names.
    #[param(default = false)]
    expanded: Option<bool>,
}

impl QueryParameters for RequestParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] = &[("expanded", "true or false")];
}

/// The job's request: model and analysis, ready to post again.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/request", tag = document::JOBS, operation_id = "get_request",
    params(RequestParameters),
    responses((status = 200, description = "The request; of a job that follows another, that job's.", body = JobRequest))
)]
pub async fn request(
    target: Target<Job>,
    Parameters(parameters): Parameters<RequestParameters>,
) -> Result<Response, Problem> {
    target.standing().await?;
    let Target { service, id, headers, .. } = target;
    let text = service.jobs.store().request(id).await?.ok_or_else(|| Problem::not_found(format_args!("such job")))?;
    // The request never changes, so that its tag holds before the job has ended.
    let bytes = text.len();
    let is_expanded = parameters.expanded.unwrap_or(false);
    let make = move || {
        let text = if is_expanded { expanded(text) } else { text };
        tag::bytes(&headers, true, [(header::CONTENT_TYPE, "application/json")], text)
    };
    service.offload.run(bytes, make).await
}

/// The text of the expanded request; the text as it is where it cannot be read, which a stored request can.
fn expanded(text: String) -> String {
    let request = decode::decode(text.as_bytes()).ok();
    request.and_then(|request| serde_json::to_string(&request).ok()).unwrap_or(text)
}
