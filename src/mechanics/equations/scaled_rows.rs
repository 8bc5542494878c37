//! The rows of the equations, scaled by the largest entry of any element, and the tolerance on their rank.

use crate::mechanics::equations::{ModeSystem, matrix};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;
use nalgebra::{DMatrix, DVector};

/// Returns the equations of the mode without the last, each row divided by the largest entry that any element has in
/// it, and the divisors of the rows. Where the stiffnesses of the elements cancel, at a singular point, the remainder
/// stays small in these rows.
pub fn scaled_rows(system: &ModeSystem<'_>, loading: Loading<'_>, state: &State) -> (DMatrix<f64>, DVector<f64>) {
    let structure = loading.structure;
    let rows = system.size() - 1;
    let mut matrix = matrix::rate_matrix(system, state).rows(0, rows).into_owned();
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
