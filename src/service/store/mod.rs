//! What is kept: jobs, their increments, and who is working on what.
//!
//! [`Store`] is the whole boundary: above it nobody knows SQL, below it nobody knows HTTP or how a path is traced.
//! [`record`](contract::record) holds what goes in and out, [`signals`](contract::signals) wakes those who wait for a change, `announcements` is what other
//! processes are told of them; [`sql`] is what is said to both engines, [`sqlite`] (a file of this machine) and [`postgres`]
//! (a server that many machines share); [`location`](contract::location) says which, [`faults`] what their errors mean. Called by `jobs` (which writes) and by `http` (which reads).

pub mod contract;
pub(crate) mod faults;
pub(crate) mod postgres;
pub(crate) mod sql;
pub(crate) mod sqlite;

use crate::service::store::contract::error::Result;
use std::path::Path;
use std::sync::Arc;

pub use contract::error::StoreError;
pub use contract::interface::Store;
pub use contract::location::Location;
pub use contract::record::{
    Batch, Branch, Checkpoint, Claim, Ending, JobRecord, Keep, Lease, LeaseAnswer, Line, ListFilter, Listed,
    Membership, NewFollower, NewJob, NewRun, NewSweep, Origin, Page, Parent, Retried, RunOf, Standing, Status,
    Submitted, Task,
};

pub use contract::signals::Change;

/// Copies the database in that file, as it is at one moment, to a file that is not there yet, and checks the copy. Others may
/// write meanwhile.
pub async fn back_up(file: &Path, copy: &Path) -> Result<()> {
    sqlite::backup::back_up(file, copy).await
}

/// Opens (and creates, where it is a file, and migrates) the database there.
///
/// # Errors
/// [`StoreError::Open`], which says what would do, and no password.
pub async fn open(location: impl Into<Location>) -> Result<Arc<dyn Store>> {
    Ok(match location.into() {
        Location::File(file) => Arc::new(sqlite::SqliteEngine::open(&file).await?),
        Location::Postgres(url) => Arc::new(postgres::PostgresEngine::open(&url).await?),
    })
}
