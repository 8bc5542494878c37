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
//! suppressed. Where they cannot, this component of the residual remains and shows it.

use crate::algebra::dense::assembly::Sink;
use crate::algebra::{nearest_null_space, null_space_as_scaled};
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::scaled_rows::{RANK, scaled_rows};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::{DMatrix, DVector};

/// Size of the remainder of a unit motion, orthogonalised against the path's direction and the other motions, that
/// counts as none.
const NO_MOTION: f64 = 1e-8;

/// A suppressed motion.
pub(super) struct Still {
    /// The left null vector `ψ`.
    column: DVector<f64>,
    /// The motion `φ`, as a row.
    row: DVector<f64>,
}

impl ModeSystem<'_> {
    /// Suppresses the motions across the path's direction that the equations leave undetermined at a state; returns
    /// `false` where there are none.
    pub(crate) fn hold_still(&mut self, state: &State, direction: &Rate) -> bool {
        if self.has_tracks() || !self.loading.structure.allows_dense() {
            return false;
        }
        self.still = self.all_left_open(state, direction).unwrap_or_default();
        !self.still.is_empty()
    }

    /// Whether the equations leave as many motions undetermined at another state as are suppressed.
    pub(crate) fn is_still_open(&self, state: &State) -> bool {
        let plain = ModeSystem::new(self.loading, self.modes, self.anchor);
        let (matrix, _) = scaled_rows(&plain, self.loading, state);
        null_space_as_scaled(matrix, RANK).is_some_and(|basis| basis.ncols() == self.still.len() + 1)
    }

    fn all_left_open(&self, state: &State, direction: &Rate) -> Option<Vec<Still>> {
        let (matrix, sizes) = scaled_rows(self, self.loading, state);
        let right = null_space_as_scaled(matrix.clone(), RANK)?;
        let count = right.ncols().checked_sub(1).filter(|count| *count > 0)?;
        let left = nearest_null_space(matrix.transpose(), count)?;
        let across = self.across(state, direction, &right)?;
        let still = |(rate, left): (&Rate, nalgebra::DVectorView<'_, f64>)| {
            let mut row = DMatrix::zeros(1, self.size);
            self.border_row(0, &mut row, |freedom| rate.displacement[freedom], rate.load);
            Still { column: left.component_mul(&sizes), row: row.row(0).transpose() }
        };
        Some(across.iter().zip(left.column_iter()).map(still).collect())
    }

    /// Orthonormal motions of a null space, orthogonal to the path's direction in it.
    fn across(&self, state: &State, direction: &Rate, basis: &DMatrix<f64>) -> Option<Vec<Rate>> {
        let unit = |values| self.rate_from(state, &values).normalised();
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
            if next.size() <= NO_MOTION {
                return None;
            }
            let next = next.normalised()?;
            known.push(next.clone());
            across.push(next);
        }
        Some(across)
    }

    /// Adds `Σ_j ψ_j φ_jᵀ` to the matrix.
    pub(super) fn add_still(&self, matrix: &mut DMatrix<f64>) {
        for Still { column, row } in &self.still {
            for (place, share) in row.iter().enumerate().filter(|(_, share)| **share != 0.0) {
                column.iter().enumerate().for_each(|(equation, value)| matrix.add(equation, place, value * share));
            }
        }
    }

    /// Whether any motion is suppressed.
    pub(super) fn holds_still(&self) -> bool {
        !self.still.is_empty()
    }
}
