//! Counts of work, and the iterates of a solve.

#![warn(missing_docs)]

use nalgebra::DVector;

/// Counts of the work of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SolverCounts {
    /// Quadratic programs, however solved; an elastic version does not count again.
    pub qp_solves: usize,
    /// Calls of the interior-point method.
    pub interior_point_solves: usize,
    /// Calls of the interior-point method for elastic programs.
    pub elastic_solves: usize,
    /// Steps of sequential quadratic programming.
    pub sqp_iterations: usize,
    /// Values of `ε` used, restarts included.
    pub relaxation_levels: usize,
    /// Branch programs solved.
    pub branches: usize,
    /// Restarts from a larger `ε`.
    pub restarts: usize,
}

/// An iterate of a solve.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverIterate {
    /// The bound on the products; `None` in a branch, which has no products.
    pub relaxation: Option<f64>,
    /// The variables.
    pub x: DVector<f64>,
    /// `f(x)`.
    pub objective: f64,
    /// Sum of the violations of the program's rows.
    pub violation: f64,
}
