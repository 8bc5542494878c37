//! Sparse LU factorisation of the whole matrix, where block elimination loses too many digits or has too many borders.

use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::factors::pivoted_lu::GeneralLu;
use faer::sparse::Triplet;

pub(super) struct WholeLu(GeneralLu);

impl WholeLu {
    /// Factorises; `None` where the factorisation fails. A singular matrix may pass and shows in the residual.
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
        GeneralLu::new(matrix.size(), entries, None).map(Self)
    }

    pub fn solve(&self, values: &mut [f64]) -> bool {
        self.0.solve(values)
    }
}
