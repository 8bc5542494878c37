//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Fraction of a force up to which its distance from the bound of the sum of the cones is assigned to one contact.
/// Close to the bound the reactions of least norm are not always found; the remainder points into the cones and changes
/// the shares of the contacts by at most this fraction, but neither their sum nor the motion of the node.
pub(crate) const SHARED_BOUND_DISTANCE: f64 = 1e-7;

/// Cosine of the angle between a direction and a normal up to which the two are perpendicular: the direction leads into
/// no obstacle, or grazes the obstacle. The value is the error 1e-9 that rates and increments may have, far above the
/// round-off of unit vectors.
pub(crate) const PERPENDICULAR_COSINE: f64 = 1e-9;

/// Sine of the angle between two normals, and determinant of three, above which normals are independent; an edge lies
/// in a plane up to this sine. The solution for reactions amplifies round-off by the inverse, to at most 2e-10, below
/// the error 1e-9 that an increment may have.
pub(crate) const INDEPENDENCE_SINE: f64 = 1e-6;

/// Sines of angles to the bounds of friction cones, and components over the force, up to which a difference is
/// round-off; cones closer to all of space than this angle count as not all of space. The bound is a few thousand unit
/// round-offs, and a force accepted as held then lies outside the true cones by no more than this fraction, far below
/// the permitted violation 1e-10.
pub(crate) const CONE_TOLERANCE: f64 = 1e-12;

/// Distance of a force from a bound, relative to the force, within which the force is on the bound. The value is the
/// error 1e-9 that an increment may have and ten times the violation 1e-10 that a point may have, so that a force
/// located at the bound is recognised.
pub(crate) const BOUND_TOLERANCE: f64 = 1e-9;

/// Distance of a force from a bound, relative to the forces that meet at the node, within which the force is on the
/// bound, and size up to which the node is unloaded: the round-off of these forces. The bound is a few thousand unit
/// round-offs, a hundred times below the tolerance 1e-10 at which a reaction counts as zero.
pub(crate) const MEETING_FORCE_ROUNDING: f64 = 1e-12;

/// Components of a force or of its rate, relative to its size, up to which a component is zero. The bound is a few
/// thousand unit round-offs, above the rounding of the solution for normal reactions at usual angles, and far below the
/// violation 1e-10 that a point may have.
pub(crate) const NEGLIGIBLE_COMPONENT: f64 = 1e-12;
