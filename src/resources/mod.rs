//! What a solve may take: memory and work within a budget, memory that is used again, and a flag by which it is cancelled.

pub mod budget;
pub mod cancel;
pub mod panics;
pub(crate) mod spare_memory;
