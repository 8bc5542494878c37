//! Linear algebra: dense factorisations and factorisations of sparse bordered matrices, which report when they are
//! unreliable; fixed points; smooth curves in the plane and smooth closed surfaces in space; numbers that carry derivatives. All higher layers may use this
//! module; it uses none of them.

pub mod dense;
pub(crate) mod differential;
pub(crate) mod fixed_point;
pub mod plane_curve;
pub mod rounded_polyhedron;
pub(crate) mod scalar_root;
pub mod sparse;

use crate::algebra::sparse::preconditioned_refinement::Nearby;
use crate::algebra::sparse::tolerances::ACCEPTED_BACKWARD_ERROR;
use crate::resources::budget;
pub use dense::dense_lu::{Factorisation, Stiffener};
pub use dense::inertia::{Inertia, inertia};
pub use dense::matrix_sink::Sink;
pub use dense::solve_counters::{factorisations, solves};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// The factorisation of a system, dense or sparse as the system was assembled.
pub enum SystemFactorisation {
    Dense(Factorisation),
    Sparse(Arc<sparse::SparseFactorisation>),
}

impl SystemFactorisation {
    /// Sign of the determinant: 1 or -1.
    pub fn determinant_sign(&self) -> f64 {
        match self {
            Self::Dense(dense) => dense.determinant_sign(),
            Self::Sparse(sparse) => sparse.determinant_sign(),
        }
    }

    /// Ratio of the smallest to the largest pivot magnitude.
    pub fn pivot_ratio(&self) -> f64 {
        match self {
            Self::Dense(dense) => dense.pivot_ratio(),
            Self::Sparse(sparse) => sparse.pivot_ratio(),
        }
    }

    /// Solves for one right-hand side, overwritten by the solution; `false` when there is no result.
    pub fn solve(&self, right_hand_side: &mut DVector<f64>) -> bool {
        match self {
            Self::Dense(dense) => dense.solve(right_hand_side),
            Self::Sparse(sparse) => sparse.solve(right_hand_side),
        }
    }

    /// Solves for consecutive right-hand sides of `size` entries each, overwritten by the solutions; `false` when one has
    /// no result.
    pub fn solve_all(&self, right_hand_sides: &mut [f64], size: usize) -> bool {
        if let Self::Sparse(sparse) = self
            && let Some(solutions) = Nearby::itself(sparse).solve_all(right_hand_sides, ACCEPTED_BACKWARD_ERROR)
        {
            right_hand_sides.copy_from_slice(&solutions);
            return true;
        }
        right_hand_sides.chunks_exact_mut(size.max(1)).all(|right| {
            let mut values = DVector::from_column_slice(right);
            let is_solved = self.solve(&mut values);
            right.copy_from_slice(values.as_slice());
            is_solved
        })
    }

    /// Solves like [`Self::solve`] but without checking the residual, for callers that check it themselves.
    pub fn solve_once(&self, right_hand_side: &mut DVector<f64>) -> bool {
        match self {
            Self::Dense(dense) => dense.solve(right_hand_side),
            Self::Sparse(sparse) => sparse.solve_once(right_hand_side) || sparse.solve(right_hand_side),
        }
    }
}

/// A determinant as its sign and the natural logarithm of its magnitude.
#[derive(Debug, Clone, Copy)]
pub struct Determinant {
    /// Sign of the determinant: 1 or -1, or 0 where a pivot is 0.
    pub sign: f64,
    pub logarithm: f64,
    /// Ratio of the smallest to the largest pivot magnitude.
    pub pivot_ratio: f64,
}

/// The determinant of any square matrix, without row scaling. `None` when an entry is not finite.
pub fn determinant(matrix: DMatrix<f64>) -> Option<Determinant> {
    if !matrix.iter().all(|value| value.is_finite()) {
        return None;
    }
    let size = matrix.nrows();
    let (pivots, mut sign): (DVector<f64>, f64) = if size > dense::dense_lu::MOST_AT_ONCE {
        let lu = dense::interruptible_lu::LargeLu::new(matrix, DVector::zeros(0));
        (DVector::from_iterator(size, lu.pivots()), lu.exchange_sign())
    } else {
        let lu = matrix.lu();
        (lu.lu_internal().diagonal(), lu.p().determinant())
    };
    let mut logarithm = 0.0;
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for pivot in pivots.iter() {
        sign *= if *pivot == 0.0 { 0.0 } else { pivot.signum() };
        logarithm += pivot.abs().ln();
        least = least.min(pivot.abs());
        most = most.max(pivot.abs());
    }
    let pivot_ratio = if most > 0.0 { least / most } else { 0.0 };
    Some(Determinant { sign, logarithm, pivot_ratio })
}

/// A basis of the null space, one vector per column, by elimination with complete pivoting.
///
/// Rows are scaled to unit maximum norm first; a pivot below `tolerance` times the first pivot ends the elimination, so
/// that the rank is decided once for the whole matrix. `None` when an entry is not finite.
pub fn null_space(matrix: &DMatrix<f64>, tolerance: f64) -> Option<DMatrix<f64>> {
    let mut work = matrix.clone();
    for mut row in work.row_iter_mut() {
        let size = row.amax();
        if !size.is_finite() {
            return None;
        }
        if size > 0.0 {
            row /= size;
        }
    }
    null_space_as_scaled(work, tolerance)
}

/// A basis of the null space as in [`null_space`], without row scaling: a row of pure round-off counts as zero.
pub fn null_space_as_scaled(work: DMatrix<f64>, tolerance: f64) -> Option<DMatrix<f64>> {
    let most = work.ncols();
    eliminated(work, tolerance, most)
}

/// `dimension` vectors nearest to a null space: the elimination stops at the rank `ncols - dimension`.
pub fn nearest_null_space(work: DMatrix<f64>, dimension: usize) -> Option<DMatrix<f64>> {
    let most = work.ncols().checked_sub(dimension)?;
    eliminated(work, 0.0, most)
}

/// The largest absolute value of finite numbers. Several running maxima, which do not wait for each other.
fn largest_size(values: &[f64]) -> f64 {
    let mut largest = [0.0_f64; 8];
    let mut chunks = values.chunks_exact(8);
    for chunk in &mut chunks {
        for (most, value) in largest.iter_mut().zip(chunk) {
            let size = value.abs();
            *most = if size > *most { size } else { *most };
        }
    }
    chunks.remainder().iter().chain(&largest).fold(0.0, |most, value| value.abs().max(most))
}

/// Eliminates with complete pivoting until the pivots are small or the rank reaches `most`; returns a basis of the null
/// space of the eliminated rows.
fn eliminated(mut work: DMatrix<f64>, tolerance: f64, most: usize) -> Option<DMatrix<f64>> {
    let (rows, columns) = work.shape();
    if !work.iter().all(|value| value.is_finite()) {
        return None;
    }
    let mut order: Vec<usize> = (0..columns).collect();
    let mut rank = 0;
    let mut first_pivot = 0.0_f64;
    while rank < rows.min(columns).min(most) {
        budget::spend((rows - rank) * (columns - rank));
        let (mut best, mut place) = (0.0_f64, (rank, rank));
        for (column, values) in work.as_slice().chunks_exact(rows).enumerate().skip(rank) {
            let values = &values[rank..];
            let largest = largest_size(values);
            if largest > best
                && let Some(row) = values.iter().position(|value| value.abs() == largest)
            {
                (best, place) = (largest, (rank + row, column));
            }
        }
        if rank == 0 {
            first_pivot = best;
        }
        if best <= tolerance * first_pivot {
            break;
        }
        work.swap_rows(rank, place.0);
        work.swap_columns(rank, place.1);
        order.swap(rank, place.1);
        // Column by column, in storage order; the entries below the pivot hold the multipliers.
        let pivot = work[(rank, rank)];
        work.column_mut(rank).iter_mut().skip(rank + 1).for_each(|value| *value /= pivot);
        let (before, after) = work.as_mut_slice().split_at_mut((rank + 1) * rows);
        let factors = &before[rank * rows + rank + 1..];
        for column in after.chunks_exact_mut(rows) {
            let (head, rest) = column[rank..].split_at_mut(1);
            if head[0] != 0.0 {
                rest.iter_mut().zip(factors).for_each(|(value, factor)| *value -= factor * head[0]);
            }
        }
        rank += 1;
    }
    let mut basis = DMatrix::zeros(columns, columns - rank);
    for (vector, free) in (rank..columns).enumerate() {
        budget::spend(rank * rank / 2);
        basis[(order[free], vector)] = 1.0;
        for row in (0..rank).rev() {
            let mut value = work[(row, free)];
            for column in row + 1..rank {
                value += work[(row, column)] * basis[(order[column], vector)];
            }
            basis[(order[row], vector)] = -value / work[(row, row)];
        }
        let size = basis.column(vector).norm();
        basis.column_mut(vector).unscale_mut(size);
    }
    Some(basis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_null_space_has_the_right_dimension() {
        let basis = null_space(&DMatrix::from_row_slice(1, 3, &[1.0, 1.0, 0.0]), 1e-12).unwrap();
        assert_eq!(basis.ncols(), 2);
        assert!(basis.column_iter().all(|column| (column[0] + column[1]).abs() < 1e-14));
    }
}
