//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Largest residual of the sum of the reactions, over the largest of the force and the reactions: between nearly
/// opposite cones the reactions are far larger than the force. The bound lies a few thousand unit round-offs above
/// exact convergence and below the accepted residual 1e-11 of equilibrium, so that the shared reactions do not spoil a
/// point; a force outside the sum of the cones leaves a far larger residual.
pub(crate) const SUM_RESIDUAL: f64 = 1e-12;

/// Multiple of the identity that regularises Newton's matrix, over the residual. Where the matrix is singular the step
/// is at most the inverse, a thousand times the unit force; a larger multiple distorts the step and slows the
/// convergence, a smaller one lets the step grow, and as the multiple vanishes with the residual the value affects only
/// effort.
pub(crate) const REGULARISATION: f64 = 1e-3;

/// Sufficient decrease: the function falls by at least this fraction of the decrease that its slope predicts. The usual
/// constant of Armijo's rule: a small fraction accepts nearly every step that decreases the function, and a positive
/// one ensures convergence.
pub(crate) const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Fraction of the Newton step below which the line search gives up: after fifty halvings. A shorter fraction of a step
/// of the size of the point changes the point by no more than a few unit round-offs, so that rounding prevents a
/// further decrease.
pub(crate) const SHORTEST_STEP: f64 = 1e-15;

/// Difference of the components of a unit normal up to which two axes count as equally aligned with it. Round-off of a
/// normal is far smaller, and a larger value would only move the place at which the tangents pass from one axis to the
/// next.
pub(crate) const EQUALLY_ALIGNED: f64 = 1e-9;
