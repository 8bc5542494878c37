//! Linear systems given by their entries: dense where small, sparse where large.

use crate::algebra::sparse::factors::pivoted_lu::GeneralLu;
use faer::sparse::Triplet;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// Number of unknowns up to which a dense factorisation is faster (measured on rows of one to fifty snapping bars).
const MOST_DENSE: usize = 40;

/// A factorised square matrix.
pub enum SquareMatrixFactors {
    Dense(Box<LU<f64, Dyn, Dyn>>),
    Sparse(Box<GeneralLu>),
}

impl SquareMatrixFactors {
    /// Factorises; entries at the same place add up. The symbolic factorisation is taken from `before` where the
    /// patterns agree. `None` where the factorisation fails; a singular matrix may pass and shows in the residual.
    pub fn new(size: usize, entries: &[(usize, usize, f64)], before: Option<&Self>) -> Option<Self> {
        if size <= MOST_DENSE {
            let mut matrix = DMatrix::zeros(size, size);
            entries.iter().for_each(|&(row, column, value)| matrix[(row, column)] += value);
            return Some(Self::Dense(Box::new(matrix.lu())));
        }
        let entries: Vec<_> = entries.iter().map(|&(row, column, value)| Triplet::new(row, column, value)).collect();
        let before = match before {
            Some(Self::Sparse(before)) => Some(before.as_ref()),
            Some(Self::Dense(_)) | None => None,
        };
        Some(Self::Sparse(Box::new(GeneralLu::new(size, entries, before)?)))
    }

    /// The solution for a right-hand side; `None` where the solve fails or the solution is not finite.
    pub fn solve(&self, right: &DVector<f64>) -> Option<DVector<f64>> {
        let mut values = right.clone();
        if values.is_empty() {
            return Some(values);
        }
        let solved = match self {
            Self::Dense(lu) => lu.solve_mut(&mut values) && values.iter().all(|value| value.is_finite()),
            Self::Sparse(lu) => lu.solve(values.as_mut_slice()),
        };
        solved.then_some(values)
    }

    /// The solution of the transposed system; `None` where the solve fails or the solution is not finite.
    pub fn solve_transposed(&self, right: &DVector<f64>) -> Option<DVector<f64>> {
        let mut values = right.clone();
        if values.is_empty() {
            return Some(values);
        }
        let solved = match self {
            Self::Dense(lu) => {
                let solved = lu.u().tr_solve_upper_triangular_mut(&mut values)
                    && lu.l().tr_solve_lower_triangular_mut(&mut values);
                lu.p().inv_permute_rows(&mut values);
                solved && values.iter().all(|value| value.is_finite())
            }
            Self::Sparse(lu) => lu.solve_transposed(values.as_mut_slice()),
        };
        solved.then_some(values)
    }
}

/// The product of a matrix, given by its entries, with a vector.
pub fn product(entries: &[(usize, usize, f64)], vector: &DVector<f64>) -> DVector<f64> {
    let mut product = DVector::zeros(vector.len());
    entries.iter().for_each(|&(row, column, value)| product[row] += value * vector[column]);
    product
}
