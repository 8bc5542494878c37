//! The settings of the queue and its workers, all of which can be set when the service is started.

use crate::service::jobs::configuration::limits::Limits;
use crate::service::store::Keep;
use std::time::Duration;

#[derive(Debug, Clone)]
pub struct Settings {
    /// Number of workers, each of which runs one solve at a time; with 0 the process only answers HTTP requests.
    pub workers: usize,
    /// A job that has lost this many workers in a row without storing anything in between fails.
    pub max_attempts: u32,
    /// A worker that has not renewed its lease for this time has lost its job.
    pub lease: Duration,
    /// Increments are stored in batches, at least this often; checkpoints are made at most this often.
    pub flush_interval: Duration,
    /// The largest number of increments in a transaction.
    pub flush_rows: usize,
    /// The interval at which an idle worker looks for jobs that other processes have queued.
    pub poll_interval: Duration,
    /// The interval at which ended jobs that are not to be kept are deleted.
    pub tidy_interval: Duration,
    pub limits: Limits,
    /// Which ended jobs are kept; `None` keeps all.
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
