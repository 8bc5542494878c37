//! Points from which another direction can be followed, on their way to the store and back.
//!
//! The states that a path has passed (for telling a cycle) are stored once: each branch with those that are new since the
//! one before, and reading one gathers them.

use super::solver::Beginning;
use crate::judged::JudgedCheckpoint;
use crate::store::{Branch, Origin, Parent};

/// Makes branches of a path's checkpoints, in order.
#[derive(Debug, Default)]
pub struct Recorder {
    stage: usize,
    /// How much of the running stage's trail has been written.
    written: u64,
}

impl Recorder {
    pub fn branch(&mut self, mut checkpoint: JudgedCheckpoint, alternatives: Vec<u64>) -> serde_json::Result<Branch> {
        let path = &mut checkpoint.path;
        if path.stage() != self.stage {
            *self = Self { stage: path.stage(), written: 0 };
        }
        let length = path.trail_length();
        let trail = path.take_trail(self.written);
        self.written = length;
        let trail = if trail.is_empty() { None } else { Some(serde_json::to_string(&trail)?) };
        Ok(Branch { body: serde_json::to_string(&checkpoint)?, trail, alternatives })
    }
}

/// Where a job begins that follows another.
pub fn beginning(parent: &Parent, origin: &Origin) -> serde_json::Result<Beginning> {
    let mut checkpoint: JudgedCheckpoint = serde_json::from_str(&origin.body)?;
    let parts: Vec<_> = origin.trail.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    checkpoint.path.put_trail(parts);
    let Parent { job, increment, direction } = parent;
    let event = format!("follows direction {direction} of increment {increment} of job {job}");
    // A direction too large for this machine is as absent as one past the end of the list.
    Ok(Beginning { checkpoint, direction: usize::try_from(*direction).unwrap_or(usize::MAX), event })
}
