//! What a user of the solver may choose.

/// When a branch counts as solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Finish {
    /// At a Karush-Kuhn-Tucker point of the branch, to the tolerance.
    #[default]
    Converged,
    /// As soon as two successive quadratic programs end with the same working set and no pair is biactive: the caller
    /// wants the contact mode and refines the point itself.
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
    /// Both members of a pair at most this: the pair is biactive.
    pub biactive_tolerance: f64,
    /// Iterations of one sequential quadratic program.
    pub iteration_limit: usize,
    /// The start's own pattern of zero members is tried before any regularisation.
    pub warm_start: bool,
    pub finish: Finish,
    /// Restarts from a larger `ε` before giving up.
    pub restarts: usize,
    /// Largest number of biactive pairs whose branches (2 to its power) are enumerated to judge a point; also of all
    /// pairs, before a problem is called infeasible. Capped at 16 and 10.
    pub enumeration_limit: usize,
    /// Whether what passes for a solution is looked beyond, so that iterates without bound are told from it.
    pub looks_beyond: bool,
    /// `ε` falls to its last value whatever the pattern shows before; the start's own pattern is not tried first.
    pub whole_sequence: bool,
    /// Every quadratic program by the interior-point method, none by the working set of the one before.
    pub interior_only: bool,
    /// Iterates are kept: see [`crate::complementarity::mpec::ProgramSolution::iterates`].
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
    /// For a start near the solution whose pattern is likely right.
    pub fn warm() -> Self {
        Self { first_relaxation: 1e-4, warm_start: true, ..Self::default() }
    }
}
