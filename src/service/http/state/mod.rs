//! What every call can reach, and how much work and memory all calls together may take.

pub mod bodies;
pub mod offload;
pub mod service;
