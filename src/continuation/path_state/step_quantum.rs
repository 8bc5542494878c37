//! Lengths of steps in eighths of an octave.

/// The next smaller of eight values an octave: what the factor is computed from is a difference of nearly equal
/// energies, and its round-off must not move the points of the path.
pub(crate) fn quantised(factor: f64) -> f64 {
    ((factor.log2() * 8.0).floor() / 8.0).exp2()
}
