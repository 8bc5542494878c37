//! The path: its increments one after the other, by steps along the path and by jumps where it cannot go on.
//!
//! | file | contents |
//! |---|---|
//! | `iterator` | the path as an iterator of increments |
//! | `checkpoint`, `branch_switching` | checkpoints to resume a path; a path along another direction |

pub(crate) mod branch_switching;
pub mod checkpoint;
pub mod iterator;
