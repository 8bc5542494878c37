//! What a solve needs of the service in which it runs.

use crate::resources::budget::Bounds;
use crate::service::jobs::solving::running::Running;
use crate::service::jobs::solving::solver::Solver;
use crate::service::metrics::Metrics;
use std::sync::Arc;
use std::time::Duration;

/// What a solve needs of the service in which it runs.
#[derive(Clone)]
pub struct SolveContext {
    pub solver: Arc<dyn Solver>,
    /// The solves of this process, among which this one is listed.
    pub running: Running,
    pub metrics: Arc<Metrics>,
    /// How much memory and work the solve may use.
    pub bounds: Bounds,
    /// Checkpoints are made no more often than this.
    pub flush_interval: Duration,
}
