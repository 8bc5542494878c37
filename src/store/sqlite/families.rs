//! Explorations: jobs queued for the directions that a family's jobs did not take.

use super::SqliteStore;
use super::followers::{self, Place};
use super::rows::unsigned;
use crate::store::{NewFollower, Parent, Result, Status};
use sqlx::types::Json;
use sqlx::{Row, Sqlite, Transaction};
use uuid::Uuid;

pub(super) async fn explore(store: &SqliteStore) -> Result<u64> {
    let families: Vec<Uuid> = sqlx::query_scalar(
        "SELECT DISTINCT family FROM jobs WHERE family IS NOT NULL AND explored = 0 \
         AND status NOT IN ('queued', 'running') ORDER BY family",
    )
    .fetch_all(&store.readers)
    .await?;
    let mut queued = 0;
    for family in families {
        while let Some(more) = explore_next(store, family).await? {
            queued += more;
        }
    }
    if queued > 0 {
        store.signals.queue_changed();
    }
    Ok(queued)
}

/// Looks at the first job of a family that has not been looked at; answers how many jobs that gave, or `None` where that
/// job has not ended or there is none. All or nothing, so that no end of the process queues a job twice or not at all.
async fn explore_next(store: &SqliteStore, family: Uuid) -> Result<Option<u64>> {
    let mut transaction = store.writer.begin().await?;
    // A write first: it waits for other processes' writes, where a read would only fail the write after it.
    let limits = sqlx::query("UPDATE families SET queued = queued WHERE id = ? RETURNING depth, max_jobs, queued")
        .bind(family)
        .fetch_optional(&mut *transaction)
        .await?;
    let next = sqlx::query(
        "SELECT id, status, generation FROM jobs WHERE family = ? AND explored = 0 ORDER BY family_number LIMIT 1",
    )
    .bind(family)
    .fetch_optional(&mut *transaction)
    .await?;
    let (Some(limits), Some(next)) = (limits, next) else { return Ok(None) };
    let status: String = next.try_get("status")?;
    let Some(status) = Status::from_name(&status).filter(|status| status.is_ended()) else { return Ok(None) };
    let (job, generation): (Uuid, i64) = (next.try_get("id")?, next.try_get("generation")?);
    let before: i64 = limits.try_get("queued")?;
    let room = if generation < limits.try_get("depth")? { limits.try_get("max_jobs")? } else { before };
    let (mut queued, mut not_queued) = (before, 0_i64);
    // What somebody has cancelled, and what failed, is not taken further.
    if matches!(status, Status::Completed | Status::Stopped) {
        for (increment, direction) in alternatives(&mut transaction, job).await? {
            if queued >= room {
                not_queued += 1;
                continue;
            }
            let parent = Parent { job, increment, direction };
            // Families have a bound of their own.
            let follower =
                NewFollower { parent, owner: None, max_increments: None, idempotency_key: None, most_queued: u64::MAX };
            let place = Place { family, number: queued + 1, generation: generation + 1 };
            followers::insert(&mut transaction, &follower, Some(place)).await?;
            queued += 1;
        }
    }
    sqlx::query("UPDATE jobs SET explored = 1, not_queued = ?2 WHERE id = ?1")
        .bind(job)
        .bind(not_queued)
        .execute(&mut *transaction)
        .await?;
    sqlx::query("UPDATE families SET queued = ?2 WHERE id = ?1")
        .bind(family)
        .bind(queued)
        .execute(&mut *transaction)
        .await?;
    transaction.commit().await?;
    store.signals.job_changed(job);
    unsigned(queued - before).map(Some)
}

/// `(increment, direction)` in the order of the path.
async fn alternatives(transaction: &mut Transaction<'_, Sqlite>, job: Uuid) -> Result<Vec<(u64, u64)>> {
    let rows = sqlx::query(
        "SELECT increment_index, alternatives FROM branches WHERE job = ? AND alternatives IS NOT NULL \
         ORDER BY increment_index",
    )
    .bind(job)
    .fetch_all(&mut **transaction)
    .await?;
    let mut found = Vec::new();
    for row in rows {
        let increment = unsigned(row.try_get("increment_index")?)?;
        let Json(directions): Json<Vec<u64>> = row.try_get("alternatives")?;
        found.extend(directions.into_iter().map(|direction| (increment, direction)));
    }
    Ok(found)
}
