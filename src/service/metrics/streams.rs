//! Metrics of streams.

use crate::service::metrics::{observe, seconds};
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::Registry;
use std::time::Duration;

#[derive(Debug)]
pub struct Streams {
    open: Gauge,
    lag: Histogram,
}

/// Counts an open stream until it is dropped.
#[derive(Debug)]
pub struct Open(Gauge);

impl Streams {
    pub(super) fn in_registry(registry: &mut Registry) -> Self {
        let streams = Self { open: Gauge::default(), lag: seconds() };
        registry.register("streams_open", "Streams that are open", streams.open.clone());
        let lag = "Seconds from a write of increments to their being handed to a stream that waited for them";
        registry.register("stream_lag_seconds", lag, streams.lag.clone());
        streams
    }

    pub fn open(&self) -> Open {
        self.open.inc();
        Open(self.open.clone())
    }

    /// Records the delay between storing and sending of lines.
    pub fn sent_after(&self, lag: Duration) {
        observe(&self.lag, lag);
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        self.0.dec();
    }
}
