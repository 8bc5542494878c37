//! Jobs that follow a direction of another, and what they begin from.

use super::jobs::waiting;
use super::rows::{self, job_columns, signed};
use super::{SqliteStore, jobs, now};
use crate::store::{NewFollower, Origin, Parent, Result, Submitted};
use sqlx::{Row, Sqlite, Transaction};
use uuid::Uuid;

/// A place in a family.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub family: Uuid,
    pub number: i64,
    pub generation: i64,
}

pub(super) async fn follow(store: &SqliteStore, job: NewFollower) -> Result<Option<Submitted>> {
    let mut transaction = store.writer.begin().await?;
    if let Some(id) = insert(&mut transaction, &job, None).await? {
        let record = jobs::record(&mut transaction, id).await?;
        transaction.commit().await?;
        store.signals.queue_changed();
        return Ok(Some(Submitted::Created(record)));
    }
    let known = sqlx::query(concat!("SELECT ", job_columns!(), " FROM jobs WHERE idempotency_key = ?"))
        .bind(jobs::owned_key(job.owner.as_deref(), job.idempotency_key.as_deref()))
        .fetch_optional(&mut *transaction)
        .await?;
    let full: bool = sqlx::query_scalar(concat!("SELECT ", waiting!(), " >= ?1"))
        .bind(signed(job.most_queued))
        .fetch_one(&mut *transaction)
        .await?;
    transaction.rollback().await?;
    let Some(known) = known else {
        return Ok(full.then_some(Submitted::QueueFull { most: job.most_queued }));
    };
    let record = rows::job(&known)?;
    let same_length = job.max_increments.is_none_or(|asked| asked == record.max_increments);
    let same = record.parent == Some(job.parent) && same_length;
    Ok(Some(if same { Submitted::Repeated(record) } else { Submitted::KeyReused }))
}

/// Queues a job that follows another; what it begins from is copied, so that it stands when the other is deleted.
/// `None`: the key is taken, there is no such branch, or there are enough jobs that wait.
pub(super) async fn insert(
    transaction: &mut Transaction<'_, Sqlite>,
    job: &NewFollower,
    place: Option<Place>,
) -> Result<Option<Uuid>> {
    let Parent { job: parent, increment, direction } = job.parent;
    let id = Uuid::now_v7();
    let inserted = sqlx::query(concat!(
        "INSERT INTO jobs (id, name, status, priority, request, idempotency_key, plan, max_increments, max_attempts, \
         created_at, updated_at, parent, parent_increment, parent_direction, family, family_number, generation, owner) \
         SELECT ?2, name, 'queued', priority, request, ?3, plan, coalesce(?4, max_increments), max_attempts, \
         ?5, ?5, id, ?6, ?7, ?8, ?9, ?10, coalesce(?12, owner) \
         FROM jobs WHERE id = ?11 AND EXISTS (SELECT 1 FROM branches WHERE job = ?11 AND increment_index <= ?6) AND ",
        waiting!(),
        " < ?1 ON CONFLICT (idempotency_key) DO NOTHING",
    ))
    .bind(signed(job.most_queued))
    .bind(id)
    .bind(jobs::owned_key(job.owner.as_deref(), job.idempotency_key.as_deref()))
    .bind(job.max_increments.map(signed))
    .bind(now())
    .bind(signed(increment))
    .bind(signed(direction))
    .bind(place.map(|place| place.family))
    .bind(place.map_or(0, |place| place.number))
    .bind(place.map_or(0, |place| place.generation))
    .bind(parent)
    .bind(&job.owner)
    .execute(&mut **transaction)
    .await?;
    if inserted.rows_affected() == 0 {
        return Ok(None);
    }
    sqlx::query(
        "INSERT INTO origins (job, body, trail) SELECT ?1, body, (SELECT group_concat(trail, char(10)) FROM \
         (SELECT trail FROM branches WHERE job = ?2 AND increment_index <= ?3 ORDER BY increment_index)) \
         FROM branches WHERE job = ?2 AND increment_index <= ?3 ORDER BY increment_index DESC LIMIT 1",
    )
    .bind(id)
    .bind(parent)
    .bind(signed(increment))
    .execute(&mut **transaction)
    .await?;
    Ok(Some(id))
}

pub(super) async fn request(store: &SqliteStore, id: Uuid) -> Result<Option<String>> {
    Ok(sqlx::query_scalar("SELECT request FROM jobs WHERE id = ?").bind(id).fetch_optional(&store.readers).await?)
}

pub(super) async fn branch(store: &SqliteStore, id: Uuid, increment: u64) -> Result<Option<Origin>> {
    let row = sqlx::query(
        "SELECT body, (SELECT group_concat(trail, char(10)) FROM \
         (SELECT trail FROM branches WHERE job = ?1 AND increment_index <= ?2 ORDER BY increment_index)) AS trail \
         FROM branches WHERE job = ?1 AND increment_index <= ?2 ORDER BY increment_index DESC LIMIT 1",
    )
    .bind(id)
    .bind(signed(increment))
    .fetch_optional(&store.readers)
    .await?;
    row.map(|row| read(&row)).transpose()
}

pub(super) async fn origin(store: &SqliteStore, id: Uuid) -> Result<Origin> {
    let row =
        sqlx::query("SELECT body, trail FROM origins WHERE job = ?").bind(id).fetch_optional(&store.writer).await?;
    let row = row.ok_or_else(|| rows::damaged(format!("job {id} follows another, and where it begins is missing")))?;
    read(&row)
}

/// Of a row with the columns `body` and `trail`.
pub(super) fn read(row: &sqlx::sqlite::SqliteRow) -> Result<Origin> {
    let trail: Option<String> = row.try_get("trail")?;
    Ok(Origin { body: row.try_get("body")?, trail: trail.unwrap_or_default() })
}
