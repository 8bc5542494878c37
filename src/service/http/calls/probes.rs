//! Probes: whether the service is alive, and whether it is ready to work.

use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::document;
use crate::service::http::state::service::Service;
use crate::service::http::view::probe::{Health, Readiness};
use crate::service::store::StoreError;
use axum::Json;
use axum::extract::State;
use std::time::Duration;
use tokio::time::timeout;

/// A probe fails if the database does not answer within this time.
const PATIENCE: Duration = Duration::from_secs(3);

/// The process answers.
#[utoipa::path(
    get, path = "/healthz", tag = document::PROBES, operation_id = "health",
    responses((status = 200, description = "Alive.", body = Health))
)]
pub async fn alive() -> Json<Health> {
    Json(Health { status: "alive", version: env!("CARGO_PKG_VERSION") })
}

/// The database takes writes, every worker is alive, and the service is not going down; 503 otherwise.
#[utoipa::path(
    get, path = "/readyz", tag = document::PROBES, operation_id = "readiness",
    responses((status = 200, description = "Ready.", body = Readiness))
)]
pub async fn ready(State(service): State<Service>) -> Result<Json<Readiness>, Problem> {
    if service.shutdown.is_cancelled() {
        return Err(Problem::new(Kind::Unavailable, "the service is shutting down"));
    }
    if !service.worker_count.is_complete() {
        return Err(Problem::new(Kind::Unavailable, "a worker has ended"));
    }
    match timeout(PATIENCE, service.jobs.store().probe()).await {
        Ok(Ok(())) => Ok(Json(Readiness { status: "ready", workers: service.worker_count.alive() })),
        Ok(Err(error @ StoreError::Damaged(_))) => {
            tracing::error!(%error, "the database is damaged");
            Err(Problem::new(Kind::Unavailable, "the database is damaged; a backup has to be restored"))
        }
        Ok(Err(error @ StoreError::Full(_))) => {
            tracing::error!(%error, "the database takes no writes");
            Err(Problem::new(Kind::Unavailable, "the disk that holds the database is full"))
        }
        Ok(Err(error)) => {
            tracing::error!(%error, "the database takes no writes");
            Err(Problem::new(Kind::Unavailable, "the database takes no writes"))
        }
        Err(_) => Err(Problem::new(Kind::Unavailable, "the database does not answer")),
    }
}
