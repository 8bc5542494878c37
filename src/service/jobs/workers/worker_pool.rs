//! The workers of a process, and the tasks that reclaim the jobs of lost workers and delete old jobs.

use crate::service::jobs::Jobs;
use crate::service::jobs::workers::{refinement, retention, worker};
use crate::service::store::contract::interface::Store;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tokio_util::task::AbortOnDropHandle;
use uuid::Uuid;

/// The pause before a task that panicked is restarted, so that repeated panics do not use up the processor.
const AFTER_A_PANIC: Duration = Duration::from_secs(1);

/// Time for answers and solves to end.
const DRAIN: Duration = Duration::from_secs(8);
/// Time to close the database after that.
const CLOSE: Duration = Duration::from_secs(2);

/// The running workers.
pub struct WorkerPool {
    tasks: JoinSet<()>,
    worker_count: WorkerCount,
}

/// The number of workers that run and that should run.
#[derive(Debug, Clone)]
pub struct WorkerCount {
    alive: Arc<AtomicUsize>,
    expected: usize,
}

impl WorkerCount {
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

impl WorkerPool {
    /// Starts the workers; they stop when `shutdown` is cancelled.
    pub fn start(jobs: &Jobs, shutdown: &CancellationToken) -> Self {
        let worker_count = WorkerCount { alive: Arc::default(), expected: jobs.settings.workers };
        let mut tasks = JoinSet::new();
        // Leases name the worker, so that names are unique over all processes and restarts.
        let process = Uuid::now_v7();
        for number in 0..jobs.settings.workers {
            let present = CountedWorker::new(&worker_count.alive);
            let (jobs, name, shutdown) = (jobs.clone(), format!("{process}/{number}"), shutdown.clone());
            tasks.spawn(async move {
                let _present = present;
                restart_on_panic(&shutdown, || worker::work(jobs.clone(), name.clone(), shutdown.clone())).await;
            });
        }
        let (sweeping, stop) = (jobs.clone(), shutdown.clone());
        tasks.spawn(async move { restart_on_panic(&stop, || sweep(sweeping.clone(), stop.clone())).await });
        let (tidying, stop) = (jobs.clone(), shutdown.clone());
        tasks.spawn(async move { restart_on_panic(&stop, || tidy(tidying.clone(), stop.clone())).await });
        Self { tasks, worker_count }
    }

    pub fn worker_count(&self) -> WorkerCount {
        self.worker_count.clone()
    }

    /// Waits until every worker has released its job.
    pub async fn stopped(mut self) {
        while let Some(ended) = self.tasks.join_next().await {
            if let Err(error) = ended {
                tracing::error!(%error, "a worker failed");
            }
        }
    }
}

/// Waits for `ends`, which has been asked to end, and closes the database; answers whether both ended within their time limits.
pub async fn finish_shutdown<T>(ends: impl Future<Output = T>, store: &dyn Store) -> bool {
    let ended = timeout(DRAIN, ends).await;
    if ended.is_err() {
        tracing::warn!(seconds = DRAIN.as_secs(), "not everything ended in time; its jobs run again later");
    }
    let closed = timeout(CLOSE, store.close()).await;
    ended.is_ok() && closed.is_ok()
}

/// Runs a task, and restarts it after a pause whenever it panics.
async fn restart_on_panic<F: Future<Output = ()> + Send + 'static>(
    shutdown: &CancellationToken,
    begin: impl Fn() -> F,
) {
    while let Err(error) = AbortOnDropHandle::new(tokio::spawn(begin())).await {
        tracing::error!(%error, "a task of the service panicked; it is restarted");
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
            Ok(count) => tracing::warn!(count, "jobs of lost workers were queued again"),
            Err(error) => tracing::warn!(%error, "expired leases could not be reclaimed"),
        }
        // Alternatives of jobs that ended without their worker: cancelled in the queue, deleted, or stored just before a shutdown.
        crate::service::jobs::workers::explore::queue(&jobs).await;
        refinement::queue(&jobs).await;
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
            tracing::error!(%error, source = ?std::error::Error::source(&error), "the database failed its integrity check");
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

/// Counts a worker while its task runs, however the task ends.
struct CountedWorker(Arc<AtomicUsize>);

impl CountedWorker {
    fn new(alive: &Arc<AtomicUsize>) -> Self {
        alive.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(alive))
    }
}

impl Drop for CountedWorker {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}
