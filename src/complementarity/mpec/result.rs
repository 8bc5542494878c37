//! The result of a solve.

#![warn(missing_docs)]

use crate::complementarity::mpec::program::solve_statistics::{SolverCounts, SolverIterate};
use nalgebra::DVector;
use thiserror::Error;

pub use crate::complementarity::mpec::program::activity::PairActivity;
use crate::complementarity::mpec::program::cone::ConeActivity;
pub use crate::complementarity::mpec::program::evaluation::Quantity;
pub use crate::complementarity::mpec::smooth_program::smooth_rows::Multipliers;

/// The status at the end of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SolveStatus {
    /// Feasible, complementary, and stationary in the sense of [`ProgramSolution::stationarity`].
    Solved,
    /// [`crate::complementarity::mpec::Finish::PatternSettled`]: the pattern is certain, the point is not refined.
    PatternSettled,
    /// Feasible and complementary, but no stationarity was established.
    Feasible,
    /// From every start tried, the violation has a local minimum above zero.
    Infeasible,
    /// An iteration limit was reached before feasibility.
    IterationLimit,
    /// No step makes progress, and the point is not feasible.
    NoProgress,
    /// The objective falls without bound on feasible points.
    Unbounded,
    /// The infimum is not attained: the optimality conditions hold ever more closely while a variable grows without
    /// bound.
    UnboundedIterates(Growth),
    /// A function returned a number that is not finite.
    NotFinite(Quantity),
    /// Stopped by the cancel flag.
    Cancelled,
}

/// A variable that grows without bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// Its index, from 0.
    pub variable: usize,
    /// Value at which the optimality conditions hold to the tolerance.
    pub from: f64,
    /// Largest value up to which the objective was found to fall.
    pub to: f64,
}

/// Kind of stationarity of the returned point, strongest first.
///
/// Multipliers `ν_a, ν_b` of the biactive pairs: strong, both nonnegative; Mordukhovich, both positive or one zero;
/// Clarke, product nonnegative; weak, any. Source: H. Scheel and S. Scholtes, Math. Oper. Res. 25 (2000),
/// doi:10.1287/moor.25.1.1.15213.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StationarityKind {
    /// No first-order descent, even without complementarity of the biactive pairs.
    Strong,
    /// No first-order descent in any of the enumerated branches.
    Branch,
    /// Multipliers of each biactive pair both positive, or one of them zero.
    Mordukhovich,
    /// Product of the multipliers of each biactive pair 0 or more.
    Clarke,
    /// Multipliers of the biactive pairs of any sign.
    Weak,
    /// Multipliers exist in one of the branches that meet at biactive pairs, but were not shown to exist in all others
    /// (where both members of a cone pair vanish, infinitely many branches meet). B-stationarity is not claimed.
    OneBranch,
    /// Not stationary, or not established.
    Unknown,
}

/// The point returned by a solve, with its status and multipliers.
#[derive(Debug, Clone)]
pub struct ProgramSolution {
    /// How the solve ended.
    pub status: SolveStatus,
    /// The variables.
    pub x: DVector<f64>,
    /// `f(x)`.
    pub objective: f64,
    /// Of all constraints, zero where none were found.
    pub multipliers: Multipliers,
    /// One per pair.
    pub activity: Vec<PairActivity>,
    /// One per cone pair.
    pub cone_activity: Vec<ConeActivity>,
    /// The strongest kind of stationarity that was established.
    pub stationarity: StationarityKind,
    /// Largest violation of an equality, inequality or sign; bounds always hold.
    pub largest_violation: f64,
    /// Largest `|a_i b_i|`, or `|A_i·B_i|` for cone pairs.
    pub largest_product: f64,
    /// Work of the solve.
    pub counts: SolverCounts,
    /// The last `ε` used; `None` where the start's own pattern was sufficient.
    pub last_relaxation: Option<f64>,
    /// One per step of sequential quadratic programming, in order; empty unless requested.
    pub iterates: Vec<SolverIterate>,
}

/// Invalid input of a solve.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProgramInputError {
    /// The start has another number of variables.
    #[error("the start has {found} variables, the problem {expected}")]
    StartLength {
        /// Variables of the problem.
        expected: usize,
        /// Entries of the start.
        found: usize,
    },
    /// A vector of bounds has another number of entries than the problem has variables.
    #[error("the bounds have {lower} and {upper} entries, the problem {expected} variables")]
    BoundsLength {
        /// Variables of the problem.
        expected: usize,
        /// Entries of the lower bounds.
        lower: usize,
        /// Entries of the upper bounds.
        upper: usize,
    },
    /// No number lies between two bounds.
    #[error("variable {variable} has the lower bound {lower} and the upper bound {upper}")]
    Bounds {
        /// Index of the variable, from 0.
        variable: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// A second-order cone of fewer than 2 dimensions.
    #[error("cone pair {pair} has members of size {size}; 2 or more is expected")]
    ConeSize {
        /// Index of the cone pair, from 0.
        pair: usize,
        /// Its size.
        size: usize,
    },
    /// A setting out of its range.
    #[error("setting {name} is {value}; it must be {wanted}")]
    Setting {
        /// Name of the field of [`Settings`](crate::complementarity::mpec::Settings).
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range, in words.
        wanted: &'static str,
    },
}
