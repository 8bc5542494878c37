//! The trail of a path: the states that it has passed, by which a cycle is detected. Each state is stored once: a checkpoint is
//! stored with the states that are new since the previous one, and reading a checkpoint collects them.

use crate::continuation::path::checkpoint::Checkpoint;
use serde::{Deserialize, Serialize};

/// How much of a path's trail has been written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Written {
    stage: usize,
    /// States of the current stage.
    states: u64,
}

/// The new part of a trail.
#[derive(Debug)]
pub struct Part {
    /// The new states as a line of JSON; `None` if there are none.
    pub text: Option<String>,
    /// The parts before belong to an earlier stage.
    pub is_first: bool,
}

impl Written {
    /// The whole trail of a checkpoint has been written.
    pub fn up_to(checkpoint: &Checkpoint) -> Self {
        Self { stage: checkpoint.stage(), states: checkpoint.trail_length() }
    }

    /// Removes the trail from a checkpoint and writes its new part.
    pub fn part(&mut self, checkpoint: &mut Checkpoint) -> serde_json::Result<Part> {
        let is_first = checkpoint.stage() != self.stage;
        let from = if is_first { 0 } else { self.states };
        *self = Self::up_to(checkpoint);
        let trail = checkpoint.take_trail(from);
        let text = if trail.is_empty() { None } else { Some(serde_json::to_string(&trail)?) };
        Ok(Part { text, is_first })
    }
}

/// Restores the trail of a checkpoint from its parts, one per line.
pub fn put_back(checkpoint: &mut Checkpoint, parts: &str) -> serde_json::Result<()> {
    let parts: Vec<_> = parts.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    checkpoint.put_trail(parts);
    Ok(())
}
