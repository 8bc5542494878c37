//! SQLite: one connection for writes, and a pool of connections for reads.
//!
//! With several writing connections the slowest claim takes an order of magnitude longer at the same throughput; therefore
//! writes wait for the connection here instead of for SQLite's lock. The log is write-ahead, and every commit is synced: an
//! acknowledged write survives a power loss.

pub(crate) mod backup;
pub(crate) mod dialect;
pub(crate) mod health;
pub(crate) mod intake;

use crate::service::store::contract::error::{Result, Source};
use crate::service::store::contract::signals::Signals;
use crate::service::store::sql::engine::Engine;
use crate::service::store::sql::migrations::{MigrationFile, migration_files, migrator};
use crate::service::store::sql::store::SqlStore;
use crate::service::store::{NewJob, StoreError, Submitted};
use async_trait::async_trait;
use health::Health;
use intake::Intake;
use sqlx::Connection;
use sqlx::sqlite::{
    Sqlite, SqliteAutoVacuum, SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use std::path::Path;
use std::time::Duration;

const MIGRATIONS: &[MigrationFile] = migration_files![
    "sqlite":
    "0001_jobs_and_increments",
    "0002_following",
    "0003_studies",
    "0004_checkpoints",
    "0005_limits",
    "0006_owners",
    "0007_long_queues",
    "0008_sweeps",
    "0009_summaries",
    "0010_turns",
    "0011_counted_losses",
    "0012_responses",
    "0013_changes",
    "0014_refinement",
    "0015_curves",
];

const READERS: u32 = 4;
const BUSY_TIMEOUT: Duration = Duration::from_secs(5);
/// Size to which the write-ahead log is truncated after a checkpoint, in bytes.
const LARGEST_LOG: &str = "67108864";
const ACQUIRE_TIMEOUT: Duration = Duration::from_secs(15);

pub struct SqliteEngine {
    writer: SqlitePool,
    readers: SqlitePool,
    signals: Signals,
    intake: Intake,
    health: Health,
}

impl SqliteEngine {
    pub async fn open(file: &Path) -> Result<SqlStore<Self>> {
        // Always a file: names such as `:memory:` have another meaning for SQLite.
        let file = &std::path::absolute(file).map_err(|error| StoreError::Open(Box::new(error)))?;
        let options = SqliteConnectOptions::new().filename(file).busy_timeout(BUSY_TIMEOUT).foreign_keys(true);
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .idle_timeout(None)
            .max_lifetime(None)
            // A ping before every use is of no use for a file, and costs as much as a statement.
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
                    // Only takes effect when the database is created.
                    .auto_vacuum(SqliteAutoVacuum::Incremental)
                    .pragma("journal_size_limit", LARGEST_LOG)
                    .journal_mode(SqliteJournalMode::Wal)
                    .synchronous(SqliteSynchronous::Full),
            )
            .await
            .map_err(|error| StoreError::Open(Box::new(error)))?;
        migrator(MIGRATIONS).run(&writer).await.map_err(|error| StoreError::Open(Box::new(error)))?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .acquire_timeout(ACQUIRE_TIMEOUT)
            .test_before_acquire(false)
            .connect_with(options.read_only(true))
            .await
            .map_err(|error| StoreError::Open(Box::new(error)))?;
        let health = Health::of(&writer, file).await?;
        let (signals, intake) = (Signals::default(), Intake::default());
        Ok(SqlStore::over(Self { writer, readers, signals, intake, health }))
    }
}

/// Classifies a result code of SQLite by its primary code, the lower byte of an extended one.
pub(super) fn fault(code: &str) -> fn(Source) -> StoreError {
    match code.parse::<i64>().map(|code| code & 0xff) {
        Ok(13) => StoreError::Full,
        Ok(11 | 26) => StoreError::Damaged,
        // busy, locked, out of memory, read-only, input/output, cannot open
        Ok(5 | 6 | 7 | 8 | 10 | 14) => StoreError::Unavailable,
        _ => StoreError::Refused,
    }
}

#[async_trait]
impl Engine for SqliteEngine {
    type Dialect = Sqlite;
    const PATIENCE: Option<Duration> = None;

    fn readers(&self) -> &SqlitePool {
        &self.readers
    }

    fn writers(&self) -> &SqlitePool {
        &self.writer
    }

    fn signals(&self) -> &Signals {
        &self.signals
    }

    fn allow(&self) -> Result<()> {
        self.health.allow()
    }

    async fn submit(&self, job: NewJob) -> Result<Submitted> {
        intake::submit(self, job).await
    }

    async fn shrink(&self) -> Result<bool> {
        health::shrink(self).await
    }

    async fn check(&self) -> Result<()> {
        health::check(self).await
    }

    async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
    }
}

#[cfg(test)]
mod tests {
    use super::SqliteEngine;
    use crate::service::store::contract::interface::Store;
    use crate::service::store::sql::claims::TAKE;
    use crate::service::store::sql::dialect::Dialect;
    use crate::service::store::sql::turns::{PARTNER, next_turn};
    use crate::service::store::{Batch, LeaseAnswer, Line, NewJob, StoreError, Task};
    use sqlx::{Row, Sqlite};
    use std::time::Duration;

    #[test]
    fn every_migration_is_listed() {
        crate::service::store::sql::migrations::assert_complete("sqlite", super::MIGRATIONS);
    }

    /// Acknowledged writes survive a power loss.
    #[tokio::test]
    async fn every_commit_is_synced() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = SqliteEngine::open(&folder.path().join("jobs.db")).await.expect("a store");
        let synchronous: i64 =
            sqlx::query_scalar("PRAGMA synchronous").fetch_one(&store.engine.writer).await.expect("a value");
        assert_eq!(synchronous, 2, "FULL");
        let journal: String =
            sqlx::query_scalar("PRAGMA journal_mode").fetch_one(&store.engine.writer).await.expect("a value");
        assert_eq!(journal, "wal");
    }

    /// SQLite has rolled back by itself then, and a rollback finds no transaction: that is not what is told.
    #[tokio::test]
    async fn a_full_disk_is_told_as_what_it_is_and_leaves_the_connection_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = SqliteEngine::open(&folder.path().join("jobs.db")).await.expect("a store");
        let job = NewJob {
            task: Task::Path,
            owner: None,
            name: None,
            request: "{}".to_owned(),
            plan: "{}".to_owned(),
            summary: None,
            max_increments: 9,
            max_attempts: 3,
            most_queued: 9,
            priority: 0,
            idempotency_key: None,
            explore: None,
        };
        store.submit(job).await.expect("queued");
        let minute = Duration::from_secs(60);
        let lease = store.claim("worker", minute).await.expect("a claim").expect("a job").lease;
        let writer = &store.engine.writer;
        let pages: i64 = sqlx::query_scalar("PRAGMA page_count").fetch_one(writer).await.expect("a value");
        let bound = sqlx::AssertSqlSafe(format!("PRAGMA max_page_count = {}", pages + 4));
        sqlx::query(bound).execute(writer).await.expect("it is bounded");
        let line = |body: String| Batch::from(vec![Line { index: 0, body, branch: None }]);
        let full = store.append(&lease, &line("x".repeat(1 << 20)), minute).await;
        assert!(matches!(full, Err(StoreError::Full(_))), "{full:?}");
        // The bound was the connection's, which is another now.
        let held = store.append(&lease, &line("{}".to_owned()), minute).await;
        assert!(matches!(held, Ok(LeaseAnswer::Held { .. })), "{held:?}");
    }

    /// Without its index every claim sorted all that waited: 13 ms with 10,000 jobs. Nor does who is queued look at the others.
    #[tokio::test]
    async fn neither_a_claim_nor_a_submission_looks_at_the_whole_queue() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = SqliteEngine::open(&folder.path().join("jobs.db")).await.expect("a store");
        let next = concat!("SELECT ", next_turn!("$1", "$2"), " AS turn");
        for statement in [TAKE, PARTNER, next] {
            let explained = Sqlite::said(&format!("EXPLAIN QUERY PLAN {statement}"));
            let plan = sqlx::query(explained).fetch_all(&store.engine.writer).await.expect("a plan");
            let steps: Vec<String> = plan.iter().map(|step| step.get("detail")).collect();
            assert!(steps.iter().any(|step| step.contains("jobs_waiting")), "{steps:?}");
            let of_jobs = |step: &&String| step.contains("jobs") && !step.contains("USING");
            assert_eq!(steps.iter().find(of_jobs), None, "{steps:?}");
            // Two and two rows are compared with each other, and nothing else is sorted.
            let sorts = steps.iter().filter(|step| step.contains("TEMP B-TREE")).count();
            assert!(sorts <= if statement == PARTNER { 2 } else { 0 }, "{steps:?}");
        }
    }
}
