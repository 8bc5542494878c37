//! The rows of the equations over the largest entry that any element has in them, and the rank of what is left.

use crate::mechanics::equations::ModeSystem;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;
use nalgebra::{DMatrix, DVector};

/// The mode's equations without the last, each row over the largest entry that any element has in it: where the
/// elements' stiffnesses cancel, at a singular point, what is left over stays small. With the sizes of the rows.
pub fn scaled_rows(system: &ModeSystem<'_>, loading: Loading<'_>, state: &State) -> (DMatrix<f64>, DVector<f64>) {
    let structure = loading.structure;
    let rows = system.size() - 1;
    let mut matrix = system.matrix(state).rows(0, rows).into_owned();
    let mut sizes = DVector::from_fn(rows, |row, _| matrix.row(row).amax());
    structure.each_stiffness(&state.displacement, &mut |row, _, value| {
        if let Some(row) = structure.unknown_of[row] {
            sizes[row] = sizes[row].max(value.abs());
        }
    });
    for (mut row, size) in matrix.row_iter_mut().zip(sizes.iter_mut()) {
        if *size <= 0.0 {
            *size = 1.0;
        }
        row /= *size;
    }
    (matrix, sizes)
}

/// Relative pivot that decides the rank of a mode's equations.
pub(crate) const RANK: f64 = 1e-11;
