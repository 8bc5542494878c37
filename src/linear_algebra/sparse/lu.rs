//! Sparse LU factorisation of the whole, where block elimination loses too many digits or has too many borders.

use super::bordered::Bordered;
use faer::MatMut;
use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};

pub(super) struct WholeLu {
    lu: Lu<usize, f64>,
    scales: Vec<f64>,
}

impl WholeLu {
    /// `None` where it fails; a singular matrix may pass, and shows in the residual.
    pub fn new(matrix: &Bordered) -> Option<Self> {
        let n = matrix.pattern.size();
        let mut entries = Vec::with_capacity(matrix.values.len());
        for column in 0..n {
            for place in matrix.pattern.column(column) {
                entries.push(Triplet::new(matrix.pattern.rows[place], column, matrix.values[place]));
            }
        }
        for (border, column) in matrix.right.iter().enumerate() {
            entries.extend(column.iter().map(|(row, value)| Triplet::new(*row, n + border, *value)));
        }
        for (border, row) in matrix.lower.iter().enumerate() {
            entries.extend(row.iter().map(|(column, value)| Triplet::new(n + border, *column, *value)));
        }
        let mut scales = vec![0.0_f64; matrix.size()];
        entries.iter().for_each(|entry| scales[entry.row] = scales[entry.row].max(entry.val.abs()));
        if !scales.iter().all(|scale| *scale > 0.0 && scale.is_finite()) {
            return None;
        }
        entries.iter_mut().for_each(|entry| entry.val /= scales[entry.row]);
        let matrix = SparseColMat::try_new_from_triplets(matrix.size(), matrix.size(), &entries).ok()?;
        Some(Self { lu: matrix.sp_lu().ok()?, scales })
    }

    pub fn solve(&self, values: &mut [f64]) -> bool {
        values.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value /= scale);
        let size = values.len();
        self.lu.solve_in_place_with_conj(faer::Conj::No, MatMut::from_column_major_slice_mut(values, size, 1));
        values.iter().all(|value| value.is_finite())
    }
}
