//! Counts of work, and the iterates of a solve.

use nalgebra::DVector;

/// Work done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SolverCounts {
    /// Quadratic programs, however solved; the elastic version of one does not count again.
    pub qp_solves: usize,
    /// Calls of the interior-point method.
    pub interior_point_solves: usize,
    /// Elastic programs among them.
    pub elastic_solves: usize,
    /// Steps of sequential quadratic programming.
    pub sqp_iterations: usize,
    /// Values of `ε` visited, restarts included.
    pub relaxation_levels: usize,
    /// Branch programs solved.
    pub branches: usize,
    /// Restarts from a larger `ε`.
    pub restarts: usize,
}

/// A point on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverIterate {
    /// The bound on the products; `None` in a branch, which has none.
    pub relaxation: Option<f64>,
    pub x: DVector<f64>,
    pub objective: f64,
    /// Sum of the violations of the program's rows.
    pub violation: f64,
}
