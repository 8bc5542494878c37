//! Increments: appended in batches with what is stored beside them, read in order.

use super::claims::{self, held, ran};
use super::followers;
use super::rows::{self, signed, unsigned};
use super::{SqliteStore, after, now};
use crate::store::{Batch, Checkpoint, Lease, LeaseAnswer, Line, Origin, Page, Result};
use sqlx::types::Json;
use sqlx::{QueryBuilder, Row, Sqlite, Transaction};
use std::time::Duration;
use tokio_stream::StreamExt;
use uuid::Uuid;

/// Rows of one INSERT: at most five values each, far below SQLite's bound of 32,766 parameters.
const ROWS_A_STATEMENT: usize = 500;

pub(super) async fn append(
    store: &SqliteStore,
    lease: &Lease,
    batch: &Batch,
    duration: Duration,
) -> Result<LeaseAnswer> {
    if batch.is_empty() {
        return claims::renew(store, lease, duration).await;
    }
    let lines = batch.lines.as_slice();
    let mut transaction = store.writer.begin().await?;
    let row = sqlx::query(concat!(
        "UPDATE jobs SET last_index = coalesce(?5, last_index), lease_until = ?6, losses = 0, stored_bytes = stored_bytes + ?7, ",
        ran!(),
        held!(),
        "RETURNING cancel_requested"
    ))
    .bind(lease.job)
    .bind(&lease.worker)
    .bind(lease.attempt)
    .bind(now())
    .bind(lines.last().map(|line| signed(line.index)))
    .bind(after(duration))
    .bind(signed(lines.iter().map(Line::bytes).sum()))
    .fetch_optional(&mut *transaction)
    .await?;
    let answer = claims::answer(row)?;
    if answer == LeaseAnswer::Lost {
        transaction.rollback().await?;
        return Ok(answer);
    }
    for batch in lines.chunks(ROWS_A_STATEMENT) {
        let mut insert = QueryBuilder::<Sqlite>::new("INSERT INTO increments (job, increment_index, body) ");
        insert.push_values(batch, |mut row, line| {
            row.push_bind(lease.job).push_bind(signed(line.index)).push_bind(line.body.as_str());
        });
        insert.build().execute(&mut *transaction).await?;
        let branches: Vec<_> = batch.iter().filter_map(|line| Some((line.index, line.branch.as_ref()?))).collect();
        if branches.is_empty() {
            continue;
        }
        let mut insert =
            QueryBuilder::<Sqlite>::new("INSERT INTO branches (job, increment_index, body, trail, alternatives) ");
        insert.push_values(branches, |mut row, (index, branch)| {
            let alternatives = (!branch.alternatives.is_empty()).then_some(Json(branch.alternatives.as_slice()));
            row.push_bind(lease.job).push_bind(signed(index)).push_bind(branch.body.as_str());
            row.push_bind(branch.trail.as_deref()).push_bind(alternatives);
        });
        insert.build().execute(&mut *transaction).await?;
    }
    put_checkpoint(&mut transaction, lease.job, &batch.checkpoints).await?;
    transaction.commit().await?;
    if !lines.is_empty() {
        store.signals.job_appended(lease, lines);
    }
    Ok(answer)
}

/// The newest checkpoint takes the place of the one before; trails are of all of them.
async fn put_checkpoint(
    transaction: &mut Transaction<'_, Sqlite>,
    job: Uuid,
    checkpoints: &[Checkpoint],
) -> Result<()> {
    for checkpoint in checkpoints {
        if checkpoint.begins_trail {
            sqlx::query("DELETE FROM checkpoint_trails WHERE job = ?").bind(job).execute(&mut **transaction).await?;
        }
        if let Some(trail) = &checkpoint.trail {
            sqlx::query("INSERT INTO checkpoint_trails (job, increment_index, trail) VALUES (?1, ?2, ?3)")
                .bind(job)
                .bind(signed(checkpoint.index))
                .bind(trail)
                .execute(&mut **transaction)
                .await?;
        }
    }
    if let Some(newest) = checkpoints.last() {
        sqlx::query(
            "INSERT INTO checkpoints (job, increment_index, body) VALUES (?1, ?2, ?3) ON CONFLICT (job) \
             DO UPDATE SET increment_index = excluded.increment_index, body = excluded.body",
        )
        .bind(job)
        .bind(signed(newest.index))
        .bind(&newest.body)
        .execute(&mut **transaction)
        .await?;
    }
    Ok(())
}

/// The newest checkpoint of a job that has not ended.
pub(super) async fn checkpoint(store: &SqliteStore, job: Uuid) -> Result<Option<Origin>> {
    let row = sqlx::query(
        "SELECT body, (SELECT group_concat(trail, char(10)) FROM \
         (SELECT trail FROM checkpoint_trails WHERE job = ?1 ORDER BY increment_index)) AS trail \
         FROM checkpoints WHERE job = ?1",
    )
    .bind(job)
    .fetch_optional(&store.writer)
    .await?;
    row.map(|row| followers::read(&row)).transpose()
}

/// The body of a job's last branch.
pub(super) async fn last_branch(store: &SqliteStore, job: Uuid) -> Result<Option<String>> {
    let body = sqlx::query_scalar("SELECT body FROM branches WHERE job = ? ORDER BY increment_index DESC LIMIT 1");
    Ok(body.bind(job).fetch_optional(&store.writer).await?)
}

/// An increment that is there.
pub(super) async fn stored(store: &SqliteStore, job: Uuid, index: u64) -> Result<Line> {
    let body: Option<String> =
        sqlx::query_scalar("SELECT body FROM increments WHERE job = ?1 AND increment_index = ?2")
            .bind(job)
            .bind(signed(index))
            .fetch_optional(&store.writer)
            .await?;
    let body = body.ok_or_else(|| rows::damaged(format!("increment {index} of job {job} is missing")))?;
    Ok(Line { index, body, branch: None })
}

pub(super) async fn read(store: &SqliteStore, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>> {
    let mut rows = sqlx::query(
        "SELECT increment_index, body FROM increments WHERE job = ?1 AND increment_index > ?2 \
         ORDER BY increment_index LIMIT ?3",
    )
    .bind(id)
    .bind(after.map_or(-1, signed))
    .bind(page.rows)
    .fetch(&store.readers);
    let mut lines = Vec::new();
    let mut bytes = 0;
    while let Some(row) = rows.next().await {
        let row = row?;
        let body: String = row.try_get("body")?;
        bytes += body.len();
        let index = unsigned(row.try_get("increment_index")?)?;
        lines.push(Line { index, body, branch: None });
        if bytes >= page.bytes {
            break;
        }
    }
    Ok(lines)
}
