//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Smallest curvature, relative to the identity, that an update may use or leave; otherwise the update is skipped.
/// Variables are scaled to order one, and the first difference scales the matrix to no less than 1e-4: the value lies
/// six orders of magnitude below and excludes differences of gradients that are round-off.
pub(crate) const SMALLEST_CURVATURE: f64 = 1e-10;

/// Largest curvature, relative to the identity, that an update may leave; otherwise the update is skipped. Variables
/// are scaled to order one, and the first difference scales the matrix to no more than 1e8: the value lies four orders
/// of magnitude above and excludes quotients by steps that are round-off.
pub(crate) const LARGEST_CURVATURE: f64 = 1e12;

/// Fraction of the predicted decrease of the merit function that a step has to reach. The value 1e-4 is customary (J.
/// Nocedal and S. J. Wright, *Numerical Optimization*, 2nd ed. (2006), chapter 3): small enough for nearly every full
/// step, and positive, so that steps without progress do not repeat; the value affects effort, not results.
pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Objective below which a sequence counts as unbounded. The objective of a program scaled to order one reaches -1e20
/// at unit curvature only where variables are about 1e10, near the bound 1e11 on variables; the exact value affects the
/// number of iterations only.
pub(crate) const UNBOUNDED_OBJECTIVE: f64 = -1e20;

/// Magnitude of a variable (scaled to order one) beyond which a sequence counts as unbounded. The ridge 1e-8 permits
/// steps up to about 1e8 in flat directions, a thousandth of the value; at 1e11 the spacing of numbers, 2e-5, exceeds
/// the tolerance 1e-8 by far, so that no solution there can be verified.
pub(crate) const UNBOUNDED_VARIABLE: f64 = 1e11;

/// Diagonal added to a problem's own (semidefinite) model, relative to its largest entry: the ridge keeps steps in flat
/// directions bounded. The value is about the square root of unit round-off, so that the matrix is regular in
/// floating-point arithmetic; the ridge does not enter the gradient, and an error of 1e-8 in the Hessian hardly slows
/// convergence.
pub(crate) const HESSIAN_RIDGE: f64 = 1e-8;

/// Fraction of the violation that a step must be predicted to remove; otherwise the point counts as locally infeasible.
/// The elastic program gives the remaining violation to about 1e-8 of the largest row, a hundredth of the value, and
/// steps that remove less would make no progress within the largest number of iterations.
pub(crate) const SMALLEST_REMOVED_SHARE: f64 = 1e-6;
