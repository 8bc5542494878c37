//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Difference of two rates of dissipation or of potential energy (of unit arc length), relative to the largest force,
/// up to which two directions tie. Rates are accurate to about 1e-9, and the rate of energy sums several of them: ten
/// times as much keeps rounding from deciding, and a tie goes to the straightest direction.
pub(crate) const DISSIPATION_TIE_TOLERANCE: f64 = 1e-8;

/// Difference of the components of two displacement rates along the incoming one, relative to their sizes, up to which
/// two directions tie. The value is the error 1e-9 that an increment may have, well above the round-off of the
/// products; in a tie the direction that keeps the sign of the load rate is preferred.
pub(crate) const MOTION_TIE_TOLERANCE: f64 = 1e-9;

/// Size of a displacement rate, relative to its direction, up to which nothing moves: the location of the event before
/// the point, or the differences of the tangent that determine a direction at a fold, leave a remainder of this size.
/// The direction of such a remainder depends on units, axes and steps, so that a smaller bound would let rounding
/// decide; the error 1e-9 that an increment may have limits a larger one.
pub(crate) const RESTING_MOTION: f64 = 1e-9;
