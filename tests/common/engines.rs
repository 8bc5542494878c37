//! A database of a test's own, on either engine, and what tests put into one.

use super::postgres;
use super::service::request;
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{self, Batch, JobRecord, Line, Location, NewJob, Submitted, Task};
use sqlx::ConnectOptions;
use sqlx::postgres::PgConnectOptions;
use sqlx::sqlite::SqliteConnectOptions;
use std::str::FromStr;
use std::sync::Arc;
use tempfile::TempDir;
use uuid::Uuid;

pub struct Database {
    pub location: Location,
    _folder: Option<TempDir>,
}

impl Database {
    pub fn sqlite() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self { location: Location::from(&folder.path().join("jobs.db")), _folder: Some(folder) }
    }

    /// `None`, having said so: there is no PostgreSQL.
    pub async fn postgres() -> Option<Self> {
        let url = postgres::shared()?.database().await;
        Some(Self { location: url.as_str().into(), _folder: None })
    }

    /// A handle as another process would have it.
    pub async fn open(&self) -> Arc<dyn Store> {
        store::open(self.location.clone()).await.expect("a store")
    }

    /// Rows of a table.
    pub async fn count(&self, table: &str) -> i64 {
        let count = sqlx::AssertSqlSafe(format!("SELECT count(*) FROM {table}"));
        match &self.location {
            Location::File(file) => {
                let mut connection = SqliteConnectOptions::new().filename(file).connect().await.expect("a connection");
                sqlx::query_scalar(count).fetch_one(&mut connection).await.expect("a count")
            }
            Location::Postgres(url) => {
                let options = PgConnectOptions::from_str(&url.to_string()).expect("a URL without a password");
                let mut connection = options.connect().await.expect("a connection");
                sqlx::query_scalar(count).fetch_one(&mut connection).await.expect("a count")
            }
        }
    }
}

/// Each of these functions as a test on SQLite, and on PostgreSQL where there is one.
#[macro_export]
macro_rules! on_both_engines {
    ($($name:ident),* $(,)?) => {
        mod sqlite {
            $(#[tokio::test(flavor = "multi_thread")]
            async fn $name() {
                super::$name($crate::common::engines::Database::sqlite()).await;
            })*
        }
        mod postgres {
            $(#[tokio::test(flavor = "multi_thread")]
            async fn $name() {
                if let Some(database) = $crate::common::engines::Database::postgres().await {
                    super::$name(database).await;
                }
            })*
        }
    };
}

/// A job that may lose so many workers.
pub fn job(max_attempts: u32) -> NewJob {
    NewJob {
        task: Task::Path,
        owner: None,
        name: Some("queued".to_owned()),
        request: request("queued", 6).to_string(),
        plan: "{}".to_owned(),
        summary: None,
        max_increments: 6,
        max_attempts,
        most_queued: 100,
        priority: 0,
        idempotency_key: None,
        explore: None,
    }
}

pub async fn queued(store: &dyn Store, job: NewJob) -> Uuid {
    match store.submit(job).await.expect("queued") {
        Submitted::Created(job) => job.id,
        other => panic!("{other:?}"),
    }
}

pub async fn found(store: &dyn Store, id: Uuid) -> JobRecord {
    store.job(id).await.expect("an answer").expect("a job")
}

pub fn line(index: u64, body: &str) -> Line {
    Line { index, body: body.to_owned(), branch: None }
}

pub fn batch(lines: &[Line]) -> Batch {
    Batch::from(lines.to_vec())
}
