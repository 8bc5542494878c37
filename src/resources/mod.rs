//! What a solve may take: memory and work within a budget, and a flag by which it is cancelled.

pub mod budget;
pub mod cancel;
pub mod panics;
