//! Sparse LU factorisation of any square matrix given by its entries.

use crate::algebra::dense::solve_counters::count_solves;
use crate::algebra::sparse::factors::elimination_order::allow_factor;
use crate::resources::budget;
use faer::MatMut;
use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMat, Triplet};

/// Number of entries up to which the factors are small in any case.
const FEW_ENTRIES: usize = 20_000;
/// Largest number of multiplications of a factorisation that cannot be interrupted, counted as if without row
/// exchanges.
const MOST_IN_ONE_PIECE: u64 = 1_000_000_000;

/// The factorisation `D⁻¹ A = L U` with permutations; `D` contains the largest magnitude of each row.
pub struct GeneralLu {
    lu: Lu<usize, f64>,
    scales: Vec<f64>,
    symbolic: SymbolicLu<usize>,
    columns: Vec<usize>,
    rows: Vec<usize>,
}

impl GeneralLu {
    /// Factorises; entries at the same place add up. The symbolic factorisation is taken from `before` where the
    /// patterns agree. `None` where the factorisation fails; a singular matrix may pass and shows in the residual.
    pub fn new(size: usize, mut entries: Vec<Triplet<usize, usize, f64>>, before: Option<&Self>) -> Option<Self> {
        let mut scales = vec![0.0_f64; size];
        entries.iter().for_each(|entry| scales[entry.row] = scales[entry.row].max(entry.val.abs()));
        if !scales.iter().all(|scale| *scale > 0.0 && scale.is_finite()) {
            return None;
        }
        entries.iter_mut().for_each(|entry| entry.val /= scales[entry.row]);
        let matrix = SparseColMat::try_new_from_triplets(size, size, &entries).ok()?;
        let (columns, rows) = (matrix.symbolic().col_ptr(), matrix.symbolic().row_idx());
        let symbolic = match before.filter(|before| before.columns == columns && before.rows == rows) {
            Some(before) => before.symbolic.clone(),
            None => {
                if entries.len() > FEW_ENTRIES {
                    let places = entries.iter().map(|entry| (entry.row, entry.col));
                    allow_factor(size, places, MOST_IN_ONE_PIECE);
                }
                SymbolicLu::try_new(matrix.symbolic()).ok()?
            }
        };
        budget::spend(entries.len());
        let lu = Lu::try_new_with_symbolic(symbolic.clone(), matrix.as_ref()).ok()?;
        let (columns, rows) = (columns.to_vec(), rows.to_vec());
        Some(Self { lu, scales, symbolic, columns, rows })
    }

    /// Overwrites a right-hand side by the solution; `false` where the solution is not finite.
    pub fn solve(&self, values: &mut [f64]) -> bool {
        count_solves(1);
        values.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value /= scale);
        let size = values.len();
        self.lu.solve_in_place_with_conj(faer::Conj::No, MatMut::from_column_major_slice_mut(values, size, 1));
        values.iter().all(|value| value.is_finite())
    }

    /// Solves with the transposed matrix; `false` where the solution is not finite.
    pub fn solve_transposed(&self, values: &mut [f64]) -> bool {
        count_solves(1);
        let size = values.len();
        self.lu
            .solve_transpose_in_place_with_conj(faer::Conj::No, MatMut::from_column_major_slice_mut(values, size, 1));
        values.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value /= scale);
        values.iter().all(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_serves_twice() {
        let entries = |shift: f64| {
            [(0, 0, 2.0 + shift), (0, 2, -1.0), (1, 0, 300.0), (1, 1, 1e3 - shift), (2, 1, 0.5), (2, 2, 4.0)]
                .map(|(row, column, value)| Triplet::new(row, column, value))
                .to_vec()
        };
        let first = GeneralLu::new(3, entries(0.0), None).expect("regular");
        let second = GeneralLu::new(3, entries(0.25), Some(&first)).expect("regular");
        let x = [1.0, -2.0, 3.0];
        let mut product = [0.0; 3];
        entries(0.25).iter().for_each(|entry| product[entry.row] += entry.val * x[entry.col]);
        assert!(second.solve(&mut product));
        assert!(product.iter().zip(x).all(|(found, x)| (found - x).abs() < 1e-13), "{product:?}");
    }

    /// Small patterns, and filled patterns, which are factorised by blocks.
    #[test]
    fn the_transpose_is_solved_with_the_same_factors() {
        for (size, step) in [(4, 2), (40, 7), (150, 1)] {
            let entries = |transposed: bool| -> Vec<Triplet<usize, usize, f64>> {
                let all = (0..size).flat_map(|row| (0..size).step_by(step).map(move |k| (row, (row + k) % size)));
                let value = |row: usize, column: usize| ((3 * row + 5 * column) % 11) as f64 - 4.5;
                all.map(|(row, column)| {
                    let (row, column) = if row % 2 == 0 { (size - 1 - row, column) } else { (row, column) };
                    let at = if transposed { (column, row) } else { (row, column) };
                    let shift = if (row + column) % size == 1 { 60.0 * size as f64 } else { 0.0 };
                    Triplet::new(at.0, at.1, value(row, column) + shift)
                })
                .chain((0..size).map(|row| {
                    let column = (size + 1 - row) % size;
                    let at = if transposed { (column, row) } else { (row, column) };
                    Triplet::new(at.0, at.1, 100.0 * size as f64)
                }))
                .collect()
            };
            let right: Vec<f64> = (0..size).map(|row| 1.0 + (row % 3) as f64).collect();
            let (mut found, mut expected) = (right.clone(), right);
            assert!(GeneralLu::new(size, entries(false), None).expect("regular").solve_transposed(&mut found));
            assert!(GeneralLu::new(size, entries(true), None).expect("regular").solve(&mut expected));
            let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-12 * expected.iter().fold(0.0_f64, |m, v| m.max(v.abs())), "{size}: {error}");
        }
    }
}
