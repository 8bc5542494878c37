//! All workers of a process, and the sweeper that takes back what lost workers held.

use crate::service::jobs::Jobs;
use crate::service::jobs::workers::{retention, worker};
use crate::service::store::contract::interface::Store;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;
use uuid::Uuid;

/// A task that panics again and again does not take the processor from the others.
const AFTER_A_PANIC: Duration = Duration::from_secs(1);

/// Answers and solves under way get so long to end.
const DRAIN: Duration = Duration::from_secs(8);
/// Closing the database after that.
const CLOSE: Duration = Duration::from_secs(2);

/// The workers under way.
pub struct Crew {
    tasks: JoinSet<()>,
    attendance: Attendance,
}

/// How many workers there should be and how many there are.
#[derive(Debug, Clone)]
pub struct Attendance {
    alive: Arc<AtomicUsize>,
    expected: usize,
}

impl Attendance {
    pub fn alive(&self) -> usize {
        self.alive.load(Ordering::Relaxed)
    }

    pub fn expected(&self) -> usize {
        self.expected
    }

    pub fn is_complete(&self) -> bool {
        self.alive() >= self.expected()
    }
}

impl Crew {
    /// Starts the workers; they stop when `shutdown` is cancelled.
    pub fn start(jobs: &Jobs, shutdown: &CancellationToken) -> Self {
        let attendance = Attendance { alive: Arc::default(), expected: jobs.settings.workers };
        let mut tasks = JoinSet::new();
        // Leases name the worker, so no two processes, nor two lives of one, may share a name.
        let process = Uuid::now_v7();
        for number in 0..jobs.settings.workers {
            let present = Present::new(&attendance.alive);
            let (jobs, name, shutdown) = (jobs.clone(), format!("{process}/{number}"), shutdown.clone());
            tasks.spawn(async move {
                let _present = present;
                kept_up(&shutdown, || worker::work(jobs.clone(), name.clone(), shutdown.clone())).await;
            });
        }
        let (sweeping, stop) = (jobs.clone(), shutdown.clone());
        tasks.spawn(async move { kept_up(&stop, || sweep(sweeping.clone(), stop.clone())).await });
        let (tidying, stop) = (jobs.clone(), shutdown.clone());
        tasks.spawn(async move { kept_up(&stop, || tidy(tidying.clone(), stop.clone())).await });
        Self { tasks, attendance }
    }

    pub fn attendance(&self) -> Attendance {
        self.attendance.clone()
    }

    /// Waits until every worker has put its job down.
    pub async fn stopped(mut self) {
        while let Some(ended) = self.tasks.join_next().await {
            if let Err(error) = ended {
                tracing::error!(%error, "a worker ended early");
            }
        }
    }
}

/// Waits for what has been asked to end, and closes the database; answers whether it all ended within the bound.
pub async fn wound_up<T>(ends: impl Future<Output = T>, store: &dyn Store) -> bool {
    let ended = timeout(DRAIN, ends).await;
    if ended.is_err() {
        tracing::warn!(seconds = DRAIN.as_secs(), "not everything ended in time; its jobs run again later");
    }
    let closed = timeout(CLOSE, store.close()).await;
    ended.is_ok() && closed.is_ok()
}

/// Begins a task anew when it has panicked, after a moment.
async fn kept_up<F: Future<Output = ()> + Send + 'static>(shutdown: &CancellationToken, begin: impl Fn() -> F) {
    while let Err(error) = AbortOnDropHandle::new(tokio::spawn(begin())).await {
        tracing::error!(%error, "a task of the service panicked; it begins anew");
        tokio::select! {
            () = shutdown.cancelled() => return,
            () = tokio::time::sleep(AFTER_A_PANIC) => {}
        }
    }
}

async fn sweep(jobs: Jobs, shutdown: CancellationToken) {
    loop {
        match jobs.store.reclaim_expired().await {
            Ok(0) => {}
            Ok(count) => tracing::warn!(count, "jobs taken back from workers that were lost"),
            Err(error) => tracing::warn!(%error, "expired leases could not be looked for"),
        }
        // Jobs that ended without their worker: cancelled in the queue, deleted, or stored just before a stop.
        crate::service::jobs::workers::explore::queue(&jobs).await;
        tokio::select! {
            () = shutdown.cancelled() => return,
            () = tokio::time::sleep(jobs.settings.lease / 4) => {}
        }
    }
}

async fn tidy(jobs: Jobs, shutdown: CancellationToken) {
    tokio::select! {
        () = shutdown.cancelled() => return,
        checked = jobs.store.check() => if let Err(error) = checked {
            tracing::error!(%error, source = ?std::error::Error::source(&error), "the database does not stand its check");
        }
    }
    loop {
        tokio::select! {
            () = shutdown.cancelled() => return,
            () = retention::tidy(&jobs) => {}
        }
        tokio::select! {
            () = shutdown.cancelled() => return,
            () = tokio::time::sleep(jobs.settings.tidy_interval) => {}
        }
    }
}

/// Counts a worker for as long as its task lives, however that ends.
struct Present(Arc<AtomicUsize>);

impl Present {
    fn new(alive: &Arc<AtomicUsize>) -> Self {
        alive.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(alive))
    }
}

impl Drop for Present {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}
