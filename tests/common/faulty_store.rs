//! A store whose writes can be made to fail; everything else is the real one.

use arcslip::service::store::contract::error::Result;
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{
    Batch, Change, Claim, Ending, FeedPage, FeedPosition, JobRecord, Keep, Lease, LeaseAnswer, Line, ListFilter,
    Listed, NewFollower, NewJob, NewSweep, Origin, Page, Retried, Standing, Status, StoreError, Submitted,
    SweepRefinement,
};
use async_trait::async_trait;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::sync::watch;
use uuid::Uuid;

pub struct FaultyStore {
    inner: Arc<dyn Store>,
    /// So many writes of lines fail as if the database were locked.
    pub locked_appends: AtomicU32,
    /// So many writes of lines panic.
    pub panicking_appends: AtomicU32,
    /// Writes of lines and submissions fail as if the disk were full.
    pub full: AtomicBool,
    /// Probes and tallies fail.
    pub down: AtomicBool,
    /// Indices in the order in which they were stored.
    pub stored: Mutex<Vec<u64>>,
}

impl FaultyStore {
    pub fn around(inner: Arc<dyn Store>) -> Arc<Self> {
        Arc::new(Self {
            inner,
            locked_appends: AtomicU32::new(0),
            panicking_appends: AtomicU32::new(0),
            full: AtomicBool::new(false),
            down: AtomicBool::new(false),
            stored: Mutex::default(),
        })
    }

    fn room(&self) -> Result<()> {
        if self.full.load(Ordering::Relaxed) {
            Err(StoreError::Full("INSERT INTO x: /tmp/x is full".into()))
        } else {
            Ok(())
        }
    }

    fn before_lines(&self) -> Result<()> {
        self.room()?;
        let one_of = |faults: &AtomicU32| {
            faults.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_ok()
        };
        assert!(!one_of(&self.panicking_appends), "a made-up defect of the store");
        if one_of(&self.locked_appends) {
            return Err(StoreError::Unavailable("locked".into()));
        }
        Ok(())
    }

    fn note(&self, batch: &Batch) {
        self.stored.lock().expect("no panic under the lock").extend(batch.lines.iter().map(|line| line.index));
    }
}

#[async_trait]
impl Store for FaultyStore {
    async fn submit(&self, job: NewJob) -> Result<Submitted> {
        self.room()?;
        self.inner.submit(job).await
    }

    async fn submit_sweep(&self, sweep: NewSweep) -> Result<Submitted> {
        self.room()?;
        self.inner.submit_sweep(sweep).await
    }

    async fn refinable_sweeps(&self) -> Result<Vec<Uuid>> {
        self.inner.refinable_sweeps().await
    }

    async fn refine_sweep(&self, refinement: SweepRefinement) -> Result<bool> {
        self.inner.refine_sweep(refinement).await
    }

    async fn cancel_sweep(&self, id: Uuid) -> Result<Vec<Uuid>> {
        self.inner.cancel_sweep(id).await
    }

    async fn follow(&self, job: NewFollower) -> Result<Option<Submitted>> {
        self.room()?;
        self.inner.follow(job).await
    }

    async fn changes(&self, owner: Option<&str>, after: Option<FeedPosition>, most: u32) -> Result<FeedPage> {
        self.inner.changes(owner, after, most).await
    }

    fn any_change(&self) -> watch::Receiver<u64> {
        self.inner.any_change()
    }

    async fn request(&self, id: Uuid) -> Result<Option<String>> {
        self.inner.request(id).await
    }

    async fn branch(&self, id: Uuid, increment: u64) -> Result<Option<Origin>> {
        self.inner.branch(id, increment).await
    }

    async fn explore(&self) -> Result<u64> {
        self.inner.explore().await
    }

    async fn job(&self, id: Uuid) -> Result<Option<JobRecord>> {
        self.inner.job(id).await
    }

    async fn standing(&self, id: Uuid) -> Result<Option<Standing>> {
        self.inner.standing(id).await
    }

    async fn jobs(&self, filter: ListFilter) -> Result<Listed> {
        self.inner.jobs(filter).await
    }

    async fn tally(&self) -> Result<Vec<(Status, u64)>> {
        if self.down.load(Ordering::Relaxed) {
            return Err(StoreError::Unavailable("disk I/O error".into()));
        }
        self.inner.tally().await
    }

    async fn increments(&self, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>> {
        self.inner.increments(id, after, page).await
    }

    async fn request_cancel(&self, id: Uuid) -> Result<Option<JobRecord>> {
        self.inner.request_cancel(id).await
    }

    async fn delete(&self, id: Uuid) -> Result<bool> {
        self.inner.delete(id).await
    }

    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>> {
        self.inner.claim(worker, lease).await
    }

    async fn renew(&self, lease: &Lease, duration: Duration) -> Result<LeaseAnswer> {
        self.inner.renew(lease, duration).await
    }

    async fn append(&self, lease: &Lease, batch: &Batch, duration: Duration) -> Result<LeaseAnswer> {
        self.before_lines()?;
        let answer = self.inner.append(lease, batch, duration).await?;
        self.note(batch);
        Ok(answer)
    }

    async fn finish(&self, lease: &Lease, batch: &Batch, ending: &Ending) -> Result<LeaseAnswer> {
        if !batch.is_empty() {
            self.before_lines()?;
        }
        let answer = self.inner.finish(lease, batch, ending).await?;
        self.note(batch);
        Ok(answer)
    }

    async fn release(&self, lease: &Lease) -> Result<LeaseAnswer> {
        self.inner.release(lease).await
    }

    async fn retry(&self, id: Uuid, most_queued: u64) -> Result<Option<Retried>> {
        self.inner.retry(id, most_queued).await
    }

    async fn reclaim_expired(&self) -> Result<u64> {
        self.inner.reclaim_expired().await
    }

    async fn retire(&self, keep: Keep) -> Result<u64> {
        self.inner.retire(keep).await
    }

    async fn shrink(&self) -> Result<bool> {
        self.inner.shrink().await
    }

    async fn check(&self) -> Result<()> {
        self.inner.check().await
    }

    async fn probe(&self) -> Result<()> {
        if self.down.load(Ordering::Relaxed) {
            return Err(StoreError::Unavailable("disk I/O error".into()));
        }
        self.inner.probe().await
    }

    fn job_changes(&self, id: Uuid) -> watch::Receiver<Change> {
        self.inner.job_changes(id)
    }

    fn queue_changes(&self) -> watch::Receiver<u64> {
        self.inner.queue_changes()
    }

    async fn close(&self) {
        self.inner.close().await;
    }
}
