//! Tolerances of the points by which a path comes to a critical point.

/// A quantity that must not be negative counts as negative below this, relative to its scale. Points of the history are
/// located to some 1e-13; a quantity that is zero by symmetry, or that a change of contact keeps at zero, must not count as
/// passed, and a curve that runs this far past a change of its kind is off by no more.
pub(crate) const PASSED: f64 = 1e-9;

/// Quantities up to this, relative to their scale, are zero at a point of the traced path: those of the contacts that change
/// there, and of others that change with them.
pub(crate) const ZERO_AT_POINT: f64 = 1e-8;

/// Correction of a point along its branch at which the point has been found, relative to the size of the state: some
/// units of round-off.
pub(crate) const POINT_ROUND_OFF: f64 = 1e-14;

/// Largest such correction that is left where corrections no longer become smaller. Load maxima are flat: where the load
/// rate has an error of 1e-14, the place of the maximum has one of 1e-14 over the curvature of the path.
pub(crate) const ACCEPTED_CORRECTION: f64 = 1e-10;

/// Value of a quantity (gaps and reactions over their scales, rates of unit arc length) that may be rounding where
/// corrections no longer become smaller: the rates of slender beams have an error of some 3e-11 times a unit. It is the
/// largest violation of the laws of contact at a point.
pub(crate) const ROUNDED_VALUE: f64 = 1e-10;

/// Largest correction along a branch in one iteration, relative to the size of the state and of its increment.
pub(crate) const LARGEST_CORRECTION: f64 = 0.2;

/// A condition that has been located has at most this value, relative to its scale; a larger one is that of a pole.
pub(crate) const FOUND_ZERO: f64 = 1e-7;

/// Cosine of the largest angle between the directions of a branch at bifurcation points of two neighbouring values of the
/// parameter: another branch through the point is usually farther away.
pub(crate) const SAME_BRANCH: f64 = 0.5;

/// Branches pass each other where the unfolding of their bifurcation point is more than this, a dimensionless displacement.
/// Where they meet it is round-off, some 1e-14; past the symmetry that made them meet it grows with the parameter.
pub(crate) const UNFOLDED: f64 = 1e-10;

/// Directions whose cosine is this close to 1 are the same: both solve the rate equations to some 1e-9, and others differ by far
/// more.
pub(crate) const SAME_DIRECTION: f64 = 1e-6;

/// The point asked for and the one on a path with all of its contact changes resolved coincide within this (dimensionless):
/// a limit point is flat.
pub(crate) const ASKED_POINT: f64 = 1e-4;

/// Part of a vector along a normal up to which the vector is tangential: round-off of a vector that is.
pub(crate) const OUT_OF_PLANE: f64 = 1e-12;
