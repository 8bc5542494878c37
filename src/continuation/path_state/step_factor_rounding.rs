//! Rounds factors of the step length down to powers of `2^(1/8)`.

/// The factor rounded down to one of eight values per octave: the factor is computed from a difference of nearly equal
/// energies, whose round-off must not shift the points of the path.
pub(crate) fn quantised(factor: f64) -> f64 {
    ((factor.log2() * 8.0).floor() / 8.0).exp2()
}
