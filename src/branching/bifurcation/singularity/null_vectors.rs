//! Null vectors of the equations of a mode at a singular point.

use nalgebra::DVector;

/// Null vectors of the equations of a mode.
#[derive(Debug)]
pub struct NullVectors {
    /// Right null vectors over the unknowns, one more than there are left ones.
    pub right: Vec<DVector<f64>>,
    /// Left null vectors over the equations without the last.
    pub left: Vec<DVector<f64>>,
}
