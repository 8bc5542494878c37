//! SQLite: one connection that writes, a pool that reads.
//!
//! With several writers the worst claim waits an order of magnitude longer at the same throughput, so writes queue for
//! the one connection here rather than for SQLite's lock. The log is write-ahead, and every commit is synced: what a
//! client was told is stored survives a power loss.

mod claims;
mod families;
mod followers;
mod increments;
mod jobs;
mod rows;

use super::signals::Signals;
use super::{
    Claim, Ending, JobRecord, Lease, LeaseAnswer, Line, ListFilter, NewFollower, NewJob, Origin, Page, Result, Store,
    StoreError, Submitted,
};
use async_trait::async_trait;
use jiff::Timestamp;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous};
use std::path::Path;
use std::time::Duration;
use tokio::sync::watch;
use uuid::Uuid;

static MIGRATIONS: sqlx::migrate::Migrator = sqlx::migrate!("./migrations");

const READERS: u32 = 4;
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(15);

pub struct SqliteStore {
    writer: SqlitePool,
    readers: SqlitePool,
    signals: Signals,
}

impl SqliteStore {
    pub async fn open(file: &Path) -> Result<Self> {
        let options = SqliteConnectOptions::new().filename(file).busy_timeout(BUSY_TIMEOUT).foreign_keys(true);
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .idle_timeout(None)
            .max_lifetime(None)
            .connect_with(
                options
                    .clone()
                    .create_if_missing(true)
                    .journal_mode(SqliteJournalMode::Wal)
                    .synchronous(SqliteSynchronous::Full),
            )
            .await
            .map_err(|error| StoreError::Open(Box::new(error)))?;
        MIGRATIONS.run(&writer).await.map_err(|error| StoreError::Open(Box::new(error)))?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .connect_with(options.read_only(true))
            .await
            .map_err(|error| StoreError::Open(Box::new(error)))?;
        Ok(Self { writer, readers, signals: Signals::default() })
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
        jobs::submit(self, job).await
    }

    async fn follow(&self, job: NewFollower) -> Result<Option<Submitted>> {
        followers::follow(self, job).await
    }

    async fn job(&self, id: Uuid) -> Result<Option<JobRecord>> {
        jobs::get(self, id).await
    }

    async fn request(&self, id: Uuid) -> Result<Option<String>> {
        followers::request(self, id).await
    }

    async fn branch(&self, id: Uuid, increment: u64) -> Result<Option<Origin>> {
        followers::branch(self, id, increment).await
    }

    async fn explore(&self) -> Result<u64> {
        families::explore(self).await
    }

    async fn jobs(&self, filter: ListFilter) -> Result<Vec<JobRecord>> {
        jobs::list(self, filter).await
    }

    async fn increments(&self, id: Uuid, after: Option<u64>, page: Page) -> Result<Vec<Line>> {
        increments::read(self, id, after, page).await
    }

    async fn request_cancel(&self, id: Uuid) -> Result<Option<JobRecord>> {
        jobs::request_cancel(self, id).await
    }

    async fn delete(&self, id: Uuid) -> Result<bool> {
        jobs::delete(self, id).await
    }

    async fn claim(&self, worker: &str, lease: Duration) -> Result<Option<Claim>> {
        claims::claim(self, worker, lease).await
    }

    async fn renew(&self, lease: &Lease, duration: Duration) -> Result<LeaseAnswer> {
        claims::renew(self, lease, duration).await
    }

    async fn append(&self, lease: &Lease, lines: &[Line], duration: Duration) -> Result<LeaseAnswer> {
        increments::append(self, lease, lines, duration).await
    }

    async fn finish(&self, lease: &Lease, ending: Ending) -> Result<LeaseAnswer> {
        claims::finish(self, lease, ending).await
    }

    async fn release(&self, lease: &Lease) -> Result<LeaseAnswer> {
        claims::release(self, lease).await
    }

    async fn reclaim_expired(&self) -> Result<u64> {
        claims::reclaim_expired(self).await
    }

    async fn probe(&self) -> Result<()> {
        sqlx::query("INSERT INTO heartbeat (id, beat_at) VALUES (1, ?) ON CONFLICT (id) DO UPDATE SET beat_at = excluded.beat_at")
            .bind(now())
            .execute(&self.writer)
            .await?;
        Ok(())
    }

    fn job_changes(&self, id: Uuid) -> watch::Receiver<u64> {
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
