//! Leases: the time for which a worker holds a job and may write to it.
//!
//! Every statement of a worker is conditional on job, worker, attempt, status `running` and the expiry of the lease: a worker
//! that returns late changes nothing, whether or not the job was claimed by another one meanwhile. The row of the job alone
//! determines who holds the lease, and a worker that was suspended for long never continues a job that counts as lost. (The
//! time is that of the database server, or of this machine for a file. If the clock jumps forward, a running job loses its
//! lease and is resumed from its last checkpoint.)

use crate::service::store::contract::error::Result;
use crate::service::store::sql::dialect::{Cells, Dialect, Value, values};
use crate::service::store::sql::engine::{Engine, Of, writer};
use crate::service::store::sql::rows;
use crate::service::store::{Lease, LeaseAnswer};
use std::time::Duration;

/// The lease is held: `$1` job, `$2` worker, `$3` attempt.
macro_rules! held {
    () => {
        " WHERE id = $1 AND worker = $2 AND attempt = $3 AND status = 'running' AND lease_until >= {clock} "
    };
}
pub(super) use held;

/// Adds the time since the last write to the running time. A clock that was set back subtracts nothing.
macro_rules! ran {
    () => {
        "ran_ms = ran_ms + CASE WHEN updated_at < {now} THEN {now} - updated_at ELSE 0 END, updated_at = {now}"
    };
}
pub(super) use ran;

/// Whether the row exists already: a unique constraint refused a second one.
pub(super) fn is_repeated(error: &sqlx::Error) -> bool {
    error.as_database_error().is_some_and(|error| error.is_unique_violation())
}

pub(super) fn milliseconds(duration: Duration) -> Value<'static> {
    // Bounded, so that the sum with the current time can be stored.
    const LONGEST: u64 = 1 << 52;
    Value::from(u64::try_from(duration.as_millis()).unwrap_or(LONGEST).min(LONGEST))
}

pub(super) async fn renew<E: Engine>(engine: &E, lease: &Lease, duration: Duration) -> Result<LeaseAnswer> {
    let update =
        concat!("UPDATE jobs SET lease_until = {now} + $4, ", ran!(), held!(), "RETURNING cancel_requested {unsynced}");
    let values = values![lease.job, &lease.worker, lease.attempt, milliseconds(duration)];
    answer(Of::<E>::first(&mut *writer(engine).await?, update, values).await?.as_ref())
}

pub(super) async fn release<E: Engine>(engine: &E, lease: &Lease) -> Result<LeaseAnswer> {
    // The attempt is not counted, as a regular shutdown is no loss. A cancelled job is not queued again.
    let row = Of::<E>::first(
        &mut *writer(engine).await?,
        concat!(
            "UPDATE jobs SET status = CASE cancel_requested WHEN 0 THEN 'queued' ELSE 'cancelled' END, \
             stop_reason = CASE cancel_requested WHEN 0 THEN NULL ELSE 'cancelled' END, \
             ended_at = CASE cancel_requested WHEN 0 THEN NULL ELSE {now} END, \
             attempt = attempt - 1, worker = NULL, lease_until = NULL, ",
            ran!(),
            held!(),
            "RETURNING cancel_requested, sweep"
        ),
        values![lease.job, &lease.worker, lease.attempt],
    )
    .await?;
    engine.signals().job_changed(lease.job);
    tell_sweep(engine, row.as_ref())?;
    engine.signals().queue_changed();
    answer(row.as_ref())
}

/// Signals a sweep that one of its runs may have ended; from a row with the column `sweep`.
pub(super) fn tell_sweep<E: Engine>(engine: &E, row: Option<&impl Cells>) -> Result<()> {
    if let Some(sweep) = row.map(|row| row.id("sweep")).transpose()?.flatten() {
        engine.signals().job_changed(sweep);
    }
    Ok(())
}

/// Reads a row with the column `cancel_requested`, which exists if the lease is held.
pub(super) fn answer(row: Option<&impl Cells>) -> Result<LeaseAnswer> {
    match row {
        Some(row) => Ok(LeaseAnswer::Held { cancel_requested: rows::flag(row, "cancel_requested")? }),
        None => Ok(LeaseAnswer::Lost),
    }
}
