//! The stored request of a job.

use crate::model::{JobRequest, decode};
use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, QueryParameters};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use axum::http::header;
use axum::response::Response;
use serde::Deserialize;
use std::io::Write;

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
    let is_expanded = parameters.expanded.unwrap_or(false);
    // A short text may name large sets many times.
    let most = service.jobs.settings.limits.body_bytes.saturating_mul(EXPANSION);
    let bytes = if is_expanded { most } else { text.len() };
    let make = move || {
        let text = if is_expanded { expanded(&text, most)? } else { text.into_bytes() };
        tag::bytes(&headers, true, [(header::CONTENT_TYPE, "application/json")], text)
    };
    service.offload.run(bytes, make).await
}

/// An expanded request may be so many times as long as a posted one.
const EXPANSION: usize = 4;

/// Bytes up to a number.
struct BoundedText {
    text: Vec<u8>,
    most: usize,
}

impl Write for BoundedText {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.text.len() + bytes.len() > self.most {
            return Err(std::io::ErrorKind::FileTooLarge.into());
        }
        self.text.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The text of the expanded request.
fn expanded(text: &str, most: usize) -> Result<Vec<u8>, Problem> {
    // A stored request has been read before.
    let request = decode::decode(text.as_bytes())
        .map_err(|errors| Problem::new(Kind::Internal, format!("the stored request cannot be read: {errors}")))?;
    let mut bounded = BoundedText { text: Vec::with_capacity(text.len()), most };
    serde_json::to_writer(&mut bounded, &request).map_err(|_| {
        let detail = format!("expanded, the request has more than {most} bytes; without `expanded` it is given");
        Problem::new(Kind::AnswerTooLarge, detail)
    })?;
    Ok(bounded.text)
}
