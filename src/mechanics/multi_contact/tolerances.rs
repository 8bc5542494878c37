//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Distance of a reaction from the friction cone, over the force scale at its node, that may be round-off of the
/// location of an event. The bound lies a few thousand unit round-offs above exact location and a hundred times below
/// the relative tolerance 1e-10, so that round-off decides only where the friction bound is below a hundredth of the
/// forces at the node.
pub(crate) const CONE_ROUNDING: f64 = 1e-12;

/// Largest rounding of stiff elements, over the friction bound, within which a traction counts as on the cone: the load of
/// a slip is off by as much. A larger value shows in the loads of contacts with small friction, a smaller one makes a
/// slip start beyond where its event was located.
pub(crate) const LARGEST_ROUNDING_OF_BOUND: f64 = 1e-8;

/// Sine of the angle between the normals of a node's contacts (or of a normal with the span of others) up to which the
/// normals are dependent. The solution for reactions or positions amplifies round-off by the inverse sine, to at most
/// 2e-10, below the error 1e-9 that an increment may have; normals closer to parallel leave the reactions or the
/// position undetermined.
pub(crate) const INDEPENDENCE_SINE: f64 = 1e-6;

/// Velocity along a plane (per load factor), relative to the velocities of the planes, up to which the carried node
/// sticks to the plane, or two planes do not part. The bound lies a few thousand unit round-offs above an exact zero,
/// and a true slip at a smaller velocity would not show over the path.
pub(crate) const RESTING_VELOCITY: f64 = 1e-12;

/// Smallest cosine of the angle, 1.4e-3, between the slips of two contacts of a node that belong to one motion along an
/// edge. Both slips follow the same edge, so that the angle only has to cover the errors of the directions; slips in
/// separate motions differ by angles of order one.
pub(crate) const ONE_MOTION_COSINE: f64 = 1.0 - 1e-6;
