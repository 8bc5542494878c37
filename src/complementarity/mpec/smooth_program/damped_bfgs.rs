//! A positive definite approximation of the Hessian of the Lagrangian, from differences of its gradient.
//!
//! With `s` the step and `y` the change of the gradient (multipliers fixed), `y` is first blended with `H s` until
//! `s·y >= 0.2 sᵀHs`; then `H ← H - H s sᵀH / sᵀHs + y yᵀ / s·y`.
//!
//! Source: M. J. D. Powell, *A fast algorithm for nonlinearly constrained optimization calculations*, Lecture Notes in
//! Mathematics 630 (1978), doi:10.1007/BFb0067703.

use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use crate::complementarity::mpec::smooth_program::tolerances::{LARGEST_CURVATURE, SMALLEST_CURVATURE};
use crate::resources::budget::{self, Taken};
use nalgebra::{DMatrix, DVector};

#[derive(Debug, Clone)]
pub struct Secant {
    matrix: DMatrix<f64>,
    _held: Taken,
    fresh: bool,
    idle: bool,
}

impl Secant {
    pub fn new(variables: usize) -> Self {
        let held = budget::take::<f64>(variables * variables);
        Self { matrix: DMatrix::identity(variables, variables), _held: held, fresh: true, idle: false }
    }

    /// Takes the matrix out of use: the problem has its own model of the Hessian.
    pub fn set_idle(&mut self) {
        self.idle = true;
    }

    pub fn is_idle(&self) -> bool {
        self.idle
    }

    /// Resets the matrix to the identity; false where it already is the identity or is not in use.
    pub fn reset(&mut self) -> bool {
        if self.fresh || self.idle {
            return false;
        }
        self.matrix.fill_with_identity();
        self.fresh = true;
        true
    }

    pub fn put_into(&self, hessian: &mut SparseRows) {
        if !self.idle {
            hessian.copy_from(&self.matrix);
        }
    }

    pub fn update(&mut self, step: &DVector<f64>, change: &DVector<f64>) {
        let length = step.norm_squared();
        if length == 0.0 {
            return;
        }
        let work = step.dot(change);
        if self.fresh && work > 0.0 {
            // The first difference sets the scale of the whole matrix.
            let scale = (change.norm_squared() / work).clamp(1e-4, 1e8);
            if scale.is_finite() {
                self.matrix *= scale;
            }
        }
        let image = &self.matrix * step;
        let curvature = step.dot(&image);
        if curvature <= SMALLEST_CURVATURE * length {
            return;
        }
        let share = if work >= 0.2 * curvature { 1.0 } else { 0.8 * curvature / (curvature - work) };
        let blended = change * share + &image * (1.0 - share);
        let blended_work = step.dot(&blended);
        if blended_work <= SMALLEST_CURVATURE * length || blended_work > LARGEST_CURVATURE * length {
            return;
        }
        let next =
            &self.matrix - &image * image.transpose() / curvature + &blended * blended.transpose() / blended_work;
        if next.iter().all(|value| value.is_finite()) {
            // Exactly symmetric, since the solver reads the upper triangle only.
            self.matrix = (&next + next.transpose()) * 0.5;
            self.fresh = false;
        }
    }
}
