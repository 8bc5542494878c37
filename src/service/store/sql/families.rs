//! Explorations: jobs for the directions that the paths of a family did not take.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Dialect, values};
use crate::service::store::sql::engine::{Engine, Of, begin, give_up, reader};
use crate::service::store::sql::followers::{self, Place};
use crate::service::store::sql::rows;
use crate::service::store::{NewFollower, Parent, Status};
use uuid::Uuid;

pub(super) async fn explore<E: Engine>(engine: &E) -> Result<u64> {
    let families = Of::<E>::rows(
        &mut *reader(engine).await?,
        "SELECT DISTINCT family FROM jobs WHERE family IS NOT NULL AND explored = 0 \
         AND status NOT IN ('queued', 'running') ORDER BY family",
        values![],
    )
    .await?;
    let mut queued = 0;
    for family in families {
        let family = rows::id(&family, "family")?;
        while let Some(more) = explore_next(engine, family).await? {
            queued += more;
        }
    }
    if queued > 0 {
        engine.signals().queue_changed();
    }
    Ok(queued)
}

/// Queues the alternatives of the first job of a family that has not been processed, and answers their number; `None` if this job
/// has not ended or there is none. Atomic, so that a crash neither loses nor repeats a job.
async fn explore_next<E: Engine>(engine: &E, family: Uuid) -> Result<Option<u64>> {
    let mut transaction = begin(engine).await?;
    // A write first, which waits for the writes of other processes; after a read the write would fail instead.
    let limits = Of::<E>::first(
        &mut transaction,
        "UPDATE families SET queued = queued WHERE id = $1 RETURNING depth, max_jobs, queued",
        values![family],
    )
    .await?;
    let next = Of::<E>::first(
        &mut transaction,
        "SELECT id, status, generation FROM jobs WHERE family = $1 AND explored = 0 ORDER BY family_number LIMIT 1 {there}",
        values![family],
    )
    .await?;
    let ended = match (limits, next) {
        (Some(limits), Some(next)) => {
            Some((rows::status(&next)?, limits, next)).filter(|(status, ..)| status.is_ended())
        }
        _ => None,
    };
    let Some((status, limits, next)) = ended else {
        // A transaction that is only dropped ends later, and a claim passes over the job that it has locked.
        give_up(transaction).await;
        return Ok(None);
    };
    let (job, generation) = (rows::id(&next, "id")?, rows::number(&next, "generation")?);
    let before = rows::number(&limits, "queued")?;
    let room = if generation < rows::number(&limits, "depth")? { rows::number(&limits, "max_jobs")? } else { before };
    let (mut queued, mut not_queued) = (before, 0_u64);
    // The alternatives of cancelled and failed jobs are not followed.
    if matches!(status, Status::Completed | Status::Stopped) {
        for (increment, direction) in alternatives::<Of<E>>(&mut transaction, job).await? {
            if queued >= room {
                not_queued += 1;
                continue;
            }
            let parent = Parent { job, increment, direction };
            // Families have their own bound on the number of jobs.
            let follower =
                NewFollower { parent, owner: None, max_increments: None, idempotency_key: None, most_queued: u64::MAX };
            let place = Place { family, number: queued + 1, generation: generation + 1 };
            followers::insert::<Of<E>>(&mut transaction, &follower, Some(place)).await?;
            queued += 1;
        }
    }
    let explored = "UPDATE jobs SET explored = 1, not_queued = $2 WHERE id = $1";
    Of::<E>::run(&mut transaction, explored, values![job, not_queued]).await?;
    Of::<E>::run(&mut transaction, "UPDATE families SET queued = $2 WHERE id = $1", values![family, queued]).await?;
    transaction.commit().await?;
    engine.signals().job_changed(job);
    Ok(Some(queued - before))
}

/// `(increment, direction)` in the order of the path.
async fn alternatives<D: Dialect>(connection: &mut D::Connection, job: Uuid) -> Result<Vec<(u64, u64)>> {
    let rows = D::rows(
        connection,
        "SELECT increment_index, alternatives FROM branches WHERE job = $1 AND alternatives IS NOT NULL \
         ORDER BY increment_index",
        values![job],
    )
    .await?;
    let mut found = Vec::new();
    for row in rows {
        let increment = rows::number(&row, "increment_index")?;
        let directions: Vec<u64> = serde_json::from_str(&rows::text(&row, "alternatives")?)
            .map_err(|error| rows::damaged(format!("alternatives of job {job} at {increment}: {error}")))?;
        found.extend(directions.into_iter().map(|direction| (increment, direction)));
    }
    Ok(found)
}
