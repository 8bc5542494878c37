//! The queue: who works on what, and until when.
//!
//! Every statement of a worker is fenced by job, worker, attempt and `running`: a worker that comes back after its lease
//! was given to another changes nothing.

use super::rows::{self, unsigned};
use super::{SqliteStore, after, followers, now};
use crate::store::{Claim, Ending, Lease, LeaseAnswer, Result, StoreError};
use sqlx::Row;
use std::time::Duration;
use uuid::Uuid;

pub(super) async fn claim(store: &SqliteStore, worker: &str, lease: Duration) -> Result<Option<Claim>> {
    let row = sqlx::query(
        "UPDATE jobs SET status = 'running', worker = ?1, lease_until = ?2, attempt = attempt + 1, \
         started_at = coalesce(started_at, ?3), updated_at = ?3 \
         WHERE id = (SELECT id FROM jobs WHERE status = 'queued' ORDER BY priority DESC, id LIMIT 1) \
         RETURNING id, task, attempt, request, max_increments, last_index, parent, parent_increment, parent_direction, family",
    )
    .bind(worker)
    .bind(after(lease))
    .bind(now())
    .fetch_optional(&store.writer)
    .await?;
    let Some(row) = row else { return Ok(None) };
    let job: Uuid = row.try_get("id")?;
    let origin = match rows::parent(&row)? {
        Some(parent) => Some((parent, followers::origin(store, job).await?)),
        None => None,
    };
    let claim = Claim {
        lease: Lease { job, worker: worker.to_owned(), attempt: row.try_get("attempt")? },
        task: rows::task(&row)?,
        request: row.try_get("request")?,
        max_increments: unsigned(row.try_get("max_increments")?)?,
        last_index: row.try_get::<Option<i64>, _>("last_index")?.map(unsigned).transpose()?,
        origin,
        explores: row.try_get::<Option<Uuid>, _>("family")?.is_some(),
    };
    store.signals.job_changed(job);
    Ok(Some(claim))
}

pub(super) async fn renew(store: &SqliteStore, lease: &Lease, duration: Duration) -> Result<LeaseAnswer> {
    let row = sqlx::query(
        "UPDATE jobs SET lease_until = ?4 WHERE id = ?1 AND worker = ?2 AND attempt = ?3 AND status = 'running' \
         RETURNING cancel_requested",
    )
    .bind(lease.job)
    .bind(&lease.worker)
    .bind(lease.attempt)
    .bind(after(duration))
    .fetch_optional(&store.writer)
    .await?;
    answer(row)
}

pub(super) async fn finish(store: &SqliteStore, lease: &Lease, ending: Ending) -> Result<LeaseAnswer> {
    let row = sqlx::query(
        "UPDATE jobs SET status = ?4, stop_reason = ?5, report = ?6, error = ?7, worker = NULL, lease_until = NULL, \
         ended_at = ?8, updated_at = ?8 \
         WHERE id = ?1 AND worker = ?2 AND attempt = ?3 AND status = 'running' RETURNING cancel_requested",
    )
    .bind(lease.job)
    .bind(&lease.worker)
    .bind(lease.attempt)
    .bind(ending.status.name())
    .bind(&ending.stop_reason)
    .bind(&ending.report)
    .bind(&ending.error)
    .bind(now())
    .fetch_optional(&store.writer)
    .await?;
    store.signals.job_changed(lease.job);
    answer(row)
}

pub(super) async fn release(store: &SqliteStore, lease: &Lease) -> Result<LeaseAnswer> {
    // The attempt is given back: going away in good order says nothing against the job. A cancelled one is not queued again.
    let row = sqlx::query(
        "UPDATE jobs SET status = CASE cancel_requested WHEN 0 THEN 'queued' ELSE 'cancelled' END, \
         stop_reason = CASE cancel_requested WHEN 0 THEN NULL ELSE 'cancelled' END, \
         ended_at = CASE cancel_requested WHEN 0 THEN NULL ELSE ?4 END, \
         attempt = attempt - 1, worker = NULL, lease_until = NULL, updated_at = ?4 \
         WHERE id = ?1 AND worker = ?2 AND attempt = ?3 AND status = 'running' RETURNING cancel_requested",
    )
    .bind(lease.job)
    .bind(&lease.worker)
    .bind(lease.attempt)
    .bind(now())
    .fetch_optional(&store.writer)
    .await?;
    store.signals.job_changed(lease.job);
    store.signals.queue_changed();
    answer(row)
}

pub(super) async fn reclaim_expired(store: &SqliteStore) -> Result<u64> {
    let rows = sqlx::query(
        "UPDATE jobs SET \
         status = CASE WHEN cancel_requested THEN 'cancelled' WHEN attempt < max_attempts THEN 'queued' ELSE 'failed' END, \
         stop_reason = CASE WHEN cancel_requested THEN 'cancelled' END, \
         error = CASE WHEN NOT cancel_requested AND attempt >= max_attempts \
                 THEN 'the worker was lost in each of ' || max_attempts || ' attempts' END, \
         ended_at = CASE WHEN cancel_requested OR attempt >= max_attempts THEN ?1 END, \
         worker = NULL, lease_until = NULL, updated_at = ?1 \
         WHERE status = 'running' AND lease_until < ?1 RETURNING id",
    )
    .bind(now())
    .fetch_all(&store.writer)
    .await?;
    for row in &rows {
        store.signals.job_changed(row.try_get("id")?);
    }
    if !rows.is_empty() {
        store.signals.queue_changed();
    }
    u64::try_from(rows.len()).map_err(|error| StoreError::Refused(Box::new(error)))
}

pub(super) fn answer(row: Option<sqlx::sqlite::SqliteRow>) -> Result<LeaseAnswer> {
    match row {
        Some(row) => Ok(LeaseAnswer::Held { cancel_requested: row.try_get("cancel_requested")? }),
        None => Ok(LeaseAnswer::Lost),
    }
}
