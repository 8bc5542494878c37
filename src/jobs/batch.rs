//! Increments on their way to the store: gathered for a moment, then appended in one transaction.

use super::limits::Reached;
use super::{Jobs, Settings};
use crate::cancel::CancelFlag;
use crate::metrics::Write;
use crate::store::{Claim, Lease, LeaseAnswer, Line, StoreError};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{Instant, MissedTickBehavior, interval_at, sleep_until, timeout_at};
use tokio_util::sync::CancellationToken;

/// Tries of one write while the store is passingly unavailable, each after twice the pause of the one before.
const TRIES: u32 = 5;
/// While a batch is gathered its lines are looked for so often: to be woken by every one of them costs more than they do.
const BETWEEN_LOOKS: Duration = Duration::from_millis(2);
/// The first lines of a job are taken as they come: most jobs are small, and wait for nothing then.
const TAKEN_AT_ONCE: u64 = 64;
const FIRST_PAUSE: Duration = Duration::from_millis(50);

/// Why no more increments are stored.
#[derive(Debug)]
pub enum Drained {
    /// The solver has sent its last one, and it is stored.
    Complete,
    /// The service is going down; what is not stored yet is computed again by the next attempt.
    ShuttingDown,
    /// The job is gone or another's.
    LeaseLost,
    Failed(StoreError),
    /// The job has used up what it may use; what is stored is within the limit.
    Reached(Reached),
}

/// What a job may still use.
#[derive(Debug, Clone, Copy)]
pub struct Allowance {
    /// None where that is too far off to be told.
    pub until: Option<Instant>,
    pub bytes: u64,
}

impl Allowance {
    /// What is left of the service's limits.
    pub fn of(settings: &Settings, claim: &Claim) -> Self {
        let limits = &settings.limits;
        Self {
            until: Instant::now().checked_add(limits.wall_time.saturating_sub(claim.ran)),
            bytes: limits.stored_bytes.saturating_sub(claim.stored_bytes),
        }
    }

    /// Takes the lines' bytes; cuts off what is too much, and answers whether there was such.
    fn take(&mut self, batch: &mut Vec<Line>) -> bool {
        let fits = batch.iter().position(|line| match self.bytes.checked_sub(line.bytes()) {
            Some(left) => {
                self.bytes = left;
                false
            }
            None => true,
        });
        batch.truncate(fits.unwrap_or(batch.len()));
        fits.is_some()
    }
}

/// Stores increments until the solver ends or one of the reasons above stops it; the lease is prolonged on the way.
pub async fn drain(
    jobs: &Jobs,
    claim: &Claim,
    lines: &mut mpsc::Receiver<Line>,
    cancel: &CancelFlag,
    shutdown: &CancellationToken,
) -> Drained {
    let settings = &jobs.settings;
    let (lease, mut allowance) = (&claim.lease, Allowance::of(settings, claim));
    let heartbeat = settings.lease / 3;
    let mut beats = interval_at(Instant::now() + heartbeat, heartbeat.max(Duration::from_millis(1)));
    beats.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut batch = Vec::new();
    loop {
        let (mut complete, mut reached) = (false, None);
        let time_is_up = async {
            match allowance.until {
                Some(until) => sleep_until(until).await,
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            biased;
            () = shutdown.cancelled() => return Drained::ShuttingDown,
            () = time_is_up => reached = Some(Reached::Time),
            _ = beats.tick() => {}
            received = gather(lines, &mut batch, settings) => complete = received == Received::Last,
        }
        // A cancelled gather leaves what it had in the batch, so a beat stores it too.
        if allowance.take(&mut batch) {
            reached = Some(Reached::Storage);
        }
        match append(jobs, lease, &batch).await {
            Ok(LeaseAnswer::Held { cancel_requested }) => {
                if cancel_requested {
                    cancel.cancel();
                }
            }
            Ok(LeaseAnswer::Lost) => return Drained::LeaseLost,
            Err(error) => return Drained::Failed(error),
        }
        batch.clear();
        if let Some(reached) = reached {
            return Drained::Reached(reached);
        }
        if complete {
            return Drained::Complete;
        }
    }
}

#[derive(PartialEq, Eq)]
enum Received {
    Some,
    Last,
}

/// Waits for one increment, then a moment for those that follow it closely.
async fn gather(lines: &mut mpsc::Receiver<Line>, batch: &mut Vec<Line>, settings: &Settings) -> Received {
    if batch.is_empty() && lines.recv_many(batch, settings.flush_rows).await == 0 {
        return Received::Last;
    }
    let deadline = Instant::now() + settings.flush_interval;
    while batch.len() < settings.flush_rows {
        if lines.is_closed() && lines.is_empty() {
            return Received::Last;
        }
        if batch.last().is_none_or(|line| line.index >= TAKEN_AT_ONCE) {
            sleep_until(deadline.min(Instant::now() + BETWEEN_LOOKS)).await;
        }
        let room = settings.flush_rows - batch.len();
        match timeout_at(deadline, lines.recv_many(batch, room)).await {
            Ok(0) => return Received::Last,
            Ok(_) => {}
            Err(_) => return Received::Some,
        }
    }
    Received::Some
}

async fn append(jobs: &Jobs, lease: &Lease, batch: &[Line]) -> Result<LeaseAnswer, StoreError> {
    let write = if batch.is_empty() { Write::Renew } else { Write::Append };
    let append = || jobs.metrics.work.timed(write, jobs.store.append(lease, batch, jobs.settings.lease));
    let answer = retry(append).await?;
    if let LeaseAnswer::Held { .. } = answer {
        jobs.metrics.work.stored(batch.len());
    }
    Ok(answer)
}

/// Repeats a write that failed for a passing reason.
pub async fn retry<T, F>(mut write: impl FnMut() -> F) -> Result<T, StoreError>
where
    F: Future<Output = Result<T, StoreError>>,
{
    let mut pause = FIRST_PAUSE;
    for _ in 1..TRIES {
        match write().await {
            Err(error) if error.is_passing() => {
                tracing::warn!(%error, "a write is repeated");
                tokio::time::sleep(pause).await;
                pause *= 2;
            }
            answer => return answer,
        }
    }
    write().await
}
