//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Coefficients (of forms and weights of unit size) up to this are zero. The value is 5e4 units of round-off, 2e-16,
/// which exchanges of variables leave, and a thousandth of the infeasibility 1e-8 that the search permits.
pub(crate) const VANISHING_COEFFICIENT: f64 = 1e-11;

/// Amount by which a form of unit size (at the point with `t = 1`) has to lie below zero to be infeasible, and up to
/// which a form vanishes. The value is ten times the tolerance 1e-9 of the exact test of a ray, so that the search
/// discards no cone that contains an acceptable ray; a larger value only adds combinations to examine.
pub(crate) const INFEASIBILITY_TOLERANCE: f64 = 1e-8;

/// Smallest pivot (of forms and weights of unit size) that may prove anything. Division by a pivot amplifies round-off
/// of about 1e-15 in the coefficients: at 1e-7 the error stays at the permitted infeasibility 1e-8, and a condition
/// with smaller pivots is omitted, which enlarges the cone and never reduces it.
pub(crate) const SMALLEST_PIVOT: f64 = 1e-7;

/// Magnitude of a negative coefficient from which a row without positive coefficients forces the coordinate to zero.
/// The remaining coefficients of the row are at most 1e-11, so that the coordinate is at most 1e-11/1e-3 = 1e-8, the
/// permitted infeasibility; a smaller magnitude would drop coordinates that are not zero.
pub(crate) const FORCING_COEFFICIENT: f64 = 1e-3;
