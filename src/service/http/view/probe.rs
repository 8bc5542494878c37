//! Answers of the probes.

use serde::Serialize;
use utoipa::ToSchema;

#[derive(Debug, Serialize, ToSchema)]
pub struct Health {
    /// Always `alive`.
    pub status: &'static str,
    pub version: &'static str,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Readiness {
    /// Always `ready`; what is not ready answers 503.
    pub status: &'static str,
    /// Workers alive in this process.
    pub workers: usize,
}
