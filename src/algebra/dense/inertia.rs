//! The inertia of a symmetric matrix: how many eigenvalues are negative, zero and positive.
//!
//! `P A Pᵀ = L D Lᵀ` with 1x1 and 2x2 pivots has the inertia of `D` (Sylvester's law). The `faer` library factorises; a
//! 1x1 pivot is nearly as large as the other entries of its row, and the off-diagonal entry of a 2x2 pivot is the
//! largest of both its rows (rook pivoting: C. Ashcraft, R. G. Grimes, J. G. Lewis, SIAM J. Matrix Anal. Appl. 20
//! (1998) 513, doi:10.1137/S0895479896296921). The growth of entries is therefore bounded, and a 2x2 pivot has one
//! eigenvalue of each sign.

use crate::resources::budget;
use faer::dyn_stack::MemStack;
use faer::linalg::cholesky::lblt::factor::{
    LbltParams, PivotingStrategy, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::{ColMut, MatMut, Par, Spec};
use nalgebra::DMatrix;
use smallvec::SmallVec;
use std::mem::MaybeUninit;

/// Numbers of eigenvalues by sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inertia {
    pub negative: usize,
    pub zero: usize,
    pub positive: usize,
}

/// Counts the eigenvalues of a symmetric matrix by sign; only the lower triangle is read.
///
/// Pivots of magnitude up to `tolerance` times the largest entry count as zero. `None` when an entry of the matrix or
/// of `D` is not finite.
pub fn inertia(mut a: DMatrix<f64>, tolerance: f64) -> Option<Inertia> {
    let size = a.nrows();
    let mut largest = 0.0_f64;
    for column in 0..size {
        for row in column..size {
            if !a[(row, column)].is_finite() {
                return None;
            }
            largest = largest.max(a[(row, column)].abs());
        }
    }
    let zero = tolerance * largest;
    budget::spend(size * size * size / 3);
    let beside = factorise(&mut a);
    let mut count = Inertia::default();
    let mut place = 0;
    while place < size {
        let (pivot, off) = (a[(place, place)], beside[place]);
        if !pivot.is_finite() || !off.is_finite() {
            return None;
        }
        match (off.abs() > zero, pivot.abs() > zero) {
            (true, _) => {
                count.negative += 1;
                count.positive += 1;
            }
            (false, true) if pivot < 0.0 => count.negative += 1,
            (false, true) => count.positive += 1,
            (false, false) => count.zero += 1,
        }
        place += if off.abs() > zero { 2 } else { 1 };
    }
    Some(count)
}

/// One value for each row; a small matrix needs no heap allocation.
type Few<T> = SmallVec<[T; FEW]>;
const FEW: usize = 16;

/// Overwrites the diagonal with that of `D`; returns the off-diagonal entries of the 2x2 pivots, each at the first
/// index of its pivot.
fn factorise(a: &mut DMatrix<f64>) -> Few<f64> {
    let size = a.nrows();
    let mut params = Spec::<LbltParams, f64>::default();
    // With the library's partial pivoting a 2x2 pivot may be singular. With blocks of columns an entry is computed
    // twice, and the pivot search could cycle where the two values differ by rounding.
    (params.pivoting, params.block_size) = (PivotingStrategy::Rook, 1);
    let mut beside = Few::from_elem(0.0, size);
    let (mut order, mut place_of) = (Few::from_elem(0_usize, size), Few::from_elem(0_usize, size));
    let request = cholesky_in_place_scratch::<usize, f64>(size, Par::Seq, params);
    let mut memory: SmallVec<[MaybeUninit<u8>; 16 * FEW]> =
        SmallVec::from_elem(MaybeUninit::uninit(), request.unaligned_bytes_required());
    cholesky_in_place(
        MatMut::from_column_major_slice_mut(a.as_mut_slice(), size, size),
        ColMut::from_slice_mut(&mut beside).as_diagonal_mut(),
        &mut order,
        &mut place_of,
        Par::Seq,
        MemStack::new(&mut memory),
        params,
    );
    beside
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reproducible pseudo-random entries.
    fn pseudo_random(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }

    #[test]
    fn eigenvalues_are_counted() {
        let mut seed = 7;
        for size in 1..24 {
            for shift in [0.0, 0.7, -1.3] {
                let mut a = DMatrix::from_fn(size, size, |_, _| pseudo_random(&mut seed));
                a = &a + a.transpose();
                for k in 0..size {
                    // Zeros on the diagonal require 2x2 pivots.
                    a[(k, k)] = if shift == 0.0 { 0.0 } else { a[(k, k)] + shift };
                }
                let values = a.symmetric_eigenvalues();
                let negative = values.iter().filter(|value| **value < 0.0).count();
                let expected = if values.iter().any(|value| value.abs() < 1e-12) { continue } else { negative };
                let found = inertia(a, 1e-14).unwrap();
                assert_eq!((found.negative, found.zero, found.positive), (expected, 0, size - expected));
            }
        }
    }

    #[test]
    fn zero_eigenvalues_are_told() {
        let a = DMatrix::from_row_slice(3, 3, &[1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, -2.0]);
        assert_eq!(inertia(a, 1e-14), Some(Inertia { negative: 1, zero: 1, positive: 1 }));
        assert_eq!(inertia(DMatrix::from_element(1, 1, f64::NAN), 1e-14), None);
        assert_eq!(inertia(DMatrix::zeros(0, 0), 1e-14), Some(Inertia::default()));
    }

    /// The 2x2 pivot on the largest entry of the first row has a determinant of zero or nearly so, and a 1x1 pivot is
    /// small compared with the third row.
    #[test]
    fn a_small_pivot_beside_a_large_row_is_passed_over() {
        for (first, large) in [(0.5, 100.0), (0.6, 1e10), (0.0, 1e12)] {
            let a = DMatrix::from_row_slice(3, 3, &[first, 1.0, 0.0, 1.0, 2.0, large, 0.0, large, 0.0]);
            let positive = if first > 0.0 { 2 } else { 1 };
            let expected = Inertia { negative: 1, zero: 2 - positive, positive };
            assert_eq!(inertia(a, 1e-14), Some(expected), "{first} {large}");
        }
    }
}
