//! Dense LU factorisation with partial pivoting of large matrices, column by column, with a budget check before each
//! column.

use crate::algebra::dense::dense_factors::DenseFactors;
use crate::resources::budget::{self, Taken};
use nalgebra::{DMatrix, DVector};

/// The factorisation `P A = L U`, stored in place of `A`; `L` has a unit diagonal.
pub(crate) struct LargeLu {
    factors: DMatrix<f64>,
    /// The row exchanged with each row.
    exchanges: Vec<usize>,
    row_scales: DVector<f64>,
    _held: Taken,
}

impl LargeLu {
    /// Factorises a matrix whose rows were divided by `row_scales`.
    pub fn new(mut matrix: DMatrix<f64>, row_scales: DVector<f64>) -> Self {
        let size = matrix.nrows();
        let held = budget::take::<f64>(size * size);
        let mut exchanges = Vec::with_capacity(size);
        for pivot in 0..size {
            let rest = size - pivot;
            budget::spend(rest * rest);
            let column = &matrix.as_slice()[pivot * size + pivot..(pivot + 1) * size];
            let largest =
                column.iter().enumerate().fold(
                    (0, -1.0),
                    |best: (usize, f64), (row, value)| {
                        if value.abs() > best.1 { (row, value.abs()) } else { best }
                    },
                );
            let other = pivot + largest.0;
            exchanges.push(other);
            if largest.1 == 0.0 {
                continue;
            }
            if other != pivot {
                matrix.swap_rows(pivot, other);
            }
            let (before, after) = matrix.as_mut_slice().split_at_mut((pivot + 1) * size);
            let column = &mut before[pivot * size + pivot..];
            let inverse = 1.0 / column[0];
            column[1..].iter_mut().for_each(|value| *value *= inverse);
            for next in after.chunks_exact_mut(size) {
                let factor = next[pivot];
                if factor != 0.0 {
                    let below = next[pivot + 1..].iter_mut().zip(&column[1..]);
                    below.for_each(|(value, entry)| *value -= factor * entry);
                }
            }
        }
        Self { factors: matrix, exchanges, row_scales, _held: held }
    }

    /// Sign of the permutation: 1 or -1.
    pub fn exchange_sign(&self) -> f64 {
        let exchanged = self.exchanges.iter().enumerate().filter(|(row, other)| row != *other).count();
        if exchanged % 2 == 1 { -1.0 } else { 1.0 }
    }

    /// The pivots: the diagonal of `U`.
    pub fn pivots(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.factors.nrows()).map(|index| self.factors[(index, index)])
    }
}

impl DenseFactors for LargeLu {
    fn size(&self) -> usize {
        self.factors.nrows()
    }

    fn determinant_sign(&self) -> f64 {
        self.pivots().fold(self.exchange_sign(), |sign, pivot| sign * pivot.signum())
    }

    fn solve(&self, right_hand_side: &mut DVector<f64>) -> bool {
        let size = self.size();
        budget::spend(size * size);
        let values = right_hand_side.as_mut_slice();
        values.iter_mut().zip(self.row_scales.iter()).for_each(|(value, scale)| *value /= scale);
        self.exchanges.iter().enumerate().for_each(|(row, other)| values.swap(row, *other));
        for (index, column) in self.factors.as_slice().chunks_exact(size).enumerate() {
            let value = values[index];
            values[index + 1..].iter_mut().zip(&column[index + 1..]).for_each(|(sum, entry)| *sum -= value * entry);
        }
        for (index, column) in self.factors.as_slice().chunks_exact(size).enumerate().rev() {
            values[index] /= column[index];
            let value = values[index];
            values[..index].iter_mut().zip(column).for_each(|(sum, entry)| *sum -= value * entry);
        }
        values.iter().all(|value| value.is_finite())
    }
}
