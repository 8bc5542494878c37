//! The database file: its integrity and its free space.

use crate::service::store::StoreError;
use crate::service::store::contract::error::Result;
use crate::service::store::sqlite::SqliteEngine;
use sqlx::sqlite::SqlitePool;
use std::path::{Path, PathBuf};

/// The value of `PRAGMA auto_vacuum`.
const INCREMENTAL: i64 = 2;
/// Free pages that are kept for later writes.
const SPARE_PAGES: i64 = 256;
/// Free pages that are returned at a time.
const PAGES_AT_ONCE: i64 = 1024;

#[derive(Debug)]
pub(super) struct Health {
    shrinks: bool,
    file: PathBuf,
    identity: Identity,
}

/// The identity of the file, independent of its name.
type Identity = Option<(u64, u64)>;

fn identity(file: &Path) -> Identity {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        std::fs::metadata(file).ok().map(|found| (found.dev(), found.ino()))
    }
    #[cfg(not(unix))]
    {
        std::fs::metadata(file).ok().map(|_| (0, 0))
    }
}

impl Health {
    pub async fn of(writer: &SqlitePool, file: &Path) -> Result<Self> {
        let mode: i64 = sqlx::query_scalar("PRAGMA auto_vacuum").fetch_one(writer).await?;
        let shrinks = mode == INCREMENTAL;
        if !shrinks {
            tracing::info!(
                "the database is of an earlier version and does not shrink; with the service stopped, once: \
                 sqlite3 FILE 'PRAGMA auto_vacuum = INCREMENTAL; VACUUM'"
            );
        }
        Ok(Self { shrinks, file: file.to_owned(), identity: identity(file) })
    }

    /// # Errors
    /// The file has been moved or deleted, and writes would be lost with it.
    pub fn allow(&self) -> Result<()> {
        if identity(&self.file) != self.identity {
            return Err(StoreError::Unavailable("the database's file has been removed or replaced".into()));
        }
        Ok(())
    }
}

pub(super) async fn check(engine: &SqliteEngine) -> Result<()> {
    let found: String = sqlx::query_scalar("PRAGMA quick_check(1)").fetch_one(&engine.readers).await?;
    if found == "ok" {
        return Ok(());
    }
    Err(StoreError::Damaged(found.into()))
}

pub(super) async fn shrink(engine: &SqliteEngine) -> Result<bool> {
    if !engine.health.shrinks || free_pages(engine).await? <= SPARE_PAGES {
        return Ok(false);
    }
    // The statement frees one page per step: all rows have to be read.
    let vacuum = sqlx::AssertSqlSafe(format!("PRAGMA incremental_vacuum({PAGES_AT_ONCE})"));
    sqlx::query(vacuum).fetch_all(&engine.writer).await?;
    Ok(free_pages(engine).await? > SPARE_PAGES)
}

async fn free_pages(engine: &SqliteEngine) -> Result<i64> {
    Ok(sqlx::query_scalar("PRAGMA freelist_count").fetch_one(&engine.writer).await?)
}
