//! A single solve: on a thread of its own, from a request or a checkpoint to lines, checkpoints and an end.

pub mod branches;
pub mod cadence;
pub mod checkpoints;
pub mod context;
pub mod increment_recorder;
pub mod running;
pub mod solve;
pub mod solve_output;
pub mod solver;
pub mod trail;
