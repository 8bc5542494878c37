//! The increments of a job as they converge.

use crate::check::judged::JudgedIncrement;
use crate::service::http::answer::problem::Problem;
use crate::service::http::document;
use crate::service::http::tasks::stream::stream_lines;
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use crate::service::http::view::stream::ServerEvent;
use axum::response::Response;

/// Follow a job: its increments as they converge, then its end.
///
/// As server-sent events: `increment` events whose id is the index, then one `end` event with the job. A client that
/// comes back with `Last-Event-ID` goes on after that index, without gap or repeat. When the service goes down the stream
/// ends without `end`, after a `retry:`; a deleted job ends its streams with a `deleted` event.
///
/// With `Accept: application/x-ndjson`: one increment a line and nothing else; the answer is complete when the job has
/// ended, and breaks off (without the last chunk) otherwise.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/stream", tag = document::INCREMENTS, operation_id = "stream_increments",
    params(("Last-Event-ID" = Option<u64>, Header, description = "Index of the last increment received.")),
    responses((status = 200, description = "Increments in order of their index.", content(
        (ServerEvent = "text/event-stream"),
        (JudgedIncrement = "application/x-ndjson")
    )))
)]
pub async fn stream(target: Target<Job>) -> Result<Response, Problem> {
    stream_lines(target).await
}
