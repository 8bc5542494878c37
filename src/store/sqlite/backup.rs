//! A copy of a database that others may be writing to.
//!
//! `VACUUM INTO` reads in one transaction, so that the copy is of one moment, and writes no page that is not needed.

use crate::store::{Result, StoreError};
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection};
use std::path::Path;
use std::time::Duration;

const BUSY_TIMEOUT: Duration = Duration::from_secs(30);

pub(in crate::store) async fn back_up(file: &Path, copy: &Path) -> Result<()> {
    let open = |error| StoreError::Open(Box::new(error));
    let copied = SqliteConnectOptions::new().filename(file).busy_timeout(BUSY_TIMEOUT);
    let mut original = copied.connect().await.map_err(open)?;
    let into = copy.to_str().ok_or_else(|| StoreError::Open("the copy's name is not UTF-8".into()))?;
    sqlx::query("VACUUM INTO ?").bind(into).execute(&mut original).await?;
    original.close().await?;
    // Where the copy can be lost by a power loss yet, whoever takes it is told nothing.
    std::fs::File::open(copy).and_then(|copy| copy.sync_all()).map_err(|error| StoreError::Open(Box::new(error)))?;
    let copied = SqliteConnectOptions::new().filename(copy).read_only(true);
    check(&mut copied.connect().await.map_err(open)?).await
}

async fn check(copy: &mut SqliteConnection) -> Result<()> {
    let found: String = sqlx::query_scalar("PRAGMA integrity_check(1)").fetch_one(copy).await?;
    if found == "ok" { Ok(()) } else { Err(StoreError::Damaged(found.into())) }
}
