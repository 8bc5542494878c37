//! A matrix to which entries can be added one by one, whatever its storage.

use nalgebra::DMatrix;

/// A matrix to which entries can be added.
pub trait Sink {
    /// Adds to an entry.
    fn add(&mut self, row: usize, column: usize, value: f64);
}

impl Sink for DMatrix<f64> {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self[(row, column)] += value;
    }
}
