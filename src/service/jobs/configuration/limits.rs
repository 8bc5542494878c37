//! Limits on the requests that a service accepts and on the resources that a job may use. They can only be stricter than the
//! limits of the [model](crate::model::input::limits).

use crate::model::input::limits::{MAX_CONTACTS, MAX_INCREMENTS, USUAL_TEXT_BYTES};
use crate::model::{InputError, InputErrors, Model};
use crate::resources::budget::Bounds;
use std::fmt;
use std::time::Duration;

/// Total bytes of the requests of a sweep's runs, each of which is stored with its job.
pub const MOST_SWEEP_BYTES: usize = 256 << 20;

/// The limits that can be set when the service is started. A request that exceeds one is refused with its name; a job that
/// exceeds one ends `stopped`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Jobs and studies in the queue; the jobs of explorations count, but are not refused.
    pub queued: u64,
    /// Bytes of the body of a request.
    pub body_bytes: usize,
    pub nodes: usize,
    pub elements: usize,
    pub contacts: usize,
    /// `max_increments` of a job.
    pub increments: u64,
    /// Time for the check of a request, without its waits for other checks.
    pub check_time: Duration,
    /// Total running time of a job or study, without its waits in the queue.
    pub wall_time: Duration,
    /// Stored bytes of a job or study: increments, and points from which directions can be followed.
    pub stored_bytes: u64,
    /// Bounds on the memory and work of a solve or check.
    pub bounds: Bounds,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            queued: 20_000,
            body_bytes: USUAL_TEXT_BYTES,
            nodes: 100_000,
            elements: 250_000,
            contacts: MAX_CONTACTS,
            increments: MAX_INCREMENTS,
            check_time: Duration::from_secs(120),
            wall_time: Duration::from_secs(24 * 3600),
            stored_bytes: 8 << 30,
            bounds: Bounds::default(),
        }
    }
}

impl Limits {
    /// # Errors
    /// Every size that exceeds its limit.
    pub fn check(&self, model: &Model, max_increments: u64) -> Result<(), InputErrors> {
        let sizes = [
            ("/model/nodes", "nodes", model.nodes.len(), self.nodes),
            ("/model/elements", "elements", model.elements.len(), self.elements),
            ("/model/contacts", "contacts", model.contacts.len(), self.contacts),
        ];
        let past = sizes.into_iter().filter(|(_, _, found, most)| found > most);
        let past = past.map(|(pointer, what, found, most)| {
            InputError::new(pointer, format!("found {found} {what}; this service takes at most {most}"))
        });
        let errors: Vec<InputError> =
            past.chain(self.past_increments("/analysis/max_increments", max_increments)).collect();
        if errors.is_empty() { Ok(()) } else { Err(InputErrors(errors)) }
    }

    pub fn past_increments(&self, pointer: &str, found: u64) -> Option<InputError> {
        (found > self.increments)
            .then(|| InputError::new(pointer, format!("found {found}; this service takes at most {}", self.increments)))
    }

    /// The error text of a job that was stopped at a limit.
    pub fn sentence(&self, reached: Reached) -> String {
        match reached {
            Reached::Time => {
                format!("the job has run for {:.3} s, the limit of this service", self.wall_time.as_secs_f64())
            }
            Reached::Storage => {
                format!("the job would store more than {} bytes, the limit of this service", self.stored_bytes)
            }
        }
    }
}

/// A limit at which a running job is stopped; its stored increments are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    Time,
    Storage,
}

impl Reached {
    /// The stop reason.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time_limit",
            Self::Storage => "storage_limit",
        }
    }
}

/// The table of the OpenAPI description.
impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "| limit | value | past it |\n|---|---|---|")?;
        let refused = "refused, 422";
        let Bounds { memory, factor_entries, factor_work } = self.bounds;
        let rows = [
            ("bytes of a body", self.body_bytes.to_string(), "refused, 413"),
            ("nodes", self.nodes.to_string(), refused),
            ("elements", self.elements.to_string(), refused),
            ("contacts", self.contacts.to_string(), refused),
            ("`max_increments`", self.increments.to_string(), refused),
            ("bytes of the requests of a sweep's runs", MOST_SWEEP_BYTES.to_string(), refused),
            ("jobs and studies that wait", self.queued.to_string(), "refused, 429 with `Retry-After`"),
            ("seconds that a request is checked for", self.check_time.as_secs_f64().to_string(), refused),
            ("entries of a factor of the stiffness", factor_entries.to_string(), refused),
            ("multiplications of its factorisation", factor_work.to_string(), refused),
            ("bytes that a solve holds at a time", memory.to_string(), "`stopped`, `memory_limit`"),
            ("seconds that a job runs", self.wall_time.as_secs_f64().to_string(), "`stopped`, `time_limit`"),
            ("bytes stored of a job", self.stored_bytes.to_string(), "`stopped`, `storage_limit`"),
        ];
        rows.into_iter().try_for_each(|(limit, value, past)| writeln!(f, "| {limit} | {value} | {past} |"))
    }
}
