//! How the queue behaves; every number here can be set by whoever starts the service.

use std::time::Duration;

#[derive(Debug, Clone)]
pub struct Settings {
    /// Solves at a time; 0 answers HTTP only.
    pub workers: usize,
    /// Times a job may lose its worker before it fails.
    pub max_attempts: u32,
    /// A worker that has not been heard of for so long has lost its job.
    pub lease: Duration,
    /// Increments wait so long at most for others to be stored with.
    pub flush_interval: Duration,
    /// Increments of one transaction.
    pub flush_rows: usize,
    /// How often an idle worker looks for jobs that another process queued.
    pub poll_interval: Duration,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            workers: 2,
            max_attempts: 3,
            lease: Duration::from_secs(10),
            flush_interval: Duration::from_millis(20),
            flush_rows: 500,
            poll_interval: Duration::from_secs(1),
        }
    }
}
