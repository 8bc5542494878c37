//! A matrix stored by the entries of its rows.

#![warn(missing_docs)]

use nalgebra::{DMatrix, DVector};
use smallvec::{SmallVec, smallvec};
use std::ops::{Index, IndexMut, Mul};

/// A matrix with few entries per row, as in gradients of a structure's functions. Places without an entry are zero; an
/// entry once written remains, zero or not, so that matrices written in the same way have the same pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseRows {
    columns: usize,
    rows: Vec<SparseRow>,
}

/// A row; with few entries, as most rows have, it needs no heap allocation.
type SparseRow = SmallVec<[(usize, f64); 6]>;

static ZERO: f64 = 0.0;

impl SparseRows {
    /// The zero matrix, without entries.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { columns, rows: vec![SparseRow::new(); rows] }
    }

    /// The identity matrix.
    pub fn identity(size: usize) -> Self {
        Self { columns: size, rows: (0..size).map(|i| smallvec![(i, 1.0)]).collect() }
    }

    /// Number of rows.
    pub fn nrows(&self) -> usize {
        self.rows.len()
    }

    /// Number of columns.
    pub fn ncols(&self) -> usize {
        self.columns
    }

    /// Removes all entries.
    pub fn clear(&mut self) {
        self.rows.iter_mut().for_each(SparseRow::clear);
    }

    /// Entries of a row, `(column, value)`, in the order in which they were first written.
    pub fn row(&self, row: usize) -> &[(usize, f64)] {
        &self.rows[row]
    }

    /// Every entry as `(row, column, value)`, row by row.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.rows.iter().enumerate().flat_map(|(i, row)| row.iter().map(move |&(j, value)| (i, j, value)))
    }

    /// Replaces the entries of a row.
    pub fn set_row(&mut self, row: usize, entries: impl IntoIterator<Item = (usize, f64)>) {
        self.rows[row].clear();
        self.rows[row].extend(entries);
    }

    /// Adds `factor` times entries to a row.
    pub fn add_to_row(&mut self, row: usize, factor: f64, entries: &[(usize, f64)]) {
        for &(column, value) in entries {
            self[(row, column)] += factor * value;
        }
    }

    /// Product of a row with a vector.
    pub fn dot(&self, row: usize, vector: &DVector<f64>) -> f64 {
        self.rows[row].iter().map(|&(column, value)| value * vector[column]).sum()
    }

    /// Product of the transpose with a vector.
    pub fn tr_mul(&self, vector: &DVector<f64>) -> DVector<f64> {
        let mut product = DVector::zeros(self.columns);
        for (row, column, value) in self.entries() {
            product[column] += value * vector[row];
        }
        product
    }

    /// Copies a dense matrix of the same shape; its zeros become no entries.
    pub fn copy_from(&mut self, matrix: &DMatrix<f64>) {
        *self = Self::from(matrix);
    }

    /// The matrix in dense storage.
    pub fn to_dense(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.nrows(), self.columns);
        self.entries().for_each(|(row, column, value)| matrix[(row, column)] = value);
        matrix
    }

    /// Adds empty columns, up to the given number.
    pub fn widen(&mut self, columns: usize) {
        self.columns = self.columns.max(columns);
    }

    /// Largest absolute value; 0 for a matrix without entries.
    pub fn amax(&self) -> f64 {
        self.entries().fold(0.0, |largest, (_, _, value)| largest.max(value.abs()))
    }

    /// Whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.entries().all(|(_, _, value)| value.is_finite())
    }
}

impl From<&DMatrix<f64>> for SparseRows {
    fn from(matrix: &DMatrix<f64>) -> Self {
        let entries = |i: usize| {
            (0..matrix.ncols()).map(|j| (j, matrix[(i, j)])).filter(|(_, value)| *value != 0.0).collect::<SparseRow>()
        };
        Self { columns: matrix.ncols(), rows: (0..matrix.nrows()).map(entries).collect() }
    }
}

impl Index<(usize, usize)> for SparseRows {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        self.rows[row].iter().find(|(place, _)| *place == column).map_or(&ZERO, |(_, value)| value)
    }
}

impl IndexMut<(usize, usize)> for SparseRows {
    /// Creates the entry where there is none.
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        let entries = &mut self.rows[row];
        let place = entries.iter().position(|(place, _)| *place == column).unwrap_or_else(|| {
            entries.push((column, 0.0));
            entries.len() - 1
        });
        &mut entries[place].1
    }
}

impl Mul<&DVector<f64>> for &SparseRows {
    type Output = DVector<f64>;

    fn mul(self, vector: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.nrows(), |row, _| self.dot(row, vector))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_dense_matrix() {
        let mut sparse = SparseRows::zeros(3, 4);
        sparse[(0, 3)] = 2.0;
        sparse[(2, 1)] -= 0.5;
        sparse[(2, 0)] = 3.0;
        sparse[(2, 1)] += 1.5;
        let dense = sparse.to_dense();
        assert_eq!((dense[(0, 3)], dense[(2, 1)], dense[(1, 1)], sparse[(1, 1)]), (2.0, 1.0, 0.0, 0.0));
        let (x, y) = (DVector::from_fn(4, |i, _| 1.0 + i as f64), DVector::from_fn(3, |i, _| 2.0 - i as f64));
        assert_eq!(&sparse * &x, &dense * &x);
        assert_eq!(sparse.tr_mul(&y), dense.tr_mul(&y));
        assert_eq!(SparseRows::from(&dense).to_dense(), dense);
    }
}
