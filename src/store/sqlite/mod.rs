//! SQLite: one connection that writes, a pool that reads.
//!
//! With several writers the worst claim waits an order of magnitude longer at the same throughput, so writes queue for
//! the one connection here rather than for SQLite's lock. The log is write-ahead, and every commit is synced: what a
//! client was told is stored survives a power loss.

pub(super) mod backup;
mod claims;
mod families;
mod followers;
mod health;
mod increments;
mod intake;
mod jobs;
mod rows;

use super::signals::Signals;
use super::{
    Batch, Change, Claim, Ending, JobRecord, Keep, Lease, LeaseAnswer, Line, ListFilter, NewFollower, NewJob, Origin,
    Page, Result, Standing, Status, Store, StoreError, Submitted,
};
use async_trait::async_trait;
use health::Health;
use intake::Intake;
use jiff::Timestamp;
use sqlx::Connection;
use sqlx::sqlite::{
    SqliteAutoVacuum, SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use std::path::Path;
use std::time::Duration;
use tokio::sync::watch;
use uuid::Uuid;

static MIGRATIONS: sqlx::migrate::Migrator = sqlx::migrate!("./migrations");

const READERS: u32 = 4;
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);
/// Bytes that the write-ahead log keeps on the disk when it has been written back.
const LARGEST_LOG: &str = "67108864";
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(15);

pub struct SqliteStore {
    writer: SqlitePool,
    readers: SqlitePool,
    signals: Signals,
    intake: Intake,
    health: Health,
}

impl SqliteStore {
    pub async fn open(file: &Path) -> Result<Self> {
        // A file in any case: names such as `:memory:` mean something else to SQLite.
        let file = &std::path::absolute(file).map_err(|error| StoreError::Open(Box::new(error)))?;
        let options = SqliteConnectOptions::new().filename(file).busy_timeout(BUSY_TIMEOUT).foreign_keys(true);
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .idle_timeout(None)
            .max_lifetime(None)
            // A ping before every use finds nothing in a file, and costs as much as a statement.
            .test_before_acquire(false)
            // Where SQLite itself has rolled back, as it does on a full disk, the connection still counts a transaction, and the
            // next one would only be a part of it: told as stored, and lost. Such a connection is closed.
            .after_release(|connection, _| {
                Box::pin(async move {
                    connection.ping().await?;
                    Ok(!connection.is_in_transaction())
                })
            })
            .connect_with(
                options
                    .clone()
                    .create_if_missing(true)
                    // Takes effect where the database is created.
                    .auto_vacuum(SqliteAutoVacuum::Incremental)
                    .pragma("journal_size_limit", LARGEST_LOG)
                    .journal_mode(SqliteJournalMode::Wal)
                    .synchronous(SqliteSynchronous::Full),
            )
            .await
            .map_err(|error| StoreError::Open(Box::new(error)))?;
        MIGRATIONS.run(&writer).await.map_err(|error| StoreError::Open(Box::new(error)))?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .test_before_acquire(false)
            .connect_with(options.read_only(true))
            .await
            .map_err(|error| StoreError::Open(Box::new(error)))?;
        let health = Health::of(&writer, file).await?;
        Ok(Self { writer, readers, signals: Signals::default(), intake: Intake::default(), health })
    }
}

/// Milliseconds since 1970, as every time is stored.
fn now() -> i64 {
    Timestamp::now().as_millisecond()
}

fn after(duration: Duration) -> i64 {
    now().saturating_add(i64::try_from(duration.as_millis()).unwrap_or(i64::MAX))
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        // SQLite's primary result codes; the extended ones carry more in their higher bits.
        let code = error
            .as_database_error()
            .and_then(|error| error.code())
            .and_then(|code| code.parse::<i64>().ok())
            .map(|code| code & 0xff);
        match (code, &error) {
            (Some(13), _) => Self::Full(Box::new(error)),
            (Some(11 | 26), _) => Self::Damaged(Box::new(error)),
            // busy, locked, out of memory, read-only, input/output, cannot open
            (Some(5 | 6 | 7 | 8 | 10 | 14), _) => Self::Unavailable(Box::new(error)),
            (None, sqlx::Error::PoolTimedOut | sqlx::Error::PoolClosed | sqlx::Error::Io(_)) => {
                Self::Unavailable(Box::new(error))
            }
            (None, sqlx::Error::ColumnDecode { .. } | sqlx::Error::Decode(_)) => Self::Damaged(Box::new(error)),
            _ => Self::Refused(Box::new(error)),
        }
    }
}

#[async_trait]
impl Store for SqliteStore {
    async fn submit(&self, job: NewJob) -> Result<Submitted> {
        self.health.allow()?;
        self.health.note(intake::submit(self, job).await)
    }

    async fn follow(&self, job: NewFollower) -> Result<Option<Submitted>> {
        self.health.allow()?;
        self.health.note(followers::follow(self, job).await)
    }

    async fn job(&self, id: Uuid) -> Result<Option<JobRecord>> {
        self.health.note(jobs::get(self, id).await)
    }

    async fn standing(&self, id: Uuid) -> Result<Option<Standing>> {
        self.health.note(jobs::standing(self, id).await)
    }

    async fn request(&self, id: Uuid) -> Result<Option<String>> {
        self.health.note(followers::request(self, id).await)
    }

    async fn branch(&self, id: Uuid, increment: u64) -> Result<Option<Origin>> {
        self.health.note(followers::branch(self, id, increment).await)
    }

    async fn explore(&self) -> Result<u64> {
        self.health.allow()?;
        self.health.note(families::explore(self).await)
    }

    async fn jobs(&self, filter: ListFilter) -> Result<Vec<JobRecord>> {
        self.health.note(jobs::list(self, filter).await)
    }

    async fn tally(&self) -> Result<Vec<(Status, u64)>> {
        self.health.note(jobs::tally(self).await)
    }

    async fn increments(&self, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>> {
        self.health.note(increments::read(self, id, after, page).await)
    }

    async fn request_cancel(&self, id: Uuid) -> Result<Option<JobRecord>> {
        self.health.note(jobs::request_cancel(self, id).await)
    }

    async fn delete(&self, id: Uuid) -> Result<bool> {
        self.health.note(jobs::delete(self, id).await)
    }

    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>> {
        self.health.allow()?;
        self.health.note(claims::claim(self, worker, lease).await)
    }

    async fn renew(&self, lease: &Lease, duration: Duration) -> Result<LeaseAnswer> {
        self.health.note(claims::renew(self, lease, duration).await)
    }

    async fn append(&self, lease: &Lease, batch: &Batch, duration: Duration) -> Result<LeaseAnswer> {
        self.health.note(increments::append(self, lease, batch, duration).await)
    }

    async fn finish(&self, lease: &Lease, ending: Ending) -> Result<LeaseAnswer> {
        self.health.note(claims::finish(self, lease, ending).await)
    }

    async fn release(&self, lease: &Lease) -> Result<LeaseAnswer> {
        self.health.note(claims::release(self, lease).await)
    }

    async fn reclaim_expired(&self) -> Result<u64> {
        self.health.note(claims::reclaim_expired(self).await)
    }

    async fn retire(&self, keep: Keep) -> Result<u64> {
        self.health.allow()?;
        self.health.note(jobs::retire(self, keep).await)
    }

    async fn shrink(&self) -> Result<bool> {
        self.health.allow()?;
        self.health.note(health::shrink(self).await)
    }

    async fn check(&self) -> Result<()> {
        self.health.note(health::check(self).await)
    }

    async fn probe(&self) -> Result<()> {
        self.health.allow()?;
        sqlx::query("INSERT INTO heartbeat (id, beat_at) VALUES (1, ?) ON CONFLICT (id) DO UPDATE SET beat_at = excluded.beat_at")
            .bind(now())
            .execute(&self.writer)
            .await?;
        Ok(())
    }

    fn job_changes(&self, id: Uuid) -> watch::Receiver<Change> {
        self.signals.job_changes(id)
    }

    fn queue_changes(&self) -> watch::Receiver<u64> {
        self.signals.queue_changes()
    }

    async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
    }
}

#[cfg(test)]
mod tests {
    use super::SqliteStore;

    /// What has been answered as stored survives a loss of power.
    #[tokio::test]
    async fn every_commit_is_synced() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = SqliteStore::open(&folder.path().join("jobs.db")).await.expect("a store");
        let synchronous: i64 =
            sqlx::query_scalar("PRAGMA synchronous").fetch_one(&store.writer).await.expect("a value");
        assert_eq!(synchronous, 2, "FULL");
        let journal: String =
            sqlx::query_scalar("PRAGMA journal_mode").fetch_one(&store.writer).await.expect("a value");
        assert_eq!(journal, "wal");
    }
}
