//! What a solve returns.

use crate::complementarity::mpec::program::counts::{SolverCounts, SolverIterate};
use nalgebra::DVector;
use thiserror::Error;

pub use crate::complementarity::mpec::program::activity::PairActivity;
use crate::complementarity::mpec::program::cone::ConeActivity;
pub use crate::complementarity::mpec::program::evaluation::Quantity;
pub use crate::complementarity::mpec::smooth_program::relaxation::Multipliers;

/// Why a solve ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SolveStatus {
    /// Feasible, complementary, and stationary in the sense of [`ProgramSolution::stationarity`].
    Solved,
    /// [`crate::complementarity::mpec::Finish::PatternSettled`]: the pattern is certain, the point is not refined.
    PatternSettled,
    /// Feasible and complementary, but no stationarity was established.
    Feasible,
    /// The violation is locally smallest and not zero, from every start tried.
    Infeasible,
    /// An iteration limit was reached before feasibility.
    IterationLimit,
    /// No step was found that makes progress, and the point is not feasible.
    NoProgress,
    /// The objective falls without bound on feasible points.
    Unbounded,
    /// The infimum is not attained: the conditions of a solution hold better and better while a variable grows without end.
    UnboundedIterates(Growth),
    /// A function returned a number that is not finite.
    NotFinite(Quantity),
    /// Stopped by the cancel flag.
    Cancelled,
}

/// A variable that grows without end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    pub variable: usize,
    /// Where the conditions of a solution held to the tolerance.
    pub from: f64,
    /// As far out as the objective was seen to fall.
    pub to: f64,
}

/// Kind of stationarity of the returned point, strongest first.
///
/// Multipliers `ν_a, ν_b` of the biactive pairs: strong, both nonnegative; Mordukhovich, both positive or one zero;
/// Clarke, product nonnegative; weak, any. Source: H. Scheel and S. Scholtes, Math. Oper. Res. 25 (2000),
/// doi:10.1287/moor.25.1.1.15213.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StationarityKind {
    /// No first-order descent even with the biactive pairs' complementarity taken away.
    Strong,
    /// No first-order descent in any of the enumerated branches.
    Branch,
    Mordukhovich,
    Clarke,
    Weak,
    /// Multipliers exist in one of the branches that meet where cone pairs are biactive, and not all others were shown to
    /// have them: where both members vanish, infinitely many meet. Nothing is claimed of B-stationarity.
    OneBranch,
    /// Not stationary, or not established.
    Unknown,
}

/// A point and what is known of it.
#[derive(Debug, Clone)]
pub struct ProgramSolution {
    pub status: SolveStatus,
    /// The variables.
    pub x: DVector<f64>,
    pub objective: f64,
    pub multipliers: Multipliers,
    /// One a pair.
    pub activity: Vec<PairActivity>,
    /// One a cone pair.
    pub cone_activity: Vec<ConeActivity>,
    pub stationarity: StationarityKind,
    /// Largest violation of an equality, inequality or sign; bounds hold always.
    pub largest_violation: f64,
    /// Largest `|a_i b_i|`, of the cone pairs `|A_i·B_i|`.
    pub largest_product: f64,
    pub counts: SolverCounts,
    /// The last `ε` visited; `None` where the start's own pattern was enough.
    pub last_relaxation: Option<f64>,
    /// One a step of sequential quadratic programming, in order; empty unless asked for.
    pub iterates: Vec<SolverIterate>,
}

/// Misuse.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProgramInputError {
    #[error("the start has {found} variables, the problem {expected}")]
    StartLength { expected: usize, found: usize },
    #[error("the bounds have {lower} and {upper} entries, the problem {expected} variables")]
    BoundsLength { expected: usize, lower: usize, upper: usize },
    #[error("variable {variable} has the lower bound {lower} and the upper bound {upper}")]
    Bounds { variable: usize, lower: f64, upper: f64 },
    #[error("cone pair {pair} has members of size {size}; 2 or more is expected")]
    ConeSize { pair: usize, size: usize },
    #[error("setting {name} is {value}; it must be {wanted}")]
    Setting { name: &'static str, value: f64, wanted: &'static str },
}
