//! The numerical tolerances, factors and limits of this folder, with the reason for each value.

/// Part of its diagonal by which a matrix may be reduced and still count as definite, or is increased so that a motion
/// without resistance can be found. The margin is a few thousand unit round-offs, so that the rounding of the
/// factorisation alone cannot make a matrix definite, and small enough for structures with soft parts; without a proof
/// all modes are searched.
pub(crate) const DEFINITENESS_MARGIN: f64 = 1e-12;

/// Smallest value of the determinant of the Schur complement, relative to its terms, at which the sign of the
/// determinant counts. The terms come from solves with a definite matrix, and the bound 1e-9 leaves room for the
/// amplification of the unit round-off by more than a million; without a clear sign all modes are searched, so that a
/// larger value costs only effort.
pub(crate) const DETERMINANT_TOLERANCE: f64 = 1e-9;

/// The largest `|η|`, the weight that the proof may give to normal motions. The proof holds for every `|η|` below 1,
/// and 0.999 keeps the distance from 1 far above rounding; a larger weight is reduced to the bound or the proof is
/// given up, which affects only effort.
pub(crate) const LARGEST_WEIGHT: f64 = 0.999;
