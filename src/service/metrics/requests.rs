//! Metrics of calls: their number, and the time to the head of the answer.

use crate::service::metrics::{observe, seconds};
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::Registry;
use std::time::Duration;

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Answered {
    method: &'static str,
    route: String,
    status: u16,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Route {
    method: &'static str,
    route: String,
}

#[derive(Debug)]
pub struct Requests {
    answered: Family<Answered, Counter>,
    seconds: Family<Route, Histogram, fn() -> Histogram>,
}

impl Requests {
    pub(super) fn in_registry(registry: &mut Registry) -> Self {
        let requests = Self { answered: Family::default(), seconds: Family::new_with_constructor(seconds) };
        registry.register("http_requests", "Calls that were answered", requests.answered.clone());
        let took = "Seconds until the head of an answer; a stream's body is not counted";
        registry.register("http_request_seconds", took, requests.seconds.clone());
        requests
    }

    /// Counts an answer. `route` is the pattern of the address, not the address itself, which bounds the number of labels.
    pub fn answered(&self, method: &str, route: Option<&str>, status: u16, took: Duration) {
        const METHODS: [&str; 7] = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"];
        let method = METHODS.into_iter().find(|known| *known == method).unwrap_or("other");
        let route = route.unwrap_or("none").to_owned();
        observe(&self.seconds.get_or_create(&Route { method, route: route.clone() }), took);
        self.answered.get_or_create(&Answered { method, route, status }).inc();
    }
}
