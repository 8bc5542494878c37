//! Decides whether the sign of a factorisation's determinant is certain: whether its smallest pivot is far enough from
//! zero.
