//! The queue: claims of jobs by workers.
//!
//! If a process crashes, all jobs that it ran are lost, and the job that caused the crash is not known. A job with a loss
//! after which it has stored nothing is therefore a suspect, and only one suspect runs at a time, beside jobs without losses.
//! A job that crashes every process is then the only suspect at each of its attempts, and a job that was lost with it once is
//! not lost with it again. A job fails after a number of counted losses: those as a suspect, and those in which it was the
//! only job lost. A host that goes down loses several jobs at once, which counts for none of them.

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Cells, Dialect, Value, values};
use crate::service::store::sql::engine::{Engine, Of, writer};
use crate::service::store::sql::leases::{is_repeated, milliseconds, ran, tell_sweep};
use crate::service::store::sql::{followers, increments, rows};
use crate::service::store::{Claim, Lease, StoreError};
use std::time::Duration;

/// The assignments of a claim. If a crash of the database reverts a claim, the job is still queued, and writes under the claim
/// are refused.
macro_rules! claimed {
    () => {
        " RETURNING id, task, attempt, request, max_increments, last_index, parent, parent_increment, parent_direction, \
         family, ran_ms, stored_bytes, asked, CASE WHEN started_at > created_at THEN started_at - created_at ELSE 0 END AS waited, \
         CAST(CASE WHEN started_at = {now} THEN 1 ELSE 0 END AS BIGINT) AS is_first \
         {unsynced}"
    };
}

/// Claims the next job: `$1` worker, `$2` milliseconds. The statement only reads the front of the queue, however long it is.
pub(crate) const TAKE: &str = concat!(
    "UPDATE jobs SET status = 'running', worker = $1, lease_until = {now} + $2, attempt = attempt + 1, \
     accompanied = 0, started_at = coalesce(started_at, {now}), updated_at = {now} \
     WHERE id = (SELECT id FROM jobs {waiting} WHERE status = 'queued' AND (losses = 0 OR NOT EXISTS \
     (SELECT 1 FROM jobs AS suspect WHERE suspect.status = 'running' AND suspect.losses > 0)) \
     ORDER BY priority DESC, turn, id LIMIT 1 {free})",
    claimed!()
);

/// Claims again the job that the worker already has: `$1` worker, `$2` milliseconds.
const TAKE_AGAIN: &str = concat!(
    "UPDATE jobs SET lease_until = {now} + $2, ",
    ran!(),
    " WHERE id = (SELECT id FROM jobs WHERE status = 'running' AND worker = $1 AND lease_until >= {clock} LIMIT 1)",
    claimed!()
);

/// How often a claim is repeated if another worker claims a suspect at the same time.
const TRIES: usize = 4;

/// Claims a job. `again`: an earlier claim of this worker had no answer and may have been carried out.
pub(super) async fn claim<E: Engine>(engine: &E, worker: &str, lease: Duration, again: bool) -> Result<Option<Claim>> {
    let mut connection = writer(engine).await?;
    let values = [Value::from(worker), milliseconds(lease)];
    let mut row = if again { Of::<E>::first(&mut connection, TAKE_AGAIN, &values).await? } else { None };
    for more in (0..TRIES).rev() {
        if row.is_some() {
            break;
        }
        row = match Of::<E>::first(&mut connection, TAKE, &values).await {
            Ok(None) => return Ok(None),
            Ok(found) => found,
            Err(error) if more > 0 && is_repeated(&error) => None,
            Err(error) => return Err(error.into()),
        };
    }
    let Some(row) = row else { return Ok(None) };
    let job = rows::id(&row, "id")?;
    let origin = match rows::parent(&row)? {
        Some(parent) => Some((parent, followers::origin::<Of<E>>(&mut connection, job).await?)),
        None => None,
    };
    let is_first = rows::flag(&row, "is_first")?;
    // A branch is stored beside an increment; a checkpoint may be there before the first.
    let (last, last_branch) = match rows::last_index(&row)? {
        Some(index) => (
            Some(increments::stored::<Of<E>>(&mut connection, job, index).await?),
            increments::last_branch::<Of<E>>(&mut connection, job).await?,
        ),
        None => (None, None),
    };
    let checkpoint = if is_first { None } else { increments::checkpoint::<Of<E>>(&mut connection, job).await? };
    let claim = Claim {
        lease: Lease { job, worker: worker.to_owned(), attempt: rows::count(&row, "attempt")? },
        task: rows::task(&row)?,
        request: rows::text(&row, "request")?,
        max_increments: rows::number(&row, "max_increments")?,
        asked: row.text("asked")?,
        last,
        last_branch,
        checkpoint,
        origin,
        explores: row.id("family")?.is_some(),
        waited: if is_first { Some(rows::milliseconds(&row, "waited")?) } else { None },
        ran: rows::milliseconds(&row, "ran_ms")?,
        stored_bytes: rows::number(&row, "stored_bytes")?,
    };
    engine.signals().job_claimed(&claim.lease, claim.last.as_ref().map(|line| line.index));
    Ok(Some(claim))
}

/// The process of a worker: the first 36 characters of its name.
macro_rules! process {
    ($worker:literal) => {
        concat!("substr(", $worker, ", 1, 36)")
    };
}

/// Whether another job of the same process is lost or running.
macro_rules! has_company {
    () => {
        concat!(
            "EXISTS (SELECT 1 FROM jobs AS other \
             WHERE other.status = 'running' AND other.id <> jobs.id AND (other.lease_until < {clock} OR ",
            process!("other.worker"),
            " = ",
            process!("jobs.worker"),
            "))"
        )
    };
}

/// 1 if the loss counts, otherwise 0.
macro_rules! counts {
    () => {
        concat!("CASE WHEN losses > 0 OR (accompanied = 0 AND NOT ", has_company!(), ") THEN 1 ELSE 0 END")
    };
}

const RECLAIM: &str = concat!(
    "UPDATE jobs SET losses = losses + 1, counted_losses = counted_losses + ",
    counts!(),
    ", status = CASE WHEN cancel_requested <> 0 THEN 'cancelled' WHEN counted_losses + ",
    counts!(),
    " < max_attempts THEN 'queued' ELSE 'failed' END, stop_reason = CASE WHEN cancel_requested <> 0 THEN 'cancelled' END, \
     error = CASE WHEN cancel_requested = 0 AND counted_losses + ",
    counts!(),
    " >= max_attempts THEN 'the worker was lost ' || (losses + 1) || ' times in a row, ' || max_attempts || ' of them with no other job, nothing stored between: its process \
ended (killed, out of memory, or a defect) or did not renew its lease in time (see --lease); what is stored stands, and a retry goes on from there' END, \
     ended_at = CASE WHEN cancel_requested <> 0 OR counted_losses + ",
    counts!(),
    " >= max_attempts THEN {now} END, worker = NULL, lease_until = NULL, updated_at = {now} \
     WHERE id IN (SELECT id FROM jobs WHERE status = 'running' AND lease_until < {clock} {free}) RETURNING id, sweep"
);

pub(super) async fn reclaim_expired<E: Engine>(engine: &E) -> Result<u64> {
    let mut connection = writer(engine).await?;
    // The leases of a process do not expire at the same moment: the remaining jobs are marked as lost together with others.
    let tell = concat!(
        "UPDATE jobs SET accompanied = 1 WHERE status = 'running' AND lease_until >= {clock} AND accompanied = 0 AND ",
        process!("worker"),
        " IN (SELECT ",
        process!("worker"),
        " FROM jobs WHERE status = 'running' AND lease_until < {clock})"
    );
    Of::<E>::run(&mut connection, tell, values![]).await?;
    // Jobs that are lost together are marked before any of them is reclaimed, as SQLite updates one row after another.
    let together = concat!(
        "UPDATE jobs SET accompanied = 1 WHERE status = 'running' AND lease_until < {clock} AND accompanied = 0 AND ",
        has_company!()
    );
    Of::<E>::run(&mut connection, together, values![]).await?;
    let touched = Of::<E>::rows(&mut connection, RECLAIM, values![]).await?;
    for row in &touched {
        engine.signals().job_changed(rows::id(row, "id")?);
        tell_sweep(engine, Some(row))?;
    }
    if !touched.is_empty() {
        engine.signals().queue_changed();
    }
    if let Some(sweep) = <Of<E> as Dialect>::SWEEP {
        Of::<E>::run(&mut connection, sweep, values![]).await?;
    }
    u64::try_from(touched.len()).map_err(|error| StoreError::Refused(Box::new(error)))
}
