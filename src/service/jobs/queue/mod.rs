//! The operations on jobs: who calls, how requests are checked, and what is queued, read, cancelled and deleted.

pub mod caller;
pub mod checks;
pub mod curves;
pub mod demonstration;
pub mod error;
pub mod fair_semaphore;
pub mod follow;
pub mod jobs;
pub mod studies;
pub mod submission;
pub mod sweeps;
