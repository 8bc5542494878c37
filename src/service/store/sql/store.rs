//! The [`Store`] over an SQL engine.

use crate::service::store::contract::error::Result;
use crate::service::store::contract::interface::Store;
use crate::service::store::sql::engine::Engine;
use crate::service::store::sql::{changes, claims, families, followers, increments, jobs, leases, sweeps, turns};
use crate::service::store::{
    Batch, Change, Claim, Ending, FeedPage, FeedPosition, JobRecord, Keep, Lease, LeaseAnswer, Line, ListFilter,
    Listed, NewFollower, NewJob, NewSweep, Origin, Page, Retried, Standing, Status, StoreError, Submitted,
    SweepRefinement,
};
use async_trait::async_trait;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::timeout;
use uuid::Uuid;

/// Once a statement or the integrity check has found damage, modifying calls are refused, as further writes may increase the
/// damage. Reads are still carried out.
pub(crate) struct SqlStore<E> {
    pub engine: E,
    damaged: AtomicBool,
    /// The workers whose last claim had no answer and may have been carried out.
    unanswered: Mutex<HashSet<String>>,
}

impl<E: Engine> SqlStore<E> {
    pub fn over(engine: E) -> Self {
        Self { engine, damaged: AtomicBool::new(false), unanswered: Mutex::default() }
    }

    /// A modifying call.
    async fn begin<T>(&self, call: impl Future<Output = Result<T>>) -> Result<T> {
        self.allow()?;
        self.call(call).await
    }

    fn allow(&self) -> Result<()> {
        if self.damaged.load(Ordering::Relaxed) {
            return Err(StoreError::Damaged("damage was found before; nothing is written".into()));
        }
        self.engine.allow()
    }

    async fn call<T>(&self, call: impl Future<Output = Result<T>>) -> Result<T> {
        self.within(E::PATIENCE, call).await
    }

    /// A call without a time limit, such as the deletion of a job with millions of rows.
    async fn at_length<T>(&self, call: impl Future<Output = Result<T>>) -> Result<T> {
        self.within(E::PATIENCE.map(|patience| 4 * patience), call).await
    }

    async fn within<T>(&self, patience: Option<Duration>, call: impl Future<Output = Result<T>>) -> Result<T> {
        let answer = match patience {
            None => call.await,
            Some(patience) => timeout(patience, call).await.unwrap_or_else(|late| {
                Err(StoreError::Unavailable(format!("no answer within {patience:?}: {late}").into()))
            }),
        };
        // Damage of the database itself, other than a row that cannot be read.
        if let Err(StoreError::Damaged(source)) = &answer
            && source.downcast_ref::<sqlx::Error>().is_some_and(|error| error.as_database_error().is_some())
        {
            self.damaged.store(true, Ordering::Relaxed);
        }
        answer
    }

    fn unanswered(&self) -> MutexGuard<'_, HashSet<String>> {
        // The set is consistent wherever a thread that holds the lock could panic.
        self.unanswered.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[async_trait]
impl<E: Engine> Store for SqlStore<E> {
    async fn submit(&self, job: NewJob) -> Result<Submitted> {
        let submitted = self.begin(self.engine.submit(job)).await;
        if matches!(submitted, Ok(Submitted::Created(_))) {
            self.engine.signals().queue_changed();
        }
        submitted
    }

    async fn submit_sweep(&self, sweep: NewSweep) -> Result<Submitted> {
        self.allow()?;
        let submitted = self.at_length(sweeps::submit(&self.engine, sweep)).await;
        if matches!(submitted, Ok(Submitted::Created(_))) {
            self.engine.signals().queue_changed();
        }
        submitted
    }

    async fn refinable_sweeps(&self) -> Result<Vec<Uuid>> {
        self.call(sweeps::refinable(&self.engine)).await
    }

    async fn refine_sweep(&self, refinement: SweepRefinement) -> Result<bool> {
        self.begin(sweeps::refine(&self.engine, refinement)).await
    }

    async fn cancel_sweep(&self, id: Uuid) -> Result<Vec<Uuid>> {
        let at_work = self.at_length(sweeps::mark_cancelled(&self.engine, id)).await?;
        // Runs that are left after a crash in between are cancelled by the worker that claims them.
        let mut after = Uuid::nil();
        while let Some(last) = self.call(sweeps::end_some(&self.engine, id, after)).await? {
            after = last;
        }
        Ok(at_work)
    }

    async fn follow(&self, job: NewFollower) -> Result<Option<Submitted>> {
        self.begin(followers::follow(&self.engine, job)).await
    }

    async fn job(&self, id: Uuid) -> Result<Option<JobRecord>> {
        self.call(jobs::get(&self.engine, id)).await
    }

    async fn standing(&self, id: Uuid) -> Result<Option<Standing>> {
        self.call(jobs::standing(&self.engine, id)).await
    }

    async fn request(&self, id: Uuid) -> Result<Option<String>> {
        self.call(followers::request(&self.engine, id)).await
    }

    async fn branch(&self, id: Uuid, increment: u64) -> Result<Option<Origin>> {
        self.call(followers::branch(&self.engine, id, increment)).await
    }

    async fn explore(&self) -> Result<u64> {
        self.begin(families::explore(&self.engine)).await
    }

    async fn changes(&self, owner: Option<&str>, after: Option<FeedPosition>, most: u32) -> Result<FeedPage> {
        self.call(changes::read(&self.engine, owner, after, most)).await
    }

    async fn jobs(&self, filter: ListFilter) -> Result<Listed> {
        self.call(jobs::list(&self.engine, filter)).await
    }

    async fn tally(&self) -> Result<Vec<(Status, u64)>> {
        self.call(jobs::tally(&self.engine)).await
    }

    async fn increments(&self, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>> {
        self.call(increments::read(&self.engine, id, after, page)).await
    }

    async fn request_cancel(&self, id: Uuid) -> Result<Option<JobRecord>> {
        self.call(jobs::request_cancel(&self.engine, id)).await
    }

    async fn delete(&self, id: Uuid) -> Result<bool> {
        self.at_length(jobs::delete(&self.engine, id)).await
    }

    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>> {
        let again = self.unanswered().contains(worker);
        let claimed = self.begin(claims::claim(&self.engine, worker, lease, again)).await;
        if claimed.is_err() {
            self.unanswered().insert(worker.to_owned());
        } else if again {
            self.unanswered().remove(worker);
        }
        claimed
    }

    async fn renew(&self, lease: &Lease, duration: Duration) -> Result<LeaseAnswer> {
        self.call(leases::renew(&self.engine, lease, duration)).await
    }

    async fn append(&self, lease: &Lease, batch: &Batch, duration: Duration) -> Result<LeaseAnswer> {
        self.call(increments::append(&self.engine, lease, batch, duration)).await
    }

    async fn finish(&self, lease: &Lease, batch: &Batch, ending: &Ending) -> Result<LeaseAnswer> {
        self.call(increments::finish(&self.engine, lease, batch, ending)).await
    }

    async fn release(&self, lease: &Lease) -> Result<LeaseAnswer> {
        self.call(leases::release(&self.engine, lease)).await
    }

    async fn retry(&self, id: Uuid, most_queued: u64) -> Result<Option<Retried>> {
        self.begin(jobs::retry(&self.engine, id, most_queued)).await
    }

    async fn reclaim_expired(&self) -> Result<u64> {
        let touched = self.call(claims::reclaim_expired(&self.engine)).await?;
        self.call(turns::close_gaps(&self.engine)).await?;
        Ok(touched)
    }

    async fn retire(&self, keep: Keep) -> Result<u64> {
        self.allow()?;
        self.at_length(jobs::retire(&self.engine, keep)).await
    }

    async fn shrink(&self) -> Result<bool> {
        self.begin(self.engine.shrink()).await
    }

    async fn check(&self) -> Result<()> {
        let checked = self.call(self.engine.check()).await;
        if matches!(checked, Err(StoreError::Damaged(_))) {
            self.damaged.store(true, Ordering::Relaxed);
        }
        checked
    }

    async fn probe(&self) -> Result<()> {
        self.begin(jobs::probe(&self.engine)).await
    }

    fn job_changes(&self, id: Uuid) -> watch::Receiver<Change> {
        self.engine.signals().job_changes(id)
    }

    fn any_change(&self) -> watch::Receiver<u64> {
        self.engine.signals().any_change()
    }

    fn queue_changes(&self) -> watch::Receiver<u64> {
        self.engine.signals().queue_changes()
    }

    async fn close(&self) {
        self.engine.close().await;
    }
}
