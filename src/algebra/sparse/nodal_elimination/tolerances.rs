//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Entries of the reaction columns along the free directions of a node, relative to the largest entry of these columns,
/// up to which the columns have no frictional part. The rotation of a block of three rows leaves a few unit round-offs
/// of 2e-16; a dropped entry remains in the matrix by which solutions are refined, and a larger bound would drop small
/// coefficients of friction.
pub(crate) const FRICTION_ENTRY_TOLERANCE: f64 = 1e-14;

/// Sine of the angle between the constrained directions of a node, and inverse of the product of the largest entries of
/// a block and of its inverse, at which the node remains in the borders. The elimination of the node amplifies
/// round-off to at most 2e-16/1e-6 = 2e-10, which refinement removes; a node in the borders costs only a larger
/// complement, which is factorised with row exchanges.
pub(crate) const INDEPENDENCE_TOLERANCE: f64 = 1e-6;
