//! The motions that the equations of a mode leave undetermined, and the deflation that suppresses them.
//!
//! A slider that sticks at a limit point of the structure attached to it leaves a motion `φ` of this structure
//! undetermined, with a left null vector `ψ`, whatever the rest of the structure does. Newton's method and the path's
//! direction are then computed with
//!
//! ```text
//! A' = A + Σ_j ψ_j φ_jᵀ,
//! ```
//!
//! which is regular when bordered by the path's direction. As `ψ_jᵀ A = 0`, the component of a correction along `φ_j`
//! equals the component of the residual along `ψ_j`: zero where the equations can be satisfied with the motion
//! suppressed. Where they cannot, this component of the residual does not vanish, which reveals the failure.

use crate::algebra::{nearest_null_space, null_space_as_scaled};
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::equations::tolerances::{RANK_TOLERANCE, REMAINING_MOTION};
use crate::mechanics::equations::{ModeSystem, SuppressedMotion, matrix, rate_recovery};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::DMatrix;

/// Suppresses the motions across the path's direction that the equations leave undetermined at a state; returns
/// `false` where there are none.
pub(crate) fn suppress_open_motions(system: &mut ModeSystem<'_>, state: &State, direction: &Rate) -> bool {
    if system.has_tracks() || !system.loading.structure.allows_dense() {
        return false;
    }
    system.suppressed = all_left_open(system, state, direction).unwrap_or_default();
    !system.suppressed.is_empty()
}

/// Whether the equations leave as many motions undetermined at another state as are suppressed.
pub(crate) fn is_still_open(system: &ModeSystem<'_>, state: &State) -> bool {
    let plain = ModeSystem::new(system.loading, system.modes, system.anchor);
    let (matrix, _) = scaled_rows(&plain, system.loading, state);
    null_space_as_scaled(matrix, RANK_TOLERANCE).is_some_and(|basis| basis.ncols() == system.suppressed.len() + 1)
}

fn all_left_open(system: &ModeSystem<'_>, state: &State, direction: &Rate) -> Option<Vec<SuppressedMotion>> {
    let (matrix, sizes) = scaled_rows(system, system.loading, state);
    let right = null_space_as_scaled(matrix.clone(), RANK_TOLERANCE)?;
    let count = right.ncols().checked_sub(1).filter(|count| *count > 0)?;
    let left = nearest_null_space(matrix.transpose(), count)?;
    let across = across(system, state, direction, &right)?;
    let still = |(rate, left): (&Rate, nalgebra::DVectorView<'_, f64>)| {
        let mut row = DMatrix::zeros(1, system.size);
        matrix::border_row(system, 0, &mut row, |freedom| rate.displacement[freedom], rate.load);
        SuppressedMotion { column: left.component_mul(&sizes), row: row.row(0).transpose() }
    };
    Some(across.iter().zip(left.column_iter()).map(still).collect())
}

/// Orthonormal motions of a null space, orthogonal to the path's direction in it.
fn across(system: &ModeSystem<'_>, state: &State, direction: &Rate, basis: &DMatrix<f64>) -> Option<Vec<Rate>> {
    let unit = |values| rate_recovery::rate_from(system, state, &values).normalised();
    let mut rest = basis.column_iter().map(|column| unit(column.into_owned())).collect::<Option<Vec<Rate>>>()?;
    let mut known = vec![direction.clone().normalised()?];
    let mut across = Vec::with_capacity(rest.len());
    while rest.len() > 1 {
        for rate in &mut rest {
            // Twice, to remove the round-off of the first pass.
            for other in known.iter().chain(&known) {
                rate.add(other, -rate.product(other));
            }
        }
        let largest = (0..rest.len()).max_by(|a, b| rest[*a].size().total_cmp(&rest[*b].size()))?;
        let next = rest.swap_remove(largest);
        if next.size() <= REMAINING_MOTION {
            return None;
        }
        let next = next.normalised()?;
        known.push(next.clone());
        across.push(next);
    }
    Some(across)
}
