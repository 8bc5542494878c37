//! The target of the assembly of a matrix, entry by entry.

use nalgebra::DMatrix;

/// The target of the assembly of a matrix.
pub trait Sink {
    /// Adds to an entry.
    fn add(&mut self, row: usize, column: usize, value: f64);
}

impl Sink for DMatrix<f64> {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self[(row, column)] += value;
    }
}
