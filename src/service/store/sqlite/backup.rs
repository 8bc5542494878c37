//! A copy of a database that others may be writing to.
//!
//! `VACUUM INTO` reads in one transaction, so that the copy is of one moment, and writes no page that is not needed. Until it
//! is whole and checked the copy has another name, one that nobody else has: nothing that is broken off is ever taken for a
//! copy, and nothing that is there already is touched.

use crate::service::store::StoreError;
use crate::service::store::contract::error::Result;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use uuid::Uuid;

const BUSY_TIMEOUT: Duration = Duration::from_secs(30);
/// What the name of an unfinished copy ends with.
const PARTIAL: &str = ".partial";

pub(crate) async fn back_up(file: &Path, copy: &Path) -> Result<()> {
    let partial = beside(copy, &format!(".{}{PARTIAL}", Uuid::now_v7()));
    let made = write(file, &partial).await.and_then(|()| keep(&partial, copy).map_err(unwritten));
    if made.is_err() {
        // Why it could not be made counts for more. What SQLite may have left beside it goes, too.
        for other in ["", "-journal", "-wal", "-shm"] {
            let _ = fs::remove_file(beside(&partial, other));
        }
    }
    made
}

/// A name with something at its end.
fn beside(name: &Path, end: &str) -> PathBuf {
    PathBuf::from([name.as_os_str(), end.as_ref()].join("".as_ref()))
}

async fn write(file: &Path, partial: &Path) -> Result<()> {
    let mut original =
        SqliteConnectOptions::new().filename(file).busy_timeout(BUSY_TIMEOUT).connect().await.map_err(open)?;
    let ours =
        "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('jobs', 'increments', 'heartbeat')";
    let tables: i64 = sqlx::query_scalar(ours).fetch_one(&mut original).await?;
    if tables != 3 {
        return Err(StoreError::Open("it holds no jobs of this program".into()));
    }
    let into = partial.to_str().ok_or_else(|| StoreError::Open("the copy's name is not UTF-8".into()))?;
    // For whoever may read the original, and nobody else, from the first byte on.
    let made = File::create_new(partial).and_then(|made| made.set_permissions(fs::metadata(file)?.permissions()));
    made.map_err(unwritten)?;
    sqlx::query("VACUUM INTO ?").bind(into).execute(&mut original).await.map_err(|error| match error.into() {
        StoreError::Full(source) => StoreError::Open(format!("there is no room for the copy: {source}").into()),
        other => other,
    })?;
    original.close().await?;
    let copied = SqliteConnectOptions::new().filename(partial).read_only(true);
    check(&mut copied.connect().await.map_err(open)?).await
}

async fn check(copy: &mut SqliteConnection) -> Result<()> {
    let found: String = sqlx::query_scalar("PRAGMA integrity_check(1)").fetch_one(copy).await?;
    if found == "ok" { Ok(()) } else { Err(StoreError::Damaged(found.into())) }
}

/// Gives the finished copy its name, so that it has it after a power loss, too.
fn keep(partial: &Path, copy: &Path) -> io::Result<()> {
    File::open(partial)?.sync_all()?;
    // A link takes nothing's place, where renaming would.
    fs::hard_link(partial, copy)?;
    fs::remove_file(partial)?;
    let folder = copy.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(folder)?.sync_all()
}

fn open(error: sqlx::Error) -> StoreError {
    StoreError::Open(Box::new(error))
}

fn unwritten(error: io::Error) -> StoreError {
    StoreError::Open(format!("the copy cannot be written: {error}").into())
}
