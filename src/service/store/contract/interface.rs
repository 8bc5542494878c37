//! What an engine of storage does, whichever it is.

use crate::service::store::contract::error::Result;
use crate::service::store::contract::record::{
    Batch, Claim, Ending, JobRecord, Keep, Lease, LeaseAnswer, Line, ListFilter, Listed, NewFollower, NewJob, NewSweep,
    Origin, Page, Retried, Standing, Status, Submitted,
};
use crate::service::store::contract::signals::Change;
use async_trait::async_trait;
use std::time::Duration;
use tokio::sync::watch;
use uuid::Uuid;

/// An engine that keeps jobs. Every write of a worker carries its [`Lease`] and changes nothing once that is lost.
#[async_trait]
pub trait Store: Send + Sync + 'static {
    /// Stores a job as `queued`, or finds the one that came with the same idempotency key.
    async fn submit(&self, job: NewJob) -> Result<Submitted>;

    /// Stores a sweep and all of its runs, those as `queued`, or finds the one that came with the same idempotency key.
    async fn submit_sweep(&self, sweep: NewSweep) -> Result<Submitted>;

    /// Cancels the runs of a sweep: those that wait at once; those at work are marked, and answered.
    async fn cancel_sweep(&self, id: Uuid) -> Result<Vec<Uuid>>;

    /// Stores a job that follows another as `queued`, or finds the one that came with the same idempotency key.
    /// `None`: the parent, or a branch of it up to that increment, is not there.
    async fn follow(&self, job: NewFollower) -> Result<Option<Submitted>>;

    async fn job(&self, id: Uuid) -> Result<Option<JobRecord>>;

    /// How far a job has come; less to read than [`job`](Self::job).
    async fn standing(&self, id: Uuid) -> Result<Option<Standing>>;

    /// A job's request, as posted.
    async fn request(&self, id: Uuid) -> Result<Option<String>>;

    /// The last branch stored with an increment up to this one.
    async fn branch(&self, id: Uuid, increment: u64) -> Result<Option<Origin>>;

    /// Queues what explorations have found: families are taken job by job, in the order of queueing, and each job when it
    /// and all before it have ended, so that the same jobs are queued in the same order however many work at once.
    /// Answers how many were queued.
    async fn explore(&self) -> Result<u64>;

    /// Jobs of one task, newest first, shortened. What is read and held for a page is bounded, however large they are.
    async fn jobs(&self, filter: ListFilter) -> Result<Listed>;

    /// How many jobs have each status; told without counting them.
    async fn tally(&self) -> Result<Vec<(Status, u64)>>;

    /// Increments with an index above `after`, in order; at most `page.rows` of them and, past the first, at most about
    /// `page.bytes`. Empty exactly when there are no more.
    async fn increments(&self, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>>;

    /// A queued job is cancelled at once, a running one marked, an ended one left alone. `None`: no such job.
    async fn request_cancel(&self, id: Uuid) -> Result<Option<JobRecord>>;

    /// Drops a job and all its increments; a worker on it loses its lease. `false`: no such job.
    async fn delete(&self, id: Uuid) -> Result<bool>;

    /// Takes the next queued job, if any: by priority, then in turn between owners and between an owner's single jobs and those
    /// of which it has many. Of jobs that have lost their worker and stored nothing since, any of which may end
    /// the process that works on it, no two are worked on at a time: a job is not lost more than once for another's sake.
    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>>;

    /// Prolongs a lease.
    async fn renew(&self, lease: &Lease, duration: Duration) -> Result<LeaseAnswer>;

    /// Appends increments with what is stored beside them, moves the job's progress and prolongs the lease, all or nothing.
    /// Where no answer came to such a call, the same call again stores nothing twice and is answered as the first.
    async fn append(&self, lease: &Lease, batch: &Batch, duration: Duration) -> Result<LeaseAnswer>;

    /// Ends a job, with these increments as its last, all or nothing. Checkpoints are of no more use and are not stored.
    async fn finish(&self, lease: &Lease, batch: &Batch, ending: &Ending) -> Result<LeaseAnswer>;

    /// Hands a job back to the queue with its attempt, for a worker that is going away in good order.
    async fn release(&self, lease: &Lease) -> Result<LeaseAnswer>;

    /// Queues a failed job again, what it has stored kept. `None`: no such job.
    async fn retry(&self, id: Uuid, most_queued: u64) -> Result<Option<Retried>>;

    /// Puts jobs whose lease has run out back into the queue; one that has lost `max_attempts` workers in a row, with nothing
    /// stored between, becomes `failed`. A loss of several jobs at once counts for none that had lost no worker before.
    /// Answers how many were touched.
    async fn reclaim_expired(&self) -> Result<u64>;

    /// Drops ended jobs that are not to be kept, a few at a time; answers how many. Those whose alternatives an exploration
    /// has still to look at stay.
    async fn retire(&self, keep: Keep) -> Result<u64>;

    /// Gives room that is free in the database back to the disk, a part at a time; answers whether there is more.
    async fn shrink(&self) -> Result<bool>;

    /// Looks through the whole database for damage.
    ///
    /// # Errors
    /// [`StoreError::Damaged`](crate::service::store::contract::error::StoreError::Damaged), which every call answers from then on that would write.
    async fn check(&self) -> Result<()>;

    /// Proves that the store takes writes.
    async fn probe(&self) -> Result<()>;

    /// Changes whenever something of this job was stored here, and mostly when it was elsewhere. Subscribe first, then read: no
    /// change that was made here is missed.
    fn job_changes(&self, id: Uuid) -> watch::Receiver<Change>;

    /// Changes whenever a job was put into the queue here, and mostly when it was elsewhere.
    fn queue_changes(&self) -> watch::Receiver<u64>;

    async fn close(&self);
}
