//! Sweeps: many jobs queued in one transaction, and a record for the whole.
//!
//! The lines of a sweep are its ended runs; triggers store them with the end of each run, whatever caused the end.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Dialect, Runs, values};
use crate::service::store::sql::engine::{Engine, Of, begin, give_up, writer};
use crate::service::store::sql::turns::next_turn;
use crate::service::store::sql::{jobs, rows};
use crate::service::store::{NewSweep, Submitted};
use uuid::Uuid;

/// The holder of every sweep, under a lease that does not expire before the year 142,000 or so.
const HOLDER: &str = "its runs";
const FOR_EVER: i64 = 1 << 52;
/// The most runs that a statement ends: each end changes the row of the sweep, whose versions accumulate until the commit.
const ENDED_AT_ONCE: u32 = 500;

pub(super) async fn submit<E: Engine>(engine: &E, sweep: NewSweep) -> Result<Submitted> {
    let mut transaction = begin(engine).await?;
    // Two concurrent submissions would both find room.
    if let Some(in_turn) = <Of<E> as Dialect>::IN_TURN {
        Of::<E>::run(&mut transaction, in_turn, values![]).await?;
    }
    let mut whole = sweep.whole;
    // All runs are queued, or none.
    let most = whole.most_queued;
    whole.most_queued = most.saturating_sub(sweep.runs.len().saturating_sub(1) as u64);
    let submitted = jobs::insert::<Of<E>>(&mut transaction, &whole).await?;
    let Submitted::Created(record) = submitted else {
        give_up(transaction).await;
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
    let turn = concat!("SELECT ", next_turn!("$1", "$2"), " AS turn");
    let turn = Of::<E>::first(&mut transaction, turn, values![i64::from(whole.priority), &whole.owner]).await?;
    let runs = Runs {
        turn: rows::number(&turn.ok_or(sqlx::Error::RowNotFound)?, "turn")?,
        sweep: record.id,
        priority: whole.priority.into(),
        max_attempts: whole.max_attempts.into(),
        owner: whole.owner.as_deref(),
        runs: &sweep.runs,
    };
    Of::<E>::insert_runs(&mut transaction, &runs).await?;
    let record = jobs::record::<Of<E>>(&mut transaction, record.id).await?;
    transaction.commit().await?;
    Ok(Submitted::Created(record))
}

/// Marks a sweep and its runs as cancelled, and answers the running ones. The runs are locked before the sweep, as at their end.
pub(super) async fn mark_cancelled<E: Engine>(engine: &E, id: Uuid) -> Result<Vec<Uuid>> {
    let mut transaction = begin(engine).await?;
    for statement in [
        "UPDATE jobs SET cancel_requested = 1, updated_at = {now} WHERE sweep = $1 AND status IN ('queued', 'running')",
        "UPDATE jobs SET cancel_requested = 1, updated_at = {now} WHERE id = $1 AND status = 'running'",
    ] {
        Of::<E>::run(&mut transaction, statement, values![id]).await?;
    }
    let select = "SELECT id FROM jobs WHERE sweep = $1 AND status = 'running' ORDER BY id";
    let at_work = Of::<E>::rows(&mut transaction, select, values![id]).await?;
    transaction.commit().await?;
    engine.signals().job_changed(id);
    at_work.iter().map(|row| rows::id(row, "id")).collect()
}

/// Ends some of the waiting runs past the given one, and answers the last of them. Locked runs have just been claimed, and end
/// like running ones.
pub(super) async fn end_some<E: Engine>(engine: &E, id: Uuid, after: Uuid) -> Result<Option<Uuid>> {
    let end = "UPDATE jobs SET status = 'cancelled', stop_reason = 'cancelled', ended_at = {now} WHERE id IN \
               (SELECT id FROM jobs WHERE sweep = $1 AND id > $2 AND status = 'queued' AND cancel_requested <> 0 \
               ORDER BY id LIMIT $3 {free}) RETURNING id";
    let ended = Of::<E>::rows(&mut *writer(engine).await?, end, values![id, after, ENDED_AT_ONCE]).await?;
    engine.signals().job_changed(id);
    ended.iter().map(|row| rows::id(row, "id")).try_fold(None, |last, id| Ok(last.max(Some(id?))))
}
