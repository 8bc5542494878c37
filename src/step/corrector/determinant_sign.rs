//! When the determinant of a factorisation has a sign.

/// Pivots below this fraction of the largest say nothing of the determinant's sign.
pub const UNCERTAIN: f64 = 1e-10;
