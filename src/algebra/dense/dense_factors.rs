//! The interface of dense factors, whatever their storage.

use nalgebra::DVector;

/// The factors of a matrix, of a size known at compile time or not.
pub(crate) trait DenseFactors: Send + Sync {
    /// Number of rows.
    fn size(&self) -> usize;
    /// Sign of the determinant: 1 or -1.
    fn determinant_sign(&self) -> f64;
    /// Solves for one right-hand side, overwritten by the solution; `false` when the result is not finite.
    fn solve(&self, right_hand_side: &mut DVector<f64>) -> bool;
}
