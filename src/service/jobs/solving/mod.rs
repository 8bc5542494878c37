//! A single solve: on a thread of its own, from a request or a checkpoint to lines, checkpoints and an end.

pub mod branches;
pub mod cadence;
pub mod checkpoints;
pub mod context;
pub mod given;
pub mod running;
pub mod sent;
pub mod solve;
pub mod solver;
pub mod trail;
