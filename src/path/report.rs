//! What is known of a path when it has ended.

use super::stop::StopReason;
use serde::{Deserialize, Serialize};

/// Totals and maxima over a whole path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Report {
    pub stop_reason: StopReason,
    /// The reason in a sentence.
    pub sentence: String,
    pub increments: u64,
    pub elapsed_s: f64,
    pub largest_residual: f64,
    pub largest_complementarity: f64,
    pub largest_energy_error: f64,
    pub factorisations: u64,
    pub newton_iterations: u64,
    pub qp_solves: u64,
    pub mpec_solves: u64,
}

impl Report {
    /// Of a path that has not ended; the reason stands for one that is dropped.
    pub(super) fn begun() -> Self {
        Self {
            stop_reason: StopReason::Cancelled,
            sentence: String::new(),
            increments: 0,
            elapsed_s: 0.0,
            largest_residual: 0.0,
            largest_complementarity: 0.0,
            largest_energy_error: 0.0,
            factorisations: 0,
            newton_iterations: 0,
            qp_solves: 0,
            mpec_solves: 0,
        }
    }
}
