//! Mathematical programs with complementarity constraints.
//!
//! ```text
//! min f(x)   s.t.   h(x) = 0,   g(x) >= 0,   lower <= x <= upper,   0 <= a_i(x)  ⊥  b_i(x) >= 0,
//!                   K ∋ A_i(x)  ⊥  B_i(x) ∈ K,     K the second-order cone
//! ```
//!
//! solved through a sequence of regularised problems (`a_i b_i <= ε`, ε falling to 0) by sequential quadratic
//! programming. The module is independent of structures and contacts: a caller implements [`Problem`] and calls
//! [`solve`].
//!
//! Cost, measured in a release build on increments of a one-bar truss (7 variables, 3 equalities, 3 pairs): a quadratic
//! program takes 2 µs from a good working set and 80 to 240 µs by the interior-point method; a warm-started increment
//! identifies its pattern in 1 or 2 programs and converges in 4, without the interior-point method. Matrices are stored
//! by their entries, and a branch whose equalities leave a line is reduced to this line: one sparse factorisation per
//! program.
//!
//! | module | contents |
//! |---|---|
//! | [`program`] | the interface of a problem, its values at one point, the second-order cone |
//! | [`settings`], [`result`], `input_validation` | settings, results, and checks of the input |
//! | `solver` | the sequence of regularised problems, restarts |
//! | `piecewise_descent` | descent over patterns of zero members |
//! | `stationarity` | the kind of stationarity of a point |
//! | `unboundedness` | detection of iterates that tend to infinity |
//! | [`smooth_program`] | the smooth program of a pattern, by sequential quadratic programming |
//! | [`quadratic_program`] | one quadratic program |
//! | [`semismooth_newton`] | Newton's method on the complementarity system itself |

pub(crate) mod input_validation;
pub(crate) mod piecewise_descent;
pub mod program;
pub mod quadratic_program;
pub mod result;
pub mod semismooth_newton;
pub mod settings;
pub mod smooth_program;
pub(crate) mod solver;
pub(crate) mod stationarity;
pub(crate) mod tolerances;
pub(crate) mod unboundedness;

pub use crate::complementarity::mpec::program::solve_statistics::{SolverCounts, SolverIterate};
pub use program::activity::Activities;
pub use program::cone::ConeActivity;
pub use program::problem::Problem;
pub use program::sparse_rows::SparseRows;
pub use result::{
    Growth, Multipliers, PairActivity, ProgramInputError, ProgramSolution, Quantity, SolveStatus, StationarityKind,
};
pub use settings::{Finish, Settings};
pub use solver::{follow_branch, solve};
