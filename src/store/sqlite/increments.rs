//! Increments: appended in batches, read in order.

use super::rows::{signed, unsigned};
use super::{SqliteStore, after, claims, now};
use crate::store::{Lease, LeaseAnswer, Line, Page, Result};
use sqlx::types::Json;
use sqlx::{QueryBuilder, Row, Sqlite};
use std::time::Duration;
use tokio_stream::StreamExt;
use uuid::Uuid;

/// Rows of one INSERT: at most five values each, far below SQLite's bound of 32,766 parameters.
const ROWS_A_STATEMENT: usize = 500;

pub(super) async fn append(
    store: &SqliteStore,
    lease: &Lease,
    lines: &[Line],
    duration: Duration,
) -> Result<LeaseAnswer> {
    let Some(last) = lines.last() else { return claims::renew(store, lease, duration).await };
    let mut transaction = store.writer.begin().await?;
    let row = sqlx::query(
        "UPDATE jobs SET last_index = ?4, lease_until = ?5, updated_at = ?6 \
         WHERE id = ?1 AND worker = ?2 AND attempt = ?3 AND status = 'running' RETURNING cancel_requested",
    )
    .bind(lease.job)
    .bind(&lease.worker)
    .bind(lease.attempt)
    .bind(signed(last.index))
    .bind(after(duration))
    .bind(now())
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
    transaction.commit().await?;
    store.signals.job_changed(lease.job);
    Ok(answer)
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
        lines.push(Line { index: unsigned(row.try_get("increment_index")?)?, body, branch: None });
        if bytes >= page.bytes {
            break;
        }
    }
    Ok(lines)
}
