//! Sweeps: many jobs queued in one transaction, and one that stands for all of them.
//!
//! Its lines are its runs as they end; triggers store them with the end of each, whoever brings that about.

use super::dialect::{Dialect, values};
use super::store::{Engine, Of, begin};
use super::{jobs, rows};
use crate::store::{NewSweep, Result, Submitted};
use uuid::Uuid;

/// Holds the sweep, under a lease that does not run out: the year 142,000 or so.
const HOLDER: &str = "its runs";
const FOR_EVER: i64 = 1 << 52;

pub(super) async fn submit<E: Engine>(engine: &E, sweep: NewSweep) -> Result<Submitted> {
    let mut transaction = begin(engine).await?;
    let mut whole = sweep.whole;
    // Either there is room for all of them, or none is queued.
    let most = whole.most_queued;
    whole.most_queued = most.saturating_sub(sweep.runs.len().saturating_sub(1) as u64);
    let submitted = jobs::insert::<Of<E>>(&mut transaction, &whole).await?;
    let Submitted::Created(record) = submitted else {
        transaction.rollback().await?;
        return Ok(match submitted {
            Submitted::QueueFull { .. } => Submitted::QueueFull { most },
            other => other,
        });
    };
    Of::<E>::run(
        &mut transaction,
        "UPDATE jobs SET status = 'running', worker = $2, lease_until = $3, started_at = {now} WHERE id = $1",
        values![record.id, HOLDER, FOR_EVER],
    )
    .await?;
    for (run, job) in (0_u64..).zip(&sweep.runs) {
        Of::<E>::run(
            &mut transaction,
            "INSERT INTO jobs (id, name, status, priority, request, plan, max_increments, max_attempts, created_at, updated_at, \
             task, owner, sweep, sweep_run, sweep_values) \
             VALUES ($1, $2, 'queued', $3, $4, $5, $6, $7, {now}, {now}, 'path', $8, $9, $10, $11)",
            values![
                Uuid::now_v7(),
                &whole.name,
                i64::from(whole.priority),
                &job.request,
                &job.plan,
                job.max_increments,
                whole.max_attempts,
                &whole.owner,
                record.id,
                run,
                &job.values,
            ],
        )
        .await?;
    }
    let record = jobs::record::<Of<E>>(&mut transaction, record.id).await?;
    transaction.commit().await?;
    Ok(Submitted::Created(record))
}

/// Marks a sweep and its runs, ends those that wait, and answers those at work. The runs come before the sweep, as where they end by themselves.
pub(super) async fn cancel<E: Engine>(engine: &E, id: Uuid) -> Result<Vec<Uuid>> {
    let mut transaction = begin(engine).await?;
    for statement in [
        "UPDATE jobs SET cancel_requested = 1, updated_at = {now} WHERE sweep = $1 AND status IN ('queued', 'running')",
        "UPDATE jobs SET cancel_requested = 1, updated_at = {now} WHERE id = $1 AND status = 'running'",
        "UPDATE jobs SET status = 'cancelled', stop_reason = 'cancelled', ended_at = {now} WHERE sweep = $1 AND status = 'queued'",
    ] {
        Of::<E>::run(&mut transaction, statement, values![id]).await?;
    }
    let select = "SELECT id FROM jobs WHERE sweep = $1 AND status = 'running' ORDER BY id";
    let at_work = Of::<E>::rows(&mut transaction, select, values![id]).await?;
    transaction.commit().await?;
    engine.signals().job_changed(id);
    at_work.iter().map(|row| rows::id(row, "id")).collect()
}
