//! When contact changes are to be taken together again, after a failure.

use serde::{Deserialize, Serialize};

/// When changes are to be taken together again, after a failure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JoinBackoff {
    /// Steps that are left.
    steps: u32,
    /// Steps after the last failure; 0 where none came before.
    last: u32,
}

impl JoinBackoff {
    /// Whether a step that begins may try.
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

/// Steps after a first failure in which changes are not taken together.
pub(crate) const FIRST_WAIT: u32 = 4;

/// The longest wait.
pub(crate) const MOST_WAIT: u32 = 64;
