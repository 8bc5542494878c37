//! The inertia of a symmetric matrix: how many eigenvalues are negative, zero and positive.
//!
//! `A = P L D Lᵀ Pᵀ` with 1x1 and 2x2 pivots has the inertia of `D` (Sylvester's law). Pivots by J. R. Bunch and
//! L. Kaufman, Math. Comp. 31 (1977) 163, doi:10.1090/S0025-5718-1977-0428694-0: half the operations of an LU
//! factorisation, and stable for indefinite matrices.

use crate::budget;
use nalgebra::DMatrix;

/// Numbers of eigenvalues by sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inertia {
    pub negative: usize,
    pub zero: usize,
    pub positive: usize,
}

/// `(1 + √17)/8`, which bounds the growth of the elements.
const ALPHA: f64 = 0.640_388_203_202_208;

/// Counts the eigenvalues of a symmetric matrix by sign; only the lower triangle is read.
///
/// Pivots of size up to `tolerance` times the largest entry count as zero. `None` when a number is not finite.
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
    let mut count = Inertia::default();
    let mut k = 0;
    while k < size {
        budget::spend((size - k) * (size - k));
        let (row, below) = largest_below(&a, k, k);
        let diagonal = a[(k, k)].abs();
        if diagonal.max(below) <= zero {
            count.zero += 1;
            k += 1;
            continue;
        }
        let mut pair = false;
        if diagonal < ALPHA * below {
            let beside = largest_beside(&a, k, row);
            if diagonal * beside >= ALPHA * below * below {
                // The diagonal entry serves after all.
            } else if a[(row, row)].abs() >= ALPHA * beside {
                swap(&mut a, k, row);
            } else {
                swap(&mut a, k + 1, row);
                pair = true;
            }
        }
        if pair {
            count.negative += 1;
            count.positive += 1;
            eliminate_pair(&mut a, k);
            k += 2;
        } else {
            if a[(k, k)].abs() <= zero {
                count.zero += 1;
            } else if a[(k, k)] < 0.0 {
                count.negative += 1;
            } else {
                count.positive += 1;
            }
            eliminate(&mut a, k);
            k += 1;
        }
    }
    Some(count)
}

/// Row and size of the largest entry below the diagonal of a column.
fn largest_below(a: &DMatrix<f64>, k: usize, column: usize) -> (usize, f64) {
    let mut best = (k, 0.0);
    for row in k + 1..a.nrows() {
        if a[(row, column)].abs() > best.1 {
            best = (row, a[(row, column)].abs());
        }
    }
    best
}

/// Size of the largest entry off the diagonal in a row of the rest of the matrix.
fn largest_beside(a: &DMatrix<f64>, k: usize, row: usize) -> f64 {
    let left = (k..row).fold(0.0_f64, |largest, column| largest.max(a[(row, column)].abs()));
    (row + 1..a.nrows()).fold(left, |largest, below| largest.max(a[(below, row)].abs()))
}

/// Exchanges rows and columns `first < second` of the lower triangle.
fn swap(a: &mut DMatrix<f64>, first: usize, second: usize) {
    if first == second {
        return;
    }
    a.swap((first, first), (second, second));
    for row in second + 1..a.nrows() {
        a.swap((row, first), (row, second));
    }
    for between in first + 1..second {
        a.swap((between, first), (second, between));
    }
    for column in 0..first {
        a.swap((first, column), (second, column));
    }
}

fn eliminate(a: &mut DMatrix<f64>, k: usize) {
    let pivot = a[(k, k)];
    let size = a.nrows();
    if pivot == 0.0 {
        return;
    }
    for column in k + 1..size {
        let factor = a[(column, k)] / pivot;
        if factor != 0.0 {
            for row in column..size {
                a[(row, column)] -= factor * a[(row, k)];
            }
        }
    }
}

/// Eliminates with the indefinite pivot of rows `k` and `k + 1`.
fn eliminate_pair(a: &mut DMatrix<f64>, k: usize) {
    let size = a.nrows();
    let off = a[(k + 1, k)];
    // Divided by the off-diagonal entry, which is the largest of the three.
    let (first, second) = (a[(k, k)] / off, a[(k + 1, k + 1)] / off);
    let determinant = (first * second - 1.0) * off;
    for column in k + 2..size {
        let (p, q) = (a[(column, k)], a[(column, k + 1)]);
        let (x, y) = ((second * p - q) / determinant, (first * q - p) / determinant);
        for row in column..size {
            a[(row, column)] -= x * a[(row, k)] + y * a[(row, k + 1)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries that look random, the same each time.
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
                    // Zeros on the diagonal ask for 2x2 pivots.
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
}
