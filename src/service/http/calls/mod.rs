//! The calls: a function for each operation, with its OpenAPI description.

pub mod changes;
pub mod curves;
pub mod follow;
pub mod increments;
pub mod jobs;
pub mod metrics;
pub mod openapi;
pub mod probes;
pub mod request;
pub mod scenes;
pub mod studies;
pub mod sweeps;
