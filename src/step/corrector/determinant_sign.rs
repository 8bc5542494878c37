//! When the sign of a factorisation's determinant is certain.

/// Ratio of the smallest to the largest pivot below which the sign of the determinant is uncertain.
pub const UNCERTAIN: f64 = 1e-10;
