//! Jobs as clients see them: submitted, read, listed, cancelled, deleted.

use super::rows::{self, job_columns, signed};
use super::{SqliteStore, now};
use crate::store::{JobRecord, ListFilter, NewJob, Result, Submitted};
use sqlx::Row;
use uuid::Uuid;

pub(super) async fn submit(store: &SqliteStore, job: NewJob) -> Result<Submitted> {
    let mut transaction = store.writer.begin().await?;
    let inserted = sqlx::query(concat!(
        "INSERT INTO jobs (id, name, status, priority, request, idempotency_key, plan, max_increments, max_attempts, \
         created_at, updated_at) VALUES (?1, ?2, 'queued', ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?9) \
         ON CONFLICT (idempotency_key) DO NOTHING RETURNING ",
        job_columns!()
    ))
    .bind(Uuid::now_v7())
    .bind(&job.name)
    .bind(job.priority)
    .bind(&job.request)
    .bind(&job.idempotency_key)
    .bind(&job.plan)
    .bind(signed(job.max_increments))
    .bind(job.max_attempts)
    .bind(now())
    .fetch_optional(&mut *transaction)
    .await?;
    if let Some(row) = inserted {
        let record = rows::job(&row)?;
        transaction.commit().await?;
        store.signals.queue_changed();
        return Ok(Submitted::Created(record));
    }
    let row = sqlx::query(concat!("SELECT request, ", job_columns!(), " FROM jobs WHERE idempotency_key = ?"))
        .bind(&job.idempotency_key)
        .fetch_one(&mut *transaction)
        .await?;
    transaction.rollback().await?;
    let same = row.try_get::<String, _>("request")? == job.request;
    Ok(if same { Submitted::Repeated(rows::job(&row)?) } else { Submitted::KeyReused })
}

pub(super) async fn get(store: &SqliteStore, id: Uuid) -> Result<Option<JobRecord>> {
    let row = sqlx::query(concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = ?"))
        .bind(id)
        .fetch_optional(&store.readers)
        .await?;
    row.as_ref().map(rows::job).transpose()
}

pub(super) async fn list(store: &SqliteStore, filter: ListFilter) -> Result<Vec<JobRecord>> {
    // Two statements, so that each can walk an index.
    let query = match filter.status {
        Some(status) => sqlx::query(concat!(
            "SELECT ",
            job_columns!(),
            " FROM jobs WHERE status = ?3 AND (?1 IS NULL OR id < ?1) ORDER BY id DESC LIMIT ?2"
        ))
        .bind(filter.before)
        .bind(filter.limit)
        .bind(status.name()),
        None => sqlx::query(concat!(
            "SELECT ",
            job_columns!(),
            " FROM jobs WHERE (?1 IS NULL OR id < ?1) ORDER BY id DESC LIMIT ?2"
        ))
        .bind(filter.before)
        .bind(filter.limit),
    };
    query.fetch_all(&store.readers).await?.iter().map(rows::job).collect()
}

pub(super) async fn request_cancel(store: &SqliteStore, id: Uuid) -> Result<Option<JobRecord>> {
    sqlx::query(
        "UPDATE jobs SET cancel_requested = 1, updated_at = ?2, \
         stop_reason = CASE status WHEN 'queued' THEN 'cancelled' ELSE stop_reason END, \
         ended_at = CASE status WHEN 'queued' THEN ?2 ELSE ended_at END, \
         status = CASE status WHEN 'queued' THEN 'cancelled' ELSE status END \
         WHERE id = ?1 AND status IN ('queued', 'running')",
    )
    .bind(id)
    .bind(now())
    .execute(&store.writer)
    .await?;
    store.signals.job_changed(id);
    get(store, id).await
}

pub(super) async fn delete(store: &SqliteStore, id: Uuid) -> Result<bool> {
    let deleted = sqlx::query("DELETE FROM jobs WHERE id = ?").bind(id).execute(&store.writer).await?;
    store.signals.job_changed(id);
    Ok(deleted.rows_affected() > 0)
}
