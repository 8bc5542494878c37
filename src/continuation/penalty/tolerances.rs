//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Largest difference of the roots' products with the previous displacements, relative to the square of the arc length,
/// that counts as zero: the loads then distinguish the roots. The products have an error of some units of round-off,
/// 2e-16, relative to the square of the arc length; the value is well above, and a true difference is of the order of
/// 1.
pub(crate) const ROOT_TIE_TOLERANCE: f64 = 1e-12;

/// Largest factor by which a step may grow from one increment to the next. The rule alone permits the square root of
/// the desired number of iterations, 2.2 for the usual five, so that the bound acts after one iteration only or where a
/// larger number is desired; the bound affects effort only, as a step that does not converge is halved.
pub(crate) const LARGEST_STEP_GROWTH: f64 = 2.0;

/// Stiffness against a motion, relative to that of the elements concerned (for the rank, pivot relative to the first
/// pivot), below which the motion is not resisted. The value is 5e5 units of round-off, 2e-16, so that the conditioning
/// of the tangent with penalties does not hide a mechanism, and below the stiffness of structures that are only soft.
pub(crate) const UNRESISTED_STIFFNESS: f64 = 1e-10;
