//! All workers of a process, and the sweeper that takes back what lost workers held.

use super::{Jobs, worker};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use tokio::task::JoinSet;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

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

    pub fn is_complete(&self) -> bool {
        self.alive() >= self.expected
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
            let work = worker::work(jobs.clone(), format!("{process}/{number}"), shutdown.clone());
            tasks.spawn(async move {
                let _present = present;
                work.await;
            });
        }
        tasks.spawn(sweep(jobs.clone(), shutdown.clone()));
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

async fn sweep(jobs: Jobs, shutdown: CancellationToken) {
    loop {
        match jobs.store.reclaim_expired().await {
            Ok(0) => {}
            Ok(count) => tracing::warn!(count, "jobs taken back from workers that were lost"),
            Err(error) => tracing::warn!(%error, "expired leases could not be looked for"),
        }
        // Jobs that ended without their worker: cancelled in the queue, deleted, or stored just before a stop.
        super::explore::queue(&jobs).await;
        tokio::select! {
            () = shutdown.cancelled() => return,
            () = tokio::time::sleep(jobs.settings.lease / 4) => {}
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
