//! Increments: appended in batches with their branches and checkpoints, and read in order.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Dialect, values};
use crate::service::store::sql::engine::{Engine, Of, begin, give_up, reader};
use crate::service::store::sql::leases::{self, held, milliseconds, ran};
use crate::service::store::sql::rows;
use crate::service::store::{Batch, Checkpoint, Ending, Lease, LeaseAnswer, Line, Origin, Page};
use std::time::Duration;
use tokio_stream::StreamExt;
use uuid::Uuid;

pub(super) async fn append<E: Engine>(
    engine: &E,
    lease: &Lease,
    batch: &Batch,
    duration: Duration,
) -> Result<LeaseAnswer> {
    if batch.is_empty() {
        return leases::renew(engine, lease, duration).await;
    }
    let lines = batch.lines.as_slice();
    let mut transaction = begin(engine).await?;
    let row = Of::<E>::first(
        &mut transaction,
        concat!(
            "UPDATE jobs SET last_index = coalesce($4, last_index), lease_until = {now} + $6, losses = 0, counted_losses = 0, \
             stored_bytes = stored_bytes + $5, first_limit = coalesce(first_limit, $7), ",
            ran!(),
            held!(),
            "RETURNING cancel_requested"
        ),
        values![
            lease.job,
            &lease.worker,
            lease.attempt,
            lines.last().map(|line| line.index),
            bytes(lines),
            milliseconds(duration),
            &batch.first_limit
        ],
    )
    .await?;
    let answer = leases::answer(row.as_ref())?;
    if answer == LeaseAnswer::Lost {
        give_up(transaction).await;
        return Ok(answer);
    }
    if let Err(error) = Of::<E>::insert_lines(&mut transaction, lease.job, lines).await {
        give_up(transaction).await;
        // The answer to an earlier call was lost, and the worker repeats the call.
        if leases::is_repeated(&error) && are_stored(engine, lease.job, lines).await? {
            engine.signals().job_changed(lease.job);
            return leases::renew(engine, lease, duration).await;
        }
        return Err(error.into());
    }
    put_checkpoint::<Of<E>>(&mut transaction, lease.job, &batch.checkpoints).await?;
    transaction.commit().await?;
    if lines.is_empty() {
        // The change is not visible to readers.
        return Ok(answer);
    }
    engine.signals().job_appended(lease, lines);
    Ok(answer)
}

/// Ends a job, with its last lines.
pub(super) async fn finish<E: Engine>(
    engine: &E,
    lease: &Lease,
    batch: &Batch,
    ending: &Ending,
) -> Result<LeaseAnswer> {
    let lines = batch.lines.as_slice();
    let mut transaction = begin(engine).await?;
    let row = Of::<E>::first(
        &mut transaction,
        concat!(
            "UPDATE jobs SET status = $4, stop_reason = $5, report = $6, error = $7, last_index = coalesce($8, last_index), \
             stored_bytes = stored_bytes + $9, first_limit = coalesce(first_limit, $10), responses = $11, worker = NULL, lease_until = NULL, \
             losses = 0, counted_losses = 0, ended_at = {now}, ",
            ran!(),
            held!(),
            "RETURNING cancel_requested, sweep"
        ),
        values![
            lease.job,
            &lease.worker,
            lease.attempt,
            ending.status.name(),
            &ending.stop_reason,
            &ending.report,
            &ending.error,
            lines.last().map(|line| line.index),
            bytes(lines),
            &batch.first_limit,
            &ending.responses,
        ],
    )
    .await?;
    if row.is_some() {
        Of::<E>::insert_lines(&mut transaction, lease.job, lines).await?;
        transaction.commit().await?;
        engine.signals().job_ended(lease, lines);
    }
    leases::tell_sweep(engine, row.as_ref())?;
    // If the job was a suspect, other suspects may have waited for its end.
    engine.signals().queue_changed();
    leases::answer(row.as_ref())
}

fn bytes(lines: &[Line]) -> u64 {
    lines.iter().map(Line::bytes).sum()
}

/// Whether the stored lines of a job end with exactly these lines.
async fn are_stored<E: Engine>(engine: &E, job: Uuid, lines: &[Line]) -> Result<bool> {
    let Some(first) = lines.first() else { return Ok(false) };
    let rows = u32::try_from(lines.len()).unwrap_or(u32::MAX).saturating_add(1);
    let stored = read(engine, job, first.index.checked_sub(1), Page { rows, bytes: usize::MAX }).await?;
    Ok(stored.len() == lines.len()
        && stored.iter().zip(lines).all(|(one, other)| one.index == other.index && one.body == other.body))
}

/// The newest checkpoint replaces the previous one; the trails of all are kept.
async fn put_checkpoint<D: Dialect>(
    connection: &mut D::Connection,
    job: Uuid,
    checkpoints: &[Checkpoint],
) -> Result<()> {
    for checkpoint in checkpoints {
        if checkpoint.begins_trail {
            D::run(connection, "DELETE FROM checkpoint_trails WHERE job = $1", values![job]).await?;
        }
        if let Some(trail) = &checkpoint.trail {
            let put = "INSERT INTO checkpoint_trails (job, increment_index, trail) VALUES ($1, $2, $3) \
                       ON CONFLICT (job, increment_index) DO UPDATE SET trail = excluded.trail";
            D::run(connection, put, values![job, checkpoint.index, trail]).await?;
        }
    }
    if let Some(newest) = checkpoints.last() {
        let put = "INSERT INTO checkpoints (job, increment_index, body) VALUES ($1, $2, $3) ON CONFLICT (job) \
                   DO UPDATE SET increment_index = excluded.increment_index, body = excluded.body";
        D::run(connection, put, values![job, newest.index, &newest.body]).await?;
    }
    Ok(())
}

/// The newest checkpoint of a job that has not ended.
pub(super) async fn checkpoint<D: Dialect>(connection: &mut D::Connection, job: Uuid) -> Result<Option<Origin>> {
    let select = "SELECT body, (SELECT string_agg(trail, $2 ORDER BY increment_index) FROM checkpoint_trails WHERE job = $1) \
                  AS trail FROM checkpoints WHERE job = $1";
    let row = D::first(connection, select, values![job, "\n"]).await?;
    row.map(|row| rows::origin(&row)).transpose()
}

/// The body of a job's last branch.
pub(super) async fn last_branch<D: Dialect>(connection: &mut D::Connection, job: Uuid) -> Result<Option<String>> {
    let select = "SELECT body FROM branches WHERE job = $1 ORDER BY increment_index DESC LIMIT 1";
    let row = D::first(connection, select, values![job]).await?;
    row.map(|row| rows::text(&row, "body")).transpose()
}

/// A stored increment.
pub(super) async fn stored<D: Dialect>(connection: &mut D::Connection, job: Uuid, index: u64) -> Result<Line> {
    let select = "SELECT body FROM increments WHERE job = $1 AND increment_index = $2";
    let row = D::first(connection, select, values![job, index]).await?;
    let row = row.ok_or_else(|| rows::damaged(format!("increment {index} of job {job} is missing")))?;
    Ok(Line { index, body: rows::text(&row, "body")?, branch: None })
}

pub(super) async fn read<E: Engine>(engine: &E, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>> {
    let after = after.map_or(-1, |after| i64::try_from(after).unwrap_or(i64::MAX));
    let mut connection = reader(engine).await?;
    let values = values![id, after, page.rows, page.bytes as u64];
    let mut stream = Of::<E>::stream(&mut connection, <Of<E> as Dialect>::PAGE, values);
    let mut lines = Vec::new();
    let mut bytes = 0;
    while let Some(row) = stream.next().await {
        let row = row?;
        let body = rows::text(&row, "body")?;
        bytes += body.len();
        lines.push(Line { index: rows::number(&row, "increment_index")?, body, branch: None });
        if bytes >= page.bytes {
            break;
        }
    }
    Ok(lines)
}
