//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Lower bound on the displacements (dimensionless) by which the forces that meet at a node are estimated: the scale of
/// displacements itself, so that the estimate does not vanish for a structure that happens to be undeformed.
/// Displacements are divided by their scale, so that 1 is their usual size.
pub(crate) const USUAL_DISPLACEMENT: f64 = 1.0;

/// Largest violation of the laws of contact and friction at an accepted point; gaps dimensionless, reactions over the
/// force scale at their nodes. The value is ten times the residual 1e-11 that Newton's method accepts, and a tenth of
/// the error 1e-9 that an increment may have.
pub(crate) const ACCEPTED_VIOLATION: f64 = 1e-10;

/// Gap (dimensionless) or reaction (over the force scale) up to which the gap or the reaction is zero. The value is the
/// violation 1e-10 that a point may have, ten times the residual 1e-11 that Newton's method accepts: a smaller one
/// could miss a contact located at a point so accepted, and a larger one would change the contact status by a jump that
/// shows in the error 1e-9.
pub(crate) const CONTACT_TOLERANCE: f64 = 1e-10;

/// Forces (dimensionless) below this bound count as zero: such forces are round-off where nothing is loaded. The bound
/// keeps quotients by a force scale finite, and lies four orders below the round-off 2e-16 of forces of usual size, so
/// that soft or lightly loaded structures keep a force scale of their own.
pub(crate) const NEGLIGIBLE_FORCE: f64 = 1e-20;

/// Difference of the angle between two rays from half a turn up to which the rays count as opposite; a force accepted
/// as held then lies outside the true cone by no more than this fraction of its size. The bound is a few thousand unit
/// round-offs of the angles, and far below the permitted violation 1e-10.
pub(crate) const OPPOSITE_RAY_ANGLE: f64 = 1e-12;

/// Multiple of the rounding of a contact's coordinates up to which a gap is none: a gap is a mean of differences of some ten of
/// them, and a larger value would take gaps for none that displacements determine.
pub(crate) const ROUND_OFF_MULTIPLE: f64 = 8.0;

/// Largest rounding of a gap (dimensionless) that a point may have: with [`ACCEPTED_VIOLATION`] below the error 1e-9 that an
/// increment may have.
pub(crate) const LARGEST_ROUNDING_OF_GAP: f64 = 8e-10;

/// Number of unit round-offs that displacements leave in the forces of stiff elements: a force sums a few products of
/// stiffnesses and displacements, each rounded a few times. In structures with forces of one size the value stays far
/// below the tolerance 1e-13 of events; where it does not, a smaller one would take rounding for an event.
pub(crate) const FORCE_ROUND_OFF_MULTIPLE: f64 = 8.0;

/// Largest rounding of a force, over its scale, up to which a negative value does not count as passed. The value is half of
/// the violation 1e-10 that an accepted point may have: a point further beyond the law would be refused.
pub(crate) const LARGEST_ROUNDING_OF_FORCE: f64 = 5e-11;
