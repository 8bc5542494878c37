//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Largest arc length (dimensionless) by which a bifurcation point is moved along the path to meet a bound within
/// round-off of the point. The bound is at most 1e-12 away, so that a longer way belongs to a path nearly parallel to
/// the bound, and a shift within the error 1e-9 that an increment may have leaves the point the same; the residual of
/// the moved point decides in any case.
pub(crate) const LARGEST_SHIFT_TO_BOUND: f64 = 1e-9;

/// Step (dimensionless) of the central differences of the matrix for second derivatives: a truncation error of about
/// 1e-8 and a rounding error of 2e-16/1e-4 = 2e-12. The step is larger than the cube root 6e-6 of round-off, since
/// stiffnesses far larger than their derivatives raise the rounding error; both errors stay well below the bound 1e-5
/// for uncoupled parts.
pub(crate) const DIFFERENCE_STEP: f64 = 1e-4;

/// Sum of the second derivatives of one part along the motions of other parts, relative to its own second derivative,
/// up to which the parts are uncoupled. The bound lies well above the error 1e-8 of the differences and far below the
/// coupling of connected parts, which is of order one; trial steps confirm the resulting directions.
pub(crate) const COUPLING_TOLERANCE: f64 = 1e-5;

/// Speed of a contact, relative to the arc length of the motion of a part, up to which the contact rests in this
/// motion. The bound lies well above the error of a null vector at a point located with a residual of at most 1e-11,
/// and far below the speed of a contact that takes part in the motion.
pub(crate) const RESTING_SPEED: f64 = 1e-7;

/// Cosine of the largest angle, 1.4e-4, to the incoming direction at which a combination of motions counts as the
/// incoming direction. The angle lies above the relative errors of up to 1e-5 that weak coupling leaves in the motions,
/// and far below the angle to a combination in which one part reverses or rests.
pub(crate) const INCOMING_COSINE: f64 = 1.0 - 1e-8;
