//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Largest ratio of the smaller to the larger member of a pair (for a cone pair, of the natural residual to the largest
/// component) at which the pattern of the pair is clear. The ratio is a heuristic for effort: the solver classifies the
/// result of every branch, so a larger ratio tries wrong branches and a smaller ratio solves more regularised programs.
pub(crate) const CLEAR_PATTERN_RATIO: f64 = 0.05;

/// Magnitude up to which both members of a pair at a converged point are zero to rounding (members are dimensionless
/// and of order one). The last step brings a converged point to the accuracy 1e-11 of the active-set method, and 1e-11
/// is far below the tolerance 1e-6 for biactive pairs before the last step.
pub(crate) const BIACTIVE_ROUND_OFF: f64 = 1e-11;

/// Multiple of the largest violation at a settled point up to which members may be zero: the remaining violation shows
/// by how much members may still change. A factor of ten covers gradients of moderate size; too large a factor costs
/// one more solve of the branch, to convergence.
pub(crate) const VIOLATION_MULTIPLE: f64 = 10.0;

/// Smallest decrease of the objective `f`, relative to `1 + |f|`, that justifies another branch. The value is 1e4 times
/// the round-off 1e-14 of the merit function, so that no branch returns by rounding, and a hundredth of the tolerance
/// 1e-8 on stationarity.
pub(crate) const SMALLEST_DECREASE: f64 = 1e-10;

/// Largest residual (of equations that are dimensionless and of order one) at which the system counts as solved; the
/// points of the path have to meet the same residual. The value leaves a factor of 5e4 above unit round-off for the
/// conditioning and a factor of 100 below the measure of error 1e-9.
pub(crate) const ACCEPTED_RESIDUAL: f64 = 1e-11;

/// Residual (of equations that are dimensionless and of order one) below which further iterations gain nothing. The
/// value is a few units of round-off, 2e-16; a smaller value costs iterations without progress, and a larger value
/// stops a quadratically convergent iteration one step early.
pub(crate) const ATTAINABLE_RESIDUAL: f64 = 1e-15;

/// Fraction of the largest singular value below which a singular value counts as zero. The decomposition of singular
/// Jacobians leaves singular values of unit round-off times the number of rows, about 1e-13 for hundreds of rows; the
/// value is well above, and the least-squares step then divides by no round-off.
pub(crate) const RANK_TOLERANCE: f64 = 1e-11;

/// Factor on the relaxation `ε` from one restart to the next: the inverse of the usual factor 1e-2 from one `ε` to the
/// next in a descent. Three restarts from 0.1 thus reach 1e5; a factor of ten would spend the restarts on nearly the
/// same program. The factor affects effort and the choice among local solutions, not their accuracy.
pub(crate) const RESTART_FACTOR: f64 = 100.0;

/// Largest relaxation `ε` of the products: a larger value relaxes no further. Members are of order one, so that a bound
/// of 1e8, the inverse of the usual last `ε` 1e-8, is inactive at every point of interest.
pub(crate) const LARGEST_RELAXATION: f64 = 1e8;

/// Length of a projected gradient that counts as zero, relative to `1 + ‖∇f‖∞`. Members up to the biactive tolerance
/// 1e-6 are constrained to zero in the linearised rows, so that the projection at a stationary point may have this
/// length; the decrease of the objective along so short a projection, its square 1e-12, is below the smallest decrease
/// 1e-10 that justifies another branch.
pub(crate) const STATIONARY_LENGTH: f64 = 1e-6;

/// First-order gain by a relative increase of a variable, relative to the objective and its first-order terms, from
/// which the variable is examined. At a solution the gradient of the Lagrangian is zero to the tolerance 1e-8, a
/// hundredth of the value; further solves decide about every variable examined, so that a smaller value only costs
/// solves.
pub(crate) const EXAMINED_GAIN: f64 = 1e-6;

/// Factor between the multiples of a variable at which the branch is solved again. Decades cover twelve orders of
/// magnitude with the largest number of multiples, and three decades show a decrease of the objective above its
/// rounding error; a factor nearer to one needs more solves for the same range.
pub(crate) const GROWTH_FACTOR: f64 = 10.0;

/// Rounding error of the objective, relative to its magnitude with the sum of its first-order terms: some 500 units of
/// round-off, 2e-16, for sums of hundreds of terms. Smaller changes of the objective show neither a rise nor a fall.
pub(crate) const OBJECTIVE_ROUND_OFF: f64 = 1e-13;
