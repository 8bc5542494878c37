//! The dense complement of the borders, `D - C K⁻¹ B = D - cᵀ b`, with the halves `b = L⁻¹ B` and `c = U⁻ᵀ Cᵀ`.

use crate::algebra::sparse::border_schur::half_solutions::HalfSolutions;
use nalgebra::{DMatrix, Dyn, LU};

/// The factorised complement, its rows and columns divided by the magnitudes of their terms.
///
/// By the inequality of Cauchy and Schwarz an entry of `cᵀ b` is at most the product of the norms `√(Σ b²/|d|)` and
/// `√(Σ c² |d|)`, `d` the pivots: the columns are divided by the former, the rows by the larger of the latter and their
/// entries of `D`.
pub(super) struct Complement {
    row_scales: Vec<f64>,
    column_scales: Vec<f64>,
    factors: LU<f64, Dyn, Dyn>,
    pub sign: f64,
    /// The smallest pivot magnitude, with terms of at most about 1.
    pub pivot_ratio: f64,
}

impl Complement {
    /// Forms and factorises the complement; `None` where a number is not finite or a row or a column has no terms.
    pub fn new(corner: &DMatrix<f64>, rows: &HalfSolutions, columns: &HalfSolutions, pivots: &[f64]) -> Option<Self> {
        let mut sums = corner - rows.products_with(columns, pivots.len());
        let mut column_scales = columns.norms(|place| 1.0 / pivots[place].abs());
        for (scale, column) in column_scales.iter_mut().zip(corner.column_iter()) {
            if *scale == 0.0 {
                *scale = column.amax();
            }
        }
        let mut row_scales = rows.norms(|place| pivots[place].abs());
        for (scale, row) in row_scales.iter_mut().zip(corner.row_iter()) {
            let of_corner = row.iter().zip(&column_scales).map(|(entry, scale)| (entry / scale).abs());
            *scale = of_corner.fold(*scale, f64::max);
        }
        if !row_scales.iter().chain(&column_scales).all(|scale| scale.is_finite() && *scale > 0.0) {
            return None;
        }
        for (mut column, column_scale) in sums.column_iter_mut().zip(&column_scales) {
            column.iter_mut().zip(&row_scales).for_each(|(value, row_scale)| *value /= column_scale * row_scale);
        }
        let factors = sums.lu();
        let diagonal = factors.lu_internal().diagonal();
        let exchanges: f64 = factors.p().determinant();
        let sign = diagonal.iter().fold(exchanges, |sign, pivot| sign * pivot.signum());
        let pivot_ratio = diagonal.iter().fold(1.0, |least: f64, pivot| least.min(pivot.abs()));
        pivot_ratio.is_finite().then_some(Self { row_scales, column_scales, factors, sign, pivot_ratio })
    }

    /// Solves for the columns of a matrix, overwritten by the solutions.
    pub fn solve(&self, values: &mut DMatrix<f64>) -> bool {
        // Without borders there is nothing to solve for.
        if values.nrows() == 0 {
            return true;
        }
        for mut column in values.column_iter_mut() {
            column.iter_mut().zip(&self.row_scales).for_each(|(value, scale)| *value /= scale);
        }
        if !self.factors.solve_mut(values) {
            return false;
        }
        for mut column in values.column_iter_mut() {
            column.iter_mut().zip(&self.column_scales).for_each(|(value, scale)| *value /= scale);
        }
        true
    }
}
