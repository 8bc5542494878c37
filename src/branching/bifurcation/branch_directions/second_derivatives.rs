//! Null vectors at a point, and second derivatives along them.

use crate::algebra::sparse::Bordered;
use crate::branching::bifurcation::branch_directions::tolerances::SECOND_DERIVATIVE_STEP;
use crate::branching::bifurcation::singularity::tolerances::EXTRAPOLATED_DIFFERENCE_STEP as FINE;
use crate::mechanics::equations::{Kind, ModeSystem, matrix};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::{DMatrix, DVector};

/// A null vector as values of the unknowns and as a rate.
#[derive(Clone)]
pub(super) struct Null {
    pub values: DVector<f64>,
    pub rate: Rate,
}

/// `F''(v, ·)`: all rows of the mode's equations except the last.
pub(super) enum Derivative {
    Dense(DMatrix<f64>),
    Sparse(Bordered, usize),
}

impl Derivative {
    /// Computes the derivative by central differences.
    pub fn new(system: &ModeSystem<'_>, state: &State, along: &Rate) -> Self {
        let rows = system.size() - 1;
        let sparse = |step: f64| {
            let at =
                |step: f64| matrix::assemble_sparse(system, &system.iterate(state.advanced(along, step)), Kind::Rates);
            Some(at(step)?.minus(&at(-step)?, 0.5 / step))
        };
        if let Some(coarse) = sparse(FINE)
            && let Some(fine) = sparse(0.5 * FINE)
        {
            // Richardson extrapolation, of fourth order.
            return Self::Sparse(fine.minus(&coarse.scaled(0.25), 4.0 / 3.0), rows);
        }
        let ahead = matrix::rate_matrix(system, &state.advanced(along, SECOND_DERIVATIVE_STEP));
        let behind = matrix::rate_matrix(system, &state.advanced(along, -SECOND_DERIVATIVE_STEP));
        Self::Dense((ahead - behind).rows(0, rows) / (2.0 * SECOND_DERIVATIVE_STEP))
    }

    pub fn times(&self, values: &DVector<f64>) -> DVector<f64> {
        match self {
            Self::Dense(matrix) => matrix * values,
            Self::Sparse(matrix, rows) => matrix.times(values).rows(0, *rows).into_owned(),
        }
    }

    pub fn amax(&self) -> f64 {
        match self {
            Self::Dense(matrix) => matrix.amax(),
            Self::Sparse(matrix, _) => matrix.largest(),
        }
    }
}
