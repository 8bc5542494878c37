//! The metrics of the service, as text for Prometheus.
//!
//! `work` has the metrics of jobs, `streams` of streams, `requests` of calls, `process` of this process. Values that
//! are read at the time of a request are passed in as a [`Reading`]. Labels are few and bounded: statuses, kinds of write,
//! routes of calls; never an id. `jobs` and `http` record the metrics; this module depends neither on them nor on the store.

pub(crate) mod process;
pub(crate) mod requests;
pub(crate) mod streams;
pub(crate) mod work;

use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::Registry;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

pub use requests::Requests;
pub use streams::{Open, Streams};
pub use work::{Solved, Work, Write};

/// The media type of the text.
pub const MEDIA_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// The metrics of a service.
#[derive(Debug)]
pub struct Metrics {
    pub work: Work,
    pub streams: Streams,
    pub requests: Requests,
    now: Now,
    /// Locked as a whole, so that a reading is consistent.
    registry: Mutex<Registry>,
}

/// Values that are read at the time of a request.
#[derive(Debug, Default)]
pub struct Reading {
    /// The number of jobs by status; empty if the store does not answer.
    pub jobs: Vec<(&'static str, u64)>,
    pub workers_alive: usize,
    pub workers_expected: usize,
}

/// The gauges that a reading sets.
#[derive(Debug, Default)]
struct Now {
    jobs: Family<[(&'static str, &'static str); 1], Gauge>,
    workers_alive: Gauge,
    workers_expected: Gauge,
    resident_bytes: Gauge,
    open_files: Gauge,
}

impl Default for Metrics {
    fn default() -> Self {
        let mut registry = Registry::with_prefix("arcslip");
        let (work, streams) = (Work::in_registry(&mut registry), Streams::in_registry(&mut registry));
        let (requests, now) = (Requests::in_registry(&mut registry), Now::in_registry(&mut registry));
        Self { work, streams, requests, now, registry: Mutex::new(registry) }
    }
}

impl Metrics {
    /// # Errors
    /// A metric cannot be written, which would be a defect.
    pub fn text(&self, reading: &Reading) -> Result<String, std::fmt::Error> {
        // The value is consistent wherever a thread that holds the lock could panic.
        let registry = self.registry.lock().unwrap_or_else(PoisonError::into_inner);
        self.now.put(reading);
        let mut text = String::new();
        encode(&mut text, &registry)?;
        Ok(text)
    }
}

impl Now {
    fn in_registry(registry: &mut Registry) -> Self {
        let now = Self::default();
        registry.register("jobs", "Jobs and studies that are stored, by status", now.jobs.clone());
        registry.register("workers_alive", "Workers of this process that are alive", now.workers_alive.clone());
        registry.register("workers_expected", "Workers that this process should have", now.workers_expected.clone());
        registry.register("resident_memory_bytes", "Memory of this process", now.resident_bytes.clone());
        registry.register("open_files", "Open files and connections of this process", now.open_files.clone());
        now
    }

    fn put(&self, reading: &Reading) {
        self.jobs.clear();
        for (status, count) in &reading.jobs {
            self.jobs.get_or_create(&[("status", *status)]).set(gauge(*count));
        }
        self.workers_alive.set(gauge(reading.workers_alive as u64));
        self.workers_expected.set(gauge(reading.workers_expected as u64));
        self.resident_bytes.set(gauge(process::resident_bytes().unwrap_or(0)));
        self.open_files.set(gauge(process::open_files().unwrap_or(0)));
    }
}

fn gauge(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

/// From 0.1 ms to a minute: times of a disk, a queue and a reader.
fn seconds() -> Histogram {
    Histogram::new([
        0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 60.0,
    ])
}

/// From a millisecond to a day: times of waiting in the queue.
fn long_seconds() -> Histogram {
    Histogram::new([0.001, 0.01, 0.1, 0.5, 1.0, 5.0, 10.0, 30.0, 60.0, 300.0, 1800.0, 7200.0, 86_400.0])
}

fn observe(histogram: &Histogram, time: Duration) {
    histogram.observe(time.as_secs_f64());
}
