//! Backups of a database while other processes write to it.
//!
//! `VACUUM INTO` reads in one transaction, so that the copy is a consistent snapshot, and writes no unused pages. Until the copy
//! is complete and checked it has a unique temporary name: an incomplete copy cannot be mistaken for a backup, and no existing
//! file is overwritten.

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
/// The ending of the name of an incomplete copy.
const PARTIAL: &str = ".partial";

pub(crate) async fn back_up(file: &Path, copy: &Path) -> Result<()> {
    let partial = beside(copy, &format!(".{}{PARTIAL}", Uuid::now_v7()));
    let made = write(file, &partial).await.and_then(|()| keep(&partial, copy).map_err(unwritten));
    if made.is_err() {
        // Errors of the removal are ignored in favour of the first error. Files that SQLite has left beside the copy are removed, too.
        for other in ["", "-journal", "-wal", "-shm"] {
            let _ = fs::remove_file(beside(&partial, other));
        }
    }
    made
}

/// A path with a suffix.
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
    // The permissions of the original, from the first byte on.
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

/// Gives the finished copy its name, durably.
fn keep(partial: &Path, copy: &Path) -> io::Result<()> {
    File::open(partial)?.sync_all()?;
    // A link does not replace an existing file, as a rename would.
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
