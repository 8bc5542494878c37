//! The states that a path has passed (for telling a cycle) are stored once: each checkpoint with those that are new since
//! the one before, and reading one gathers them.

use crate::continuation::path::checkpoint::Checkpoint;
use serde::{Deserialize, Serialize};

/// How much of a path's trail has been written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Written {
    stage: usize,
    /// Of the running stage's.
    states: u64,
}

/// What is new of a trail.
#[derive(Debug)]
pub struct Part {
    /// One line.
    pub text: Option<String>,
    /// The parts before are of an earlier stage.
    pub is_first: bool,
}

impl Written {
    /// Everything that a checkpoint knows.
    pub fn up_to(checkpoint: &Checkpoint) -> Self {
        Self { stage: checkpoint.stage(), states: checkpoint.trail_length() }
    }

    /// Takes the trail out of a checkpoint and writes what is new of it.
    pub fn part(&mut self, checkpoint: &mut Checkpoint) -> serde_json::Result<Part> {
        let is_first = checkpoint.stage() != self.stage;
        let from = if is_first { 0 } else { self.states };
        *self = Self::up_to(checkpoint);
        let trail = checkpoint.take_trail(from);
        let text = if trail.is_empty() { None } else { Some(serde_json::to_string(&trail)?) };
        Ok(Part { text, is_first })
    }
}

/// Puts a trail back that was written in parts, a line each.
pub fn put_back(checkpoint: &mut Checkpoint, parts: &str) -> serde_json::Result<()> {
    let parts: Vec<_> = parts.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    checkpoint.put_trail(parts);
    Ok(())
}
