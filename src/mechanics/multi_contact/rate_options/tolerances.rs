//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Sine of the angle below which a ray lies on the bound of a sum of cones. A ray of the bound itself is perpendicular
/// to the normal of the bound within a few unit round-offs, and nearly parallel obstacles add their own errors; rays
/// closer than the error 1e-9 that an increment may have carry the same force.
pub(crate) const BOUND_SINE: f64 = 1e-9;

/// Rates of a gap and speeds along an obstacle (at unit arc length) up to which the motion is zero at first order. The
/// value is the margin 1e-9 of weak inequalities, far above the round-off of rates; the slip that results is only an
/// alternative, on which a trial step decides.
pub(crate) const GRAZING_SPEED: f64 = 1e-9;
