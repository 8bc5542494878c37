//! What a matrix is assembled into, entry by entry.

use nalgebra::DMatrix;

/// What a matrix is assembled into.
pub trait Sink {
    /// Adds to an entry.
    fn add(&mut self, row: usize, column: usize, value: f64);
}

impl Sink for DMatrix<f64> {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self[(row, column)] += value;
    }
}
