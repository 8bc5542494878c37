//! The interface of the store, independent of the database engine.

use crate::service::store::contract::error::Result;
use crate::service::store::contract::record::{
    Batch, Claim, Ending, FeedPage, FeedPosition, JobRecord, Keep, Lease, LeaseAnswer, Line, ListFilter, Listed,
    NewFollower, NewJob, NewSweep, Origin, Page, Retried, Standing, Status, Submitted, SweepRefinement,
};
use crate::service::store::contract::signals::Change;
use async_trait::async_trait;
use std::time::Duration;
use tokio::sync::watch;
use uuid::Uuid;

/// Stores jobs. Every write of a worker carries its [`Lease`] and changes nothing once the lease is lost.
#[async_trait]
pub trait Store: Send + Sync + 'static {
    /// Stores a job as `queued`, or finds the one that came with the same idempotency key.
    async fn submit(&self, job: NewJob) -> Result<Submitted>;

    /// Stores a sweep with all of its runs, which are `queued`, or finds the one that came with the same idempotency key.
    async fn submit_sweep(&self, sweep: NewSweep) -> Result<Submitted>;

    /// Sweeps that may have further runs, and whose runs so far have all ended; a few of them.
    async fn refinable_sweeps(&self) -> Result<Vec<Uuid>>;

    /// Queues further runs of a sweep, or ends the sweep where there are none. `false`: somebody else has done so, or it was
    /// cancelled or deleted.
    async fn refine_sweep(&self, refinement: SweepRefinement) -> Result<bool>;

    /// Cancels the runs of a sweep: waiting runs at once; running ones are marked, and their ids are answered.
    async fn cancel_sweep(&self, id: Uuid) -> Result<Vec<Uuid>>;

    /// Stores a job that follows another as `queued`, or finds the one that came with the same idempotency key.
    /// `None`: the parent does not exist, or has no branch up to that increment.
    async fn follow(&self, job: NewFollower) -> Result<Option<Submitted>>;

    async fn job(&self, id: Uuid) -> Result<Option<JobRecord>>;

    /// The status and last index of a job, which is cheaper than [`job`](Self::job).
    async fn standing(&self, id: Uuid) -> Result<Option<Standing>>;

    /// The request of a job, as posted.
    async fn request(&self, id: Uuid) -> Result<Option<String>>;

    /// The last branch stored with an increment up to this one.
    async fn branch(&self, id: Uuid, increment: u64) -> Result<Option<Origin>>;

    /// Queues the alternatives that explorations have found and answers their number. The jobs of a family are processed in the
    /// order of queueing, each when it and all before it have ended, so that the same jobs are queued in the same order
    /// whatever the number of workers.
    async fn explore(&self) -> Result<u64>;

    /// What has changed after a position, of one owner or of all: at most `most` changes, in order. `after` is the position of a
    /// change or the end of an earlier page.
    async fn changes(&self, owner: Option<&str>, after: Option<FeedPosition>, most: u32) -> Result<FeedPage>;

    /// Jobs of a task, newest first, in a short form. The memory of a page is bounded, however large the jobs are.
    async fn jobs(&self, filter: ListFilter) -> Result<Listed>;

    /// The number of jobs by status, read from stored counts.
    async fn tally(&self) -> Result<Vec<(Status, u64)>>;

    /// Increments with an index above `after`, in order; at most `page.rows` of them and, past the first, at most about
    /// `page.bytes`. Empty exactly when there are no more.
    async fn increments(&self, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>>;

    /// Cancels a queued job at once and marks a running one; an ended job is not changed. `None`: no such job.
    async fn request_cancel(&self, id: Uuid) -> Result<Option<JobRecord>>;

    /// Deletes a job and all its increments; its worker loses the lease. `false`: no such job.
    async fn delete(&self, id: Uuid) -> Result<bool>;

    /// Claims the next queued job, if any: by priority, then in turn between owners and between an owner's single jobs and jobs
    /// of larger groups. A job that has lost its worker and stored nothing since may crash its process: no two such jobs run at
    /// the same time, so that a job is not lost more than once because of another.
    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>>;

    /// Renews a lease.
    async fn renew(&self, lease: &Lease, duration: Duration) -> Result<LeaseAnswer>;

    /// Appends increments with their branches and checkpoints, updates the progress of the job and renews the lease, atomically.
    /// The call is idempotent: repeated after a lost answer, it stores nothing twice and has the same answer.
    async fn append(&self, lease: &Lease, batch: &Batch, duration: Duration) -> Result<LeaseAnswer>;

    /// Stores the end of a job and its last increments, atomically. Checkpoints are no longer needed and are not stored.
    async fn finish(&self, lease: &Lease, batch: &Batch, ending: &Ending) -> Result<LeaseAnswer>;

    /// Returns a job to the queue without counting the attempt, for a worker that shuts down.
    async fn release(&self, lease: &Lease) -> Result<LeaseAnswer>;

    /// Queues a failed job again and keeps its stored increments. `None`: no such job.
    async fn retry(&self, id: Uuid, most_queued: u64) -> Result<Option<Retried>>;

    /// Returns jobs whose lease has expired to the queue; a job that has lost `max_attempts` workers in a row without storing
    /// anything in between becomes `failed`. If several jobs are lost at once, the loss does not count for a job that had lost
    /// no worker before. Answers the number of changed jobs.
    async fn reclaim_expired(&self) -> Result<u64>;

    /// Deletes ended jobs that are not to be kept, a few at a time, and answers their number. Jobs whose alternatives have not
    /// been queued yet are kept.
    async fn retire(&self, keep: Keep) -> Result<u64>;

    /// Returns free space of the database to the disk, a part at a time; answers whether there is more.
    async fn shrink(&self) -> Result<bool>;

    /// Checks the integrity of the whole database.
    ///
    /// # Errors
    /// [`StoreError::Damaged`](crate::service::store::contract::error::StoreError::Damaged), which from then on every modifying call answers, too.
    async fn check(&self) -> Result<()>;

    /// Tests whether the store accepts writes.
    async fn probe(&self) -> Result<()>;

    /// A signal that changes whenever this process has stored something of the job, and usually when another process has.
    /// Subscribe before reading: then no change of this process is missed.
    fn job_changes(&self, id: Uuid) -> watch::Receiver<Change>;

    /// A signal that changes whenever this process has stored something of any job, and usually when another process has.
    fn any_change(&self) -> watch::Receiver<u64>;

    /// A signal that changes whenever this process has queued a job, and usually when another process has.
    fn queue_changes(&self) -> watch::Receiver<u64>;

    async fn close(&self);
}
