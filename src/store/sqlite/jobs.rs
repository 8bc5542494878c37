//! Jobs as clients see them: submitted, read, listed, cancelled, deleted.

use super::rows::{self, job_columns, signed};
use super::{SqliteStore, now};
use crate::store::{JobRecord, Keep, ListFilter, NewJob, Result, Standing, Status, Submitted};
use sqlx::{QueryBuilder, Row, Sqlite, Transaction};
use uuid::Uuid;

/// Ended jobs that are dropped in one go.
const DROPPED_AT_ONCE: u32 = 10;

/// How many jobs wait.
macro_rules! waiting {
    () => {
        "(SELECT jobs FROM tallies WHERE status = 'queued')"
    };
}
pub(super) use waiting;

/// Queues a job as a part of a transaction, unless its key is known or there are enough that wait.
pub(super) async fn insert(transaction: &mut Transaction<'_, Sqlite>, job: &NewJob) -> Result<Submitted> {
    let id = Uuid::now_v7();
    let key = owned_key(job.owner.as_deref(), job.idempotency_key.as_deref());
    let inserted = sqlx::query(concat!(
        "INSERT INTO jobs (id, name, status, priority, request, idempotency_key, plan, max_increments, max_attempts, \
         created_at, updated_at, family, task, owner) \
         SELECT ?2, ?3, 'queued', ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?10, ?11, ?12, ?13 WHERE ",
        waiting!(),
        " < ?1 ON CONFLICT (idempotency_key) DO NOTHING",
    ))
    .bind(signed(job.most_queued))
    .bind(id)
    .bind(&job.name)
    .bind(job.priority)
    .bind(&job.request)
    .bind(&key)
    .bind(&job.plan)
    .bind(signed(job.max_increments))
    .bind(job.max_attempts)
    .bind(now())
    .bind(job.explore.map(|_| id))
    .bind(job.task.name())
    .bind(&job.owner)
    .execute(&mut **transaction)
    .await?;
    if inserted.rows_affected() > 0 {
        if let Some(explore) = job.explore {
            sqlx::query("INSERT INTO families (id, depth, max_jobs) VALUES (?1, ?2, ?3)")
                .bind(id)
                .bind(signed(explore.depth))
                .bind(signed(explore.max_jobs))
                .execute(&mut **transaction)
                .await?;
        }
        return Ok(Submitted::Created(record(transaction, id).await?));
    }
    let row = sqlx::query(concat!("SELECT request, ", job_columns!(), " FROM jobs WHERE idempotency_key = ?"))
        .bind(&key)
        .fetch_optional(&mut **transaction)
        .await?;
    let Some(row) = row else { return Ok(Submitted::QueueFull { most: job.most_queued }) };
    let record = rows::job(&row)?;
    // A job that follows another has that one's request, and is another job.
    let same =
        record.task == job.task && record.parent.is_none() && row.try_get::<String, _>("request")? == job.request;
    Ok(if same { Submitted::Repeated(record) } else { Submitted::KeyReused })
}

/// As it is stored: keys that different owners send do not meet. No name of an owner and no key holds a line break.
pub(super) fn owned_key(owner: Option<&str>, key: Option<&str>) -> Option<String> {
    key.map(|key| owner.map_or_else(|| key.to_owned(), |owner| format!("{owner}\n{key}")))
}

/// A job that has just been stored.
pub(super) async fn record(transaction: &mut Transaction<'_, Sqlite>, id: Uuid) -> Result<JobRecord> {
    let row = sqlx::query(concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = ?"))
        .bind(id)
        .fetch_one(&mut **transaction)
        .await?;
    rows::job(&row)
}

pub(super) async fn get(store: &SqliteStore, id: Uuid) -> Result<Option<JobRecord>> {
    let row = sqlx::query(concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = ?"))
        .bind(id)
        .fetch_optional(&store.readers)
        .await?;
    row.as_ref().map(rows::job).transpose()
}

pub(super) async fn standing(store: &SqliteStore, id: Uuid) -> Result<Option<Standing>> {
    let row =
        sqlx::query("SELECT status, last_index FROM jobs WHERE id = ?").bind(id).fetch_optional(&store.readers).await?;
    let standing = |row: &_| Ok(Standing { status: rows::status(row)?, last_index: rows::last_index(row)? });
    row.as_ref().map(standing).transpose()
}

pub(super) async fn list(store: &SqliteStore, filter: ListFilter) -> Result<Vec<JobRecord>> {
    // Only the conditions that are asked for, so that the statement can walk an index.
    let mut query = QueryBuilder::<Sqlite>::new(concat!("SELECT ", job_columns!(), " FROM jobs WHERE task = "));
    query.push_bind(filter.task.name());
    if let Some(parent) = filter.parent {
        query.push(" AND parent = ").push_bind(parent);
    }
    if let Some(status) = filter.status {
        query.push(" AND status = ").push_bind(status.name());
    }
    if let Some(owner) = filter.owner {
        query.push(" AND owner = ").push_bind(owner);
    }
    if let Some(before) = filter.before {
        query.push(" AND id < ").push_bind(before);
    }
    query.push(" ORDER BY id DESC LIMIT ").push_bind(filter.limit);
    query.build().fetch_all(&store.readers).await?.iter().map(rows::job).collect()
}

pub(super) async fn tally(store: &SqliteStore) -> Result<Vec<(Status, u64)>> {
    let rows = sqlx::query("SELECT status, jobs FROM tallies").fetch_all(&store.readers).await?;
    rows.iter().map(|row| Ok((rows::status(row)?, rows::unsigned(row.try_get("jobs")?)?))).collect()
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
    let mut transaction = store.writer.begin().await?;
    let deleted: Option<Option<Uuid>> = sqlx::query_scalar("DELETE FROM jobs WHERE id = ? RETURNING family")
        .bind(id)
        .fetch_optional(&mut *transaction)
        .await?;
    if let Some(Some(family)) = deleted {
        // The last of a family takes it along.
        sqlx::query("DELETE FROM families WHERE id = ?1 AND NOT EXISTS (SELECT 1 FROM jobs WHERE family = ?1)")
            .bind(family)
            .execute(&mut *transaction)
            .await?;
    }
    transaction.commit().await?;
    store.signals.job_changed(id);
    Ok(deleted.is_some())
}

pub(super) async fn retire(store: &SqliteStore, keep: Keep) -> Result<u64> {
    let ids: Vec<Uuid> = match keep {
        Keep::For(length) => {
            let length = i64::try_from(length.as_millis()).unwrap_or(i64::MAX);
            sqlx::query_scalar(
                "SELECT id FROM jobs WHERE ended_at < ?1 AND (family IS NULL OR explored = 1) ORDER BY ended_at LIMIT ?2",
            )
            .bind(now().saturating_sub(length))
        }
        Keep::Newest(count) => sqlx::query_scalar(
            "SELECT id FROM jobs WHERE ended_at IS NOT NULL AND (family IS NULL OR explored = 1) \
             ORDER BY ended_at DESC LIMIT ?2 OFFSET ?1",
        )
        .bind(signed(count)),
    }
    .bind(DROPPED_AT_ONCE)
    .fetch_all(&store.readers)
    .await?;
    let mut dropped = 0;
    for id in ids {
        dropped += u64::from(delete(store, id).await?);
    }
    Ok(dropped)
}
