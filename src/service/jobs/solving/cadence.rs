//! When a path is put down again.

use std::time::{Duration, Instant};

/// One part of so many of the solver's time goes into putting it down, at most.
const SHARE: u32 = 20;

/// No sooner than a given time after the one before, and no sooner than [`SHARE`] times what that one took: small paths are
/// put down about once a batch, large ones spend a small part of their time on it.
#[derive(Debug)]
pub struct Cadence {
    least: Duration,
    due: Option<Instant>,
}

impl Cadence {
    /// Due at once.
    pub fn from_now(least: Duration) -> Self {
        Self { least, due: Some(Instant::now()) }
    }

    /// Due for the first time after `least`.
    pub fn after(least: Duration) -> Self {
        Self { least, due: Instant::now().checked_add(least) }
    }

    pub fn is_due(&self) -> bool {
        self.due.is_some_and(|due| Instant::now() >= due)
    }

    /// It was done, which took from `began` until now.
    pub fn done(&mut self, began: Instant) {
        self.due = Instant::now().checked_add(self.least.max(SHARE * began.elapsed()));
    }

    pub fn never_again(&mut self) {
        self.due = None;
    }
}
