//! The second-order cone and complementarity on it.
//!
//! ```text
//! K = { v = (v_0, v_t) : v_0 >= |v_t| },        a ∈ K,  b ∈ K,  a·b = 0
//! ```
//!
//! `K` is self-dual. A vector has the spectral values `v_0 ∓ |v_t|`; its projection on `K` is the sum of the positive
//! spectral values times their spectral vectors `½ (1, ∓ v_t/|v_t|)`. The members of a complementary pair are the two
//! projections of their difference: `a = P(a - b)`, `b = P(b - a)`. Hence either one member vanishes, or both lie on
//! the boundary, opposed: `b_t/b_0 = -a_t/a_0`.
//!
//! Source: M. Fukushima, Z.-Q. Luo and P. Tseng, *Smoothing functions for second-order-cone complementarity problems*,
//! SIAM J. Optim. 12 (2002), doi:10.1137/S1052623400380365 (spectral values, projection).

#![warn(missing_docs)]

use nalgebra::{DMatrix, DVector};

/// The position of a complementary pair relative to the cone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeActivity {
    /// `a = 0`, `b` inside the cone.
    FirstZero,
    /// `b = 0`, `a` inside the cone.
    SecondZero,
    /// Neither vanishes; both lie on the boundary, opposed.
    BothOnBoundary,
    /// `a = 0`, `b` on the boundary: biactive.
    FirstZeroSecondOnBoundary,
    /// `b = 0`, `a` on the boundary: biactive.
    SecondZeroFirstOnBoundary,
    /// Both zero: biactive, with infinitely many possible directions of change.
    BothZero,
    /// Not complementary: the solve ended before complementarity was reached.
    NotComplementary,
}

impl ConeActivity {
    /// The activity of `a` and `b`, lengths up to `tolerance` counting as zero.
    pub fn of(a: &[f64], b: &[f64], tolerance: f64) -> Self {
        let is_zero = |v: &[f64]| v.iter().all(|value| value.abs() <= tolerance);
        let on_boundary = |v: &[f64]| slack(v) <= tolerance;
        match (is_zero(a), is_zero(b)) {
            (true, true) => Self::BothZero,
            (true, false) if on_boundary(b) => Self::FirstZeroSecondOnBoundary,
            (true, false) => Self::FirstZero,
            (false, true) if on_boundary(a) => Self::SecondZeroFirstOnBoundary,
            (false, true) => Self::SecondZero,
            (false, false) if natural_residual(a, b) <= tolerance => Self::BothOnBoundary,
            (false, false) => Self::NotComplementary,
        }
    }

    /// Whether more than one branch meets at the pair.
    pub fn is_biactive(self) -> bool {
        match self {
            Self::FirstZeroSecondOnBoundary | Self::SecondZeroFirstOnBoundary | Self::BothZero => true,
            Self::FirstZero | Self::SecondZero | Self::BothOnBoundary | Self::NotComplementary => false,
        }
    }
}

/// `|v_t|`
pub fn tangential_size(v: &[f64]) -> f64 {
    v.iter().skip(1).fold(0.0_f64, |size, value| size.hypot(*value))
}

/// `v_0 - |v_t|`: nonnegative inside the cone.
pub fn slack(v: &[f64]) -> f64 {
    v.first().copied().unwrap_or(0.0) - tangential_size(v)
}

/// `v_t/|v_t|` after a leading zero; all zero where `v_t` vanishes.
pub fn direction(v: &[f64]) -> DVector<f64> {
    let size = tangential_size(v);
    let usable = size >= f64::MIN_POSITIVE;
    DVector::from_iterator(v.len(), v.iter().enumerate().map(|(i, x)| if i > 0 && usable { x / size } else { 0.0 }))
}

/// The projection on `K`.
pub fn projection(v: &[f64]) -> DVector<f64> {
    let (first, size) = (v.first().copied().unwrap_or(0.0), tangential_size(v));
    if first >= size {
        return DVector::from_column_slice(v);
    }
    if first <= -size {
        return DVector::zeros(v.len());
    }
    let half = 0.5 * (first + size);
    let mut projected = direction(v) * half;
    projected[0] = half;
    projected
}

/// The derivative of the projection, or, where there is none, an element of its B-subdifferential: that of the region
/// between `K` and `-K`, wherever `v` lies on the boundary of this region.
///
/// Between `K` and `-K`, with `w = v_t/|v_t|` and `ρ = v_0/|v_t|`: `½ [[1, wᵀ], [w, (1 + ρ) I - ρ w wᵀ]]`.
pub fn projection_derivative(v: &[f64]) -> DMatrix<f64> {
    let (first, size) = (v.first().copied().unwrap_or(0.0), tangential_size(v));
    let n = v.len();
    if first > size || size < f64::MIN_POSITIVE && first >= 0.0 {
        return DMatrix::identity(n, n);
    }
    if first < -size || size < f64::MIN_POSITIVE {
        return DMatrix::zeros(n, n);
    }
    let w = direction(v);
    let ratio = (first / size).clamp(-1.0, 1.0);
    DMatrix::from_fn(n, n, |i, j| match (i, j) {
        (0, 0) => 0.5,
        (0, k) | (k, 0) => 0.5 * w[k],
        (i, j) => 0.5 * ((1.0 + ratio) * f64::from(u8::from(i == j)) - ratio * w[i] * w[j]),
    })
}

/// Largest entry of `a - P(a - b)`, zero exactly for complementary members.
pub fn natural_residual(a: &[f64], b: &[f64]) -> f64 {
    let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    projection(&difference).iter().zip(a).fold(0.0, |worst, (p, a)| worst.max((a - p).abs()))
}

/// `a·b`
pub fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 3]; 5] =
        [[2.0, 0.5, -0.3], [-2.0, 0.5, -0.3], [0.4, 1.0, -0.7], [-0.4, 1.0, 0.2], [0.0, -0.3, 0.1]];

    /// Moreau's decomposition: `v = P(v) - P(-v)`, the two orthogonal and in the cone.
    #[test]
    fn a_vector_is_the_difference_of_two_complementary_projections() {
        for v in POINTS {
            let (a, b) = (projection(&v), projection(&v.map(|x| -x)));
            assert!(slack(a.as_slice()) >= -1e-15 && slack(b.as_slice()) >= -1e-15);
            assert!(product(a.as_slice(), b.as_slice()).abs() < 1e-15);
            assert!((&a - &b - DVector::from_column_slice(&v)).amax() < 1e-15);
            assert!(natural_residual(a.as_slice(), b.as_slice()) < 1e-15);
        }
    }

    #[test]
    fn the_projections_derivative_is_that_of_differences() {
        for v in POINTS {
            let exact = projection_derivative(&v);
            for j in 0..3 {
                let moved = |h: f64| {
                    let mut w = v;
                    w[j] += h;
                    projection(&w)
                };
                let difference = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                assert!((difference - exact.column(j)).amax() < 1e-9, "{v:?}, column {j}");
            }
        }
    }

    #[test]
    fn activities_are_told_apart() {
        let of = |a: [f64; 3], b: [f64; 3]| ConeActivity::of(&a, &b, 1e-9);
        assert_eq!(of([0.0; 3], [1.0, 0.5, 0.0]), ConeActivity::FirstZero);
        assert_eq!(of([1.0, 0.5, 0.0], [0.0; 3]), ConeActivity::SecondZero);
        assert_eq!(of([1.0, 0.6, 0.8], [2.0, -1.2, -1.6]), ConeActivity::BothOnBoundary);
        assert_eq!(of([0.0; 3], [1.0, 0.6, 0.8]), ConeActivity::FirstZeroSecondOnBoundary);
        assert_eq!(of([1.0, 0.6, 0.8], [0.0; 3]), ConeActivity::SecondZeroFirstOnBoundary);
        assert_eq!(of([0.0; 3], [0.0; 3]), ConeActivity::BothZero);
        assert_eq!(of([1.0, 0.6, 0.8], [2.0, -1.2, 1.6]), ConeActivity::NotComplementary);
    }
}
