//! Metrics: every call is counted and timed, and all metrics of the service can be read.

use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::document;
use crate::service::http::state::service::Service;
use crate::service::jobs::Jobs;
use crate::service::metrics::{MEDIA_TYPE, Reading};
use axum::extract::{MatchedPath, Request, State};
use axum::http::header;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::time::{Duration, Instant};
use tokio::time::timeout;

/// If the store does not answer within this time, the metrics are answered without the jobs.
const PATIENCE: Duration = Duration::from_secs(3);

/// What the service counts and times, for Prometheus.
///
/// Jobs by status, their waits in the queue, increments stored, the solver's steps, writes to the database, streams and their
/// lag, calls by route, workers and memory; counters begin at 0 with the process.
#[utoipa::path(
    get, path = "/metrics", tag = document::PROBES, operation_id = "metrics",
    responses((status = 200, description = "Lines of the OpenMetrics text format.",
        content((String = "application/openmetrics-text"))))
)]
pub async fn metrics(State(service): State<Service>) -> Result<Response, Problem> {
    let jobs = match timeout(PATIENCE, service.jobs.store().tally()).await {
        Ok(Ok(tally)) => tally.into_iter().map(|(status, count)| (status.name(), count)).collect(),
        Ok(Err(error)) => {
            tracing::warn!(%error, "jobs could not be counted by status");
            Vec::new()
        }
        Err(_) => {
            tracing::warn!("jobs could not be counted by status: the database does not answer");
            Vec::new()
        }
    };
    let (workers_alive, workers_expected) = (service.worker_count.alive(), service.worker_count.expected());
    let text = service.jobs.metrics().text(&Reading { jobs, workers_alive, workers_expected }).map_err(|error| {
        tracing::error!(%error, "the metrics cannot be written");
        Problem::new(Kind::Internal, "the metrics cannot be written")
    })?;
    Ok(([(header::CONTENT_TYPE, MEDIA_TYPE)], text).into_response())
}

/// Counts and times a call.
pub async fn observe(State(jobs): State<Jobs>, request: Request, next: Next) -> Response {
    let began = Instant::now();
    let (method, route) = (request.method().clone(), request.extensions().get::<MatchedPath>().cloned());
    let response = next.run(request).await;
    let route = route.as_ref().map(MatchedPath::as_str);
    jobs.metrics().requests.answered(method.as_str(), route, response.status().as_u16(), began.elapsed());
    response
}
