//! Settings of the solver.

#![warn(missing_docs)]

/// The criterion by which a branch counts as solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Finish {
    /// At a Karush-Kuhn-Tucker point of the branch, to the tolerance.
    #[default]
    Converged,
    /// As soon as two successive quadratic programs end with the same working set and no pair is biactive: for callers
    /// that need the contact mode only and refine the point themselves.
    PatternSettled,
}

/// Settings of a solve; all numbers dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// First bound `ε` on the products.
    pub first_relaxation: f64,
    /// Factor from one `ε` to the next, in (0, 1).
    pub relaxation_factor: f64,
    /// Last `ε`.
    pub last_relaxation: f64,
    /// Accepted violation of a constraint, absolute, and residual of stationarity, relative to `1 + ‖∇f‖∞`.
    pub tolerance: f64,
    /// A pair with both members at most this is biactive.
    pub biactive_tolerance: f64,
    /// Largest number of iterations of one sequential quadratic program.
    pub iteration_limit: usize,
    /// Whether the start's own pattern of zero members is tried before any regularisation.
    pub warm_start: bool,
    /// Where a branch counts as solved.
    pub finish: Finish,
    /// Largest number of restarts from a larger `ε`.
    pub restarts: usize,
    /// Largest number `n` of biactive pairs whose `2ⁿ` branches are enumerated to classify a point, and of all pairs
    /// whose branches are tried before a problem is called infeasible; capped at 16 and 10.
    pub enumeration_limit: usize,
    /// Whether an apparent solution is tested for unbounded iterates.
    pub looks_beyond: bool,
    /// Whether `ε` falls to its last value whatever the pattern in between; the start's own pattern is then not tried
    /// first.
    pub whole_sequence: bool,
    /// Whether every quadratic program is solved by the interior-point method, none from the previous working set.
    pub interior_only: bool,
    /// Whether iterates are stored: see [`crate::complementarity::mpec::ProgramSolution::iterates`].
    pub keep_iterates: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            first_relaxation: 1e-1,
            relaxation_factor: 1e-2,
            last_relaxation: 1e-8,
            tolerance: 1e-8,
            biactive_tolerance: 1e-6,
            iteration_limit: 100,
            warm_start: false,
            finish: Finish::Converged,
            restarts: 3,
            enumeration_limit: 6,
            looks_beyond: true,
            whole_sequence: false,
            interior_only: false,
            keep_iterates: false,
        }
    }
}

impl Settings {
    /// Settings for a start near the solution, with a pattern that is probably correct.
    pub fn warm() -> Self {
        Self { first_relaxation: 1e-4, warm_start: true, ..Self::default() }
    }
}
