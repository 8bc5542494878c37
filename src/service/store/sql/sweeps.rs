//! Sweeps: many jobs queued in one transaction, and a record for the whole.
//!
//! The lines of a sweep are its ended runs; triggers store them with the end of each run, whatever caused the end.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Cells, Dialect, Runs, values};
use crate::service::store::sql::engine::{Engine, Of, begin, give_up, reader, writer};
use crate::service::store::sql::turns::next_turn;
use crate::service::store::sql::{jobs, rows};
use crate::service::store::{NewSweep, Submitted, SweepRefinement};
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
        "UPDATE jobs SET status = 'running', worker = $2, lease_until = $3, refine = $4, started_at = {now} WHERE id = $1",
        values![record.id, HOLDER, FOR_EVER, sweep.refine],
    )
    .await?;
    let priority = i64::from(whole.priority);
    let runs = Runs {
        turn: turn::<Of<E>>(&mut transaction, priority, whole.owner.as_deref()).await?,
        sweep: record.id,
        first: 0,
        priority,
        max_attempts: whole.max_attempts.into(),
        owner: whole.owner.as_deref(),
        runs: &sweep.runs,
    };
    Of::<E>::insert_runs(&mut transaction, &runs).await?;
    let record = jobs::record::<Of<E>>(&mut transaction, record.id).await?;
    transaction.commit().await?;
    Ok(Submitted::Created(record))
}

/// The number in the queue of the next run.
async fn turn<D: Dialect>(connection: &mut D::Connection, priority: i64, owner: Option<&str>) -> Result<u64> {
    let turn = concat!("SELECT ", next_turn!("$1", "$2"), " AS turn");
    let turn = D::first(connection, turn, values![priority, owner]).await?;
    rows::number(&turn.ok_or(sqlx::Error::RowNotFound)?, "turn")
}

pub(super) async fn refinable<E: Engine>(engine: &E) -> Result<Vec<Uuid>> {
    let select = "SELECT id FROM jobs WHERE refine > 0 AND status = 'running' AND cancel_requested = 0 \
                  AND last_index + 1 >= max_increments ORDER BY id LIMIT 10";
    let found = Of::<E>::rows(&mut *reader(engine).await?, select, values![]).await?;
    found.iter().map(|row| rows::id(row, "id")).collect()
}

/// Of several processes that refine a sweep at once the first one does; the others find that it has more runs.
pub(super) async fn refine<E: Engine>(engine: &E, refinement: SweepRefinement) -> Result<bool> {
    let SweepRefinement { sweep, before, plan, summary, runs } = refinement;
    let mut transaction = begin(engine).await?;
    if let Some(in_turn) = <Of<E> as Dialect>::IN_TURN {
        Of::<E>::run(&mut transaction, in_turn, values![]).await?;
    }
    let more = runs.len() as u64;
    let taken = Of::<E>::first(
        &mut transaction,
        "UPDATE jobs SET max_increments = max_increments + CAST($3 AS BIGINT), plan = $4, summary = coalesce($5, summary), updated_at = {now}, \
         refine = CASE WHEN CAST($3 AS BIGINT) = 0 THEN 0 ELSE refine - CAST($3 AS BIGINT) END \
         WHERE id = $1 AND refine > 0 AND status = 'running' AND cancel_requested = 0 AND max_increments = $2 \
         AND last_index + 1 >= max_increments RETURNING priority, owner, max_attempts",
        values![sweep, before, more, &plan, &summary],
    )
    .await?;
    let Some(whole) = taken else {
        give_up(transaction).await;
        return Ok(false);
    };
    if runs.is_empty() {
        let end =
            "UPDATE jobs SET status = 'completed', ended_at = {now}, worker = NULL, lease_until = NULL WHERE id = $1";
        Of::<E>::run(&mut transaction, end, values![sweep]).await?;
    } else {
        let (priority, owner) = (rows::signed(&whole, "priority")?, whole.text("owner")?);
        let runs = Runs {
            turn: turn::<Of<E>>(&mut transaction, priority, owner.as_deref()).await?,
            sweep,
            first: before,
            priority,
            max_attempts: rows::signed(&whole, "max_attempts")?,
            owner: owner.as_deref(),
            runs: &runs,
        };
        Of::<E>::insert_runs(&mut transaction, &runs).await?;
    }
    transaction.commit().await?;
    engine.signals().job_changed(sweep);
    engine.signals().queue_changed();
    Ok(true)
}

/// Marks a sweep and its runs as cancelled, and answers the running ones. The runs are locked before the sweep, as at their end.
pub(super) async fn mark_cancelled<E: Engine>(engine: &E, id: Uuid) -> Result<Vec<Uuid>> {
    let mut transaction = begin(engine).await?;
    for statement in [
        "UPDATE jobs SET cancel_requested = 1, updated_at = {now} WHERE sweep = $1 AND status IN ('queued', 'running')",
        // A sweep whose runs have all ended waits for further ones, of which there will be none.
        "UPDATE jobs SET cancel_requested = 1, refine = 0, updated_at = {now}, \
         status = CASE WHEN last_index + 1 >= max_increments THEN 'cancelled' ELSE status END, \
         stop_reason = CASE WHEN last_index + 1 >= max_increments THEN 'cancelled' ELSE stop_reason END, \
         ended_at = CASE WHEN last_index + 1 >= max_increments THEN {now} ELSE ended_at END, \
         worker = CASE WHEN last_index + 1 >= max_increments THEN NULL ELSE worker END, \
         lease_until = CASE WHEN last_index + 1 >= max_increments THEN NULL ELSE lease_until END \
         WHERE id = $1 AND status = 'running'",
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
