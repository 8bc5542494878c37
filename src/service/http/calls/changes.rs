//! All changes of jobs, studies and sweeps, as they happen.

use crate::service::http::answer::problem::Problem;
use crate::service::http::document;
use crate::service::http::tasks::feed::stream_changes;
use crate::service::http::tasks::requester::Requester;
use crate::service::http::view::change::ChangeEvent;
use axum::http::HeaderMap;
use axum::response::Response;

/// Follow all jobs, studies and sweeps: each after a change of its status or progress.
///
/// Server-sent events. `changed` has the job, study or sweep as it is now, in short; `deleted` its id. Changes that come
/// shortly after one another are told as one. Without `Last-Event-ID` the first event is `begin`, whose id is the place from
/// which changes are told: list what is there after it. A client that comes back with `Last-Event-ID` gets what has
/// changed since, and deletions of the last day; where the id is none of this database, `begin` comes again. When the
/// service goes down the stream ends after a `retry:`.
#[utoipa::path(
    get, path = "/v1/changes", tag = document::JOBS, operation_id = "stream_changes",
    params(("Last-Event-ID" = Option<String>, Header, description = "Id of the last event received.")),
    responses((status = 200, description = "Changes in their order, without end.", content(
        (ChangeEvent = "text/event-stream")
    )))
)]
pub async fn changes(requester: Requester, headers: HeaderMap) -> Result<Response, Problem> {
    stream_changes(requester, &headers)
}
