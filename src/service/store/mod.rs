//! The store of jobs, increments and leases.
//!
//! [`Store`] is the interface: its callers know no SQL, and its implementation knows neither HTTP nor the path tracer.
//! [`record`](contract::record) has the stored records, [`signals`](contract::signals) wakes readers after a change and
//! `announcements` tells other processes. `sql` is the implementation over both engines, `sqlite` (a file on this machine)
//! and `postgres` (a server that many machines share); `location` selects the engine, `faults`
//! classifies its errors. Called by `jobs`, which writes, and by `http`, which reads.

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
    Batch, Branch, Checkpoint, Claim, Ending, FeedEntry, FeedPage, FeedPosition, JobRecord, Keep, Lease, LeaseAnswer,
    Line, ListFilter, Listed, Membership, NewFollower, NewJob, NewRun, NewSweep, Origin, Page, Parent, Retried, RunOf,
    Standing, Status, Submitted, SweepRefinement, Task,
};

pub use contract::signals::Change;

/// Copies the database file to a new file, as a consistent snapshot, and checks the copy. Other processes may write meanwhile.
pub async fn back_up(file: &Path, copy: &Path) -> Result<()> {
    sqlite::backup::back_up(file, copy).await
}

/// Opens the database at a location and migrates it; a file is created if it does not exist.
///
/// # Errors
/// [`StoreError::Open`], whose message says what is expected and holds no password.
pub async fn open(location: impl Into<Location>) -> Result<Arc<dyn Store>> {
    Ok(match location.into() {
        Location::File(file) => Arc::new(sqlite::SqliteEngine::open(&file).await?),
        Location::Postgres(url) => Arc::new(postgres::PostgresEngine::open(&url).await?),
    })
}
