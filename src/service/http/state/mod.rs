//! What every call can reach, and how much work and memory all calls together may take.

pub mod aside;
pub mod bodies;
pub mod service;
