//! When the sign of a factorisation's determinant is certain.
