//! The database file itself: damage, and room that is free in it.
//!
//! Damage that any statement meets, or the look through the whole file at the start, is remembered: nothing new is taken or
//! begun then, because what is written next to damage may make it worse. What can still be read is.

use super::SqliteStore;
use crate::store::{Result, StoreError};
use sqlx::sqlite::SqlitePool;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// As `PRAGMA auto_vacuum` names it.
const INCREMENTAL: i64 = 2;
/// Free pages that are left for what comes next ...
const SPARE_PAGES: i64 = 256;
/// ... and that are given back at a time.
const PAGES_AT_ONCE: i64 = 1024;

#[derive(Debug)]
pub(super) struct Health {
    damaged: AtomicBool,
    shrinks: bool,
    file: PathBuf,
    identity: Identity,
}

/// Which file it is, whatever its name.
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
        Ok(Self { damaged: AtomicBool::new(false), shrinks, file: file.to_owned(), identity: identity(file) })
    }

    /// # Errors
    /// Damage was met before, or the file is not where it was: what is written now would be lost with it.
    pub fn allow(&self) -> Result<()> {
        if self.damaged.load(Ordering::Relaxed) {
            return Err(StoreError::Damaged("damage was met before; nothing is written".into()));
        }
        if identity(&self.file) != self.identity {
            return Err(StoreError::Unavailable("the database's file has been removed or replaced".into()));
        }
        Ok(())
    }

    /// Remembers damage of the file; a row that cannot be read is a matter of that row.
    pub fn note<T>(&self, answer: Result<T>) -> Result<T> {
        if let Err(StoreError::Damaged(source)) = &answer
            && source.downcast_ref::<sqlx::Error>().is_some_and(|error| error.as_database_error().is_some())
        {
            self.damaged.store(true, Ordering::Relaxed);
        }
        answer
    }
}

pub(super) async fn check(store: &SqliteStore) -> Result<()> {
    let found: String = sqlx::query_scalar("PRAGMA quick_check(1)").fetch_one(&store.readers).await?;
    if found == "ok" {
        return Ok(());
    }
    store.health.damaged.store(true, Ordering::Relaxed);
    Err(StoreError::Damaged(found.into()))
}

pub(super) async fn shrink(store: &SqliteStore) -> Result<bool> {
    if !store.health.shrinks || free_pages(store).await? <= SPARE_PAGES {
        return Ok(false);
    }
    // One page a step: all of them have to be taken.
    let vacuum = sqlx::AssertSqlSafe(format!("PRAGMA incremental_vacuum({PAGES_AT_ONCE})"));
    sqlx::query(vacuum).fetch_all(&store.writer).await?;
    Ok(free_pages(store).await? > SPARE_PAGES)
}

async fn free_pages(store: &SqliteStore) -> Result<i64> {
    Ok(sqlx::query_scalar("PRAGMA freelist_count").fetch_one(&store.writer).await?)
}
