//! Summary of a finished path.

use crate::result::stop_reason::StopReason;
use serde::{Deserialize, Serialize};

/// Totals and maxima over a whole path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Report {
    /// Why the path ended.
    pub stop_reason: StopReason,
    /// The reason in a sentence.
    pub sentence: String,
    /// Number of increments.
    pub increments: u64,
    /// Time of the solver in seconds.
    pub elapsed_s: f64,
    /// Largest equilibrium residual over the force scale.
    pub largest_residual: f64,
    /// Largest violation of contact and friction, dimensionless.
    pub largest_complementarity: f64,
    /// Largest `|external work - strain - dissipated - released|` over the largest energy up to there.
    pub largest_energy_error: f64,
    /// Factorisations of matrices.
    pub factorisations: u64,
    /// Of the factorisations those that smooth bifurcation points took: to locate them and to list the directions there.
    #[serde(default)]
    pub bifurcation_factorisations: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Quadratic programs.
    pub qp_solves: u64,
    /// Programs of increments that were solved; a certificate is not one.
    pub mpec_solves: u64,
    /// Steps of sequential quadratic programming.
    #[serde(default)]
    pub sqp_iterations: u64,
    /// Points shown to solve their increment's program without solving it.
    #[serde(default)]
    pub certificates: u64,
    /// Increments whose end the program alone did not find (`mpec.certificate: "skip"`): they stand as the contact mode's
    /// own equations gave them.
    #[serde(default)]
    pub mpec_fallbacks: u64,
}

impl Report {
    /// Of a path without increments so far; the reason is what an end before the next one would be.
    pub(crate) fn begun() -> Self {
        Self {
            stop_reason: StopReason::Cancelled,
            sentence: String::new(),
            increments: 0,
            elapsed_s: 0.0,
            largest_residual: 0.0,
            largest_complementarity: 0.0,
            largest_energy_error: 0.0,
            factorisations: 0,
            bifurcation_factorisations: 0,
            newton_iterations: 0,
            qp_solves: 0,
            mpec_solves: 0,
            sqp_iterations: 0,
            certificates: 0,
            mpec_fallbacks: 0,
        }
    }
}
