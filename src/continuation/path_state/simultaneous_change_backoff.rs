//! Waiting time before contact changes are treated together again after a failure.

use serde::{Deserialize, Serialize};

/// Waiting time before changes are treated together again after a failure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JoinBackoff {
    /// Remaining steps.
    steps: u32,
    /// Waiting time, in steps, after the last failure; 0 where there was none.
    last: u32,
}

impl JoinBackoff {
    /// Whether the waiting time is over at the beginning of a step; counts the step.
    pub fn is_over(&mut self) -> bool {
        let over = self.steps == 0;
        self.steps = self.steps.saturating_sub(1);
        over
    }

    pub fn note(&mut self, success: bool) {
        self.last = if success { 0 } else { (2 * self.last).clamp(FIRST_WAIT, MOST_WAIT) };
        self.steps = self.last;
    }
}

/// Steps after a first failure in which changes are not treated together.
pub(crate) const FIRST_WAIT: u32 = 4;

/// Longest waiting time, in steps.
pub(crate) const MOST_WAIT: u32 = 64;
