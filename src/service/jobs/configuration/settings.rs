//! How the queue behaves; every number here can be set by whoever starts the service.

use crate::service::jobs::configuration::limits::Limits;
use crate::service::store::Keep;
use std::time::Duration;

#[derive(Debug, Clone)]
pub struct Settings {
    /// Solves at a time; 0 answers HTTP only.
    pub workers: usize,
    /// A job that has lost so many workers in a row, with nothing stored between, fails.
    pub max_attempts: u32,
    /// A worker that has not been heard of for so long has lost its job.
    pub lease: Duration,
    /// Increments wait so long at most for others to be stored with, and a path is put down no more often.
    pub flush_interval: Duration,
    /// Increments of one transaction.
    pub flush_rows: usize,
    /// How often an idle worker looks for jobs that another process queued.
    pub poll_interval: Duration,
    /// How often ended jobs are looked through for those that are not to be kept.
    pub tidy_interval: Duration,
    pub limits: Limits,
    /// Which ended jobs are kept; all, where this is not said.
    pub keep: Option<Keep>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            workers: 2,
            max_attempts: 3,
            lease: Duration::from_secs(10),
            flush_interval: Duration::from_millis(20),
            flush_rows: 2000,
            poll_interval: Duration::from_secs(1),
            tidy_interval: Duration::from_secs(30),
            limits: Limits::default(),
            keep: None,
        }
    }
}
