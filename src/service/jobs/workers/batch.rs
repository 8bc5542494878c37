//! Stores the increments of a solve: they are gathered for a short time, then appended in one transaction.

use crate::resources::cancel::CancelFlag;
use crate::service::jobs::configuration::limits::Reached;
use crate::service::jobs::solving::solve_output::SolveOutput;
use crate::service::jobs::{Jobs, Settings};
use crate::service::metrics::Write;
use crate::service::store::{Batch, Change, Claim, Lease, LeaseAnswer, StoreError};
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, MissedTickBehavior, interval_at, sleep_until, timeout_at};
use tokio_util::sync::CancellationToken;

/// The interval at which lines are received while a batch is gathered: waking up for every line would cost more.
const BETWEEN_LOOKS: Duration = Duration::from_millis(2);
/// The first lines of a job are received without this interval, so that small jobs, which are the most, do not wait.
const TAKEN_AT_ONCE: u64 = 64;
/// The pause before a write is repeated; it is doubled each time, up to the longest.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
const LONGEST_PAUSE: Duration = Duration::from_secs(1);

/// Why no more increments are stored.
#[derive(Debug)]
pub enum Drained {
    /// The solver has sent its last output; this batch has still to be stored, with the end of the job.
    Complete(Batch),
    /// The service is shutting down; the next attempt repeats what has not been stored.
    ShuttingDown,
    /// The job was deleted or taken by another worker, or nothing could be written while the lease was held.
    LeaseLost,
    Failed(StoreError),
    /// The job has reached a limit; what is stored is within it.
    Reached(Reached),
}

/// What remains to a job of its limits.
#[derive(Debug, Clone, Copy)]
pub struct Allowance {
    /// `None` if the time cannot be represented.
    pub until: Option<Instant>,
    pub bytes: u64,
}

impl Allowance {
    /// The rest of the limits, given what the job has used.
    pub fn of(settings: &Settings, claim: &Claim) -> Self {
        let limits = &settings.limits;
        Self {
            until: Instant::now().checked_add(limits.wall_time.saturating_sub(claim.ran)),
            bytes: limits.stored_bytes.saturating_sub(claim.stored_bytes),
        }
    }

    /// Deducts the bytes of the lines; removes lines that exceed the limit, and answers whether there were any.
    fn take(&mut self, gathered: &mut Vec<SolveOutput>) -> bool {
        let fits = gathered.iter().position(|sent| match sent {
            SolveOutput::Checkpoint(_) => false,
            SolveOutput::Line(line, _) => match self.bytes.checked_sub(line.bytes()) {
                Some(left) => {
                    self.bytes = left;
                    false
                }
                None => true,
            },
        });
        gathered.truncate(fits.unwrap_or(gathered.len()));
        fits.is_some()
    }
}

/// Stores the output of a solve, except for its last batch, and renews the lease, until the solve ends or another of the
/// reasons in [`Drained`] stops it.
pub async fn drain(
    jobs: &Jobs,
    claim: &Claim,
    sent: &mut mpsc::Receiver<SolveOutput>,
    cancel: &CancelFlag,
    shutdown: &CancellationToken,
) -> Drained {
    let settings = &jobs.settings;
    let (lease, mut allowance) = (&claim.lease, Allowance::of(settings, claim));
    let heartbeat = settings.lease / 3;
    let mut beats = interval_at(Instant::now() + heartbeat, heartbeat.max(Duration::from_millis(1)));
    beats.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut gathered = Vec::new();
    let mut changes = jobs.store.job_changes(lease.job);
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
            // Another process may have cancelled the job.
            () = changed_by_another(&mut changes) => {}
            received = gather(sent, &mut gathered, settings) => complete = received == Received::Last,
        }
        // A cancelled `gather` keeps what it has received, which is stored here after a heartbeat, too.
        if allowance.take(&mut gathered) {
            reached = Some(Reached::Storage);
        }
        let batch = batch(&mut gathered);
        if complete && reached.is_none() {
            return Drained::Complete(batch);
        }
        match append(jobs, lease, &batch, shutdown).await {
            Ok(LeaseAnswer::Held { cancel_requested }) => {
                if cancel_requested {
                    cancel.cancel();
                }
            }
            Ok(LeaseAnswer::Lost) => return Drained::LeaseLost,
            Err(error) if error.is_passing() && shutdown.is_cancelled() => return Drained::ShuttingDown,
            Err(error) if error.is_passing() => {
                tracing::error!(%error, source = ?std::error::Error::source(&error), "nothing could be stored while the lease was held");
                return Drained::LeaseLost;
            }
            Err(error) => return Drained::Failed(error),
        }
        if let Some(reached) = reached {
            return Drained::Reached(reached);
        }
    }
}

/// Waits for a change made by another process: changes of this process carry their lines.
async fn changed_by_another(changes: &mut watch::Receiver<Change>) {
    loop {
        if changes.changed().await.is_err() {
            return std::future::pending().await;
        }
        if changes.borrow_and_update().at.is_none() {
            return;
        }
    }
}

#[derive(PartialEq, Eq)]
enum Received {
    Some,
    Last,
}

/// Waits for output of the solve, then for more until the batch is full or the flush interval is over.
async fn gather(
    sent: &mut mpsc::Receiver<SolveOutput>,
    gathered: &mut Vec<SolveOutput>,
    settings: &Settings,
) -> Received {
    if gathered.is_empty() && sent.recv_many(gathered, settings.flush_rows).await == 0 {
        return Received::Last;
    }
    let deadline = Instant::now() + settings.flush_interval;
    while gathered.len() < settings.flush_rows {
        if sent.is_closed() && sent.is_empty() {
            return Received::Last;
        }
        if gathered.last().is_none_or(|last| last.index() >= TAKEN_AT_ONCE) {
            sleep_until(deadline.min(Instant::now() + BETWEEN_LOOKS)).await;
        }
        let room = settings.flush_rows - gathered.len();
        match timeout_at(deadline, sent.recv_many(gathered, room)).await {
            Ok(0) => return Received::Last,
            Ok(_) => {}
            Err(_) => return Received::Some,
        }
    }
    Received::Some
}

fn batch(gathered: &mut Vec<SolveOutput>) -> Batch {
    let mut batch = Batch::default();
    for sent in gathered.drain(..) {
        match sent {
            SolveOutput::Line(line, limit) => {
                batch.lines.push(line);
                batch.first_limit = batch.first_limit.or(limit);
            }
            SolveOutput::Checkpoint(checkpoint) => batch.checkpoints.push(checkpoint),
        }
    }
    batch
}

async fn append(
    jobs: &Jobs,
    lease: &Lease,
    batch: &Batch,
    shutdown: &CancellationToken,
) -> Result<LeaseAnswer, StoreError> {
    let duration = jobs.settings.lease;
    let write = if batch.is_empty() { Write::Renew } else { Write::Append };
    let append = || jobs.metrics.work.timed(write, jobs.store.append(lease, batch, duration));
    let answer = retry(duration, shutdown, append).await?;
    if let LeaseAnswer::Held { .. } = answer {
        jobs.metrics.work.stored(batch.lines.len());
    }
    Ok(answer)
}

/// Repeats a call that failed for a transient reason, for at most `patience` or until `shutdown`.
pub async fn retry<T, F>(
    patience: Duration,
    shutdown: &CancellationToken,
    mut call: impl FnMut() -> F,
) -> Result<T, StoreError>
where
    F: Future<Output = Result<T, StoreError>>,
{
    let began = Instant::now();
    let mut pause = FIRST_PAUSE;
    loop {
        match call().await {
            Err(error) if error.is_passing() && began.elapsed() + pause < patience && !shutdown.is_cancelled() => {
                tracing::warn!(%error, "a call to the database is repeated");
                tokio::select! {
                    () = shutdown.cancelled() => {}
                    () = tokio::time::sleep(pause) => {}
                }
                pause = (2 * pause).min(LONGEST_PAUSE);
            }
            answer => return answer,
        }
    }
}
