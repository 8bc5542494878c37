//! The intervals between checkpoints.

use std::time::{Duration, Instant};

/// At most one part in this many of the solver's time is spent on checkpoints.
const SHARE: u32 = 20;

/// Schedules checkpoints: each at least a given time after the previous one, and at least `SHARE` times the time that the
/// previous one took. Small paths make about one per batch; large paths spend a small part of their time on checkpoints.
#[derive(Debug)]
pub struct Cadence {
    least: Duration,
    due: Option<Instant>,
}

impl Cadence {
    /// The first one is due at once.
    pub fn from_now(least: Duration) -> Self {
        Self { least, due: Some(Instant::now()) }
    }

    /// The first one is due after `least`.
    pub fn after(least: Duration) -> Self {
        Self { least, due: Instant::now().checked_add(least) }
    }

    pub fn is_due(&self) -> bool {
        self.due.is_some_and(|due| Instant::now() >= due)
    }

    /// A checkpoint has been made, which took from `began` until now.
    pub fn done(&mut self, began: Instant) {
        self.due = Instant::now().checked_add(self.least.max(SHARE * began.elapsed()));
    }

    pub fn never_again(&mut self) {
        self.due = None;
    }
}
