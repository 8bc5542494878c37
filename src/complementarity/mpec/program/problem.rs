//! The interface of a mathematical program with complementarity constraints.

#![warn(missing_docs)]

use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use nalgebra::{DMatrix, DVector};

/// `min f(x)` s.t. `h(x) = 0`, `g(x) >= 0`, `lower <= x <= upper`, `0 <= a(x) ⊥ b(x) >= 0`, and cone pairs
/// `K ∋ A_i(x) ⊥ B_i(x) ∈ K`, `K` the second-order cone (`program::cone`).
///
/// All functions are evaluated at `x` of length [`Problem::variables`]; outputs are overwritten. Jacobians have one row
/// per function and one column per variable and are passed empty: entries that are not written are zero. All quantities
/// are dimensionless and best scaled to magnitudes near one, since tolerances are absolute. A value that is not finite
/// ends the solve with a status that names its function, except at a trial point, where it only shortens the step.
pub trait Problem {
    /// Number of variables.
    fn variables(&self) -> usize;
    /// Number of equalities `h`.
    fn equalities(&self) -> usize;
    /// Number of inequalities `g`.
    fn inequalities(&self) -> usize;
    /// Number of complementary pairs.
    fn pairs(&self) -> usize;
    /// Lower and upper bounds; infinite where there is no bound.
    fn bounds(&self) -> (DVector<f64>, DVector<f64>);

    /// `f`, the objective function.
    fn objective(&self, x: &DVector<f64>) -> f64;
    /// `∇f`; passed as zeros.
    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>);

    /// `h`.
    fn equality_values(&self, _x: &DVector<f64>, _values: &mut DVector<f64>) {}
    /// `∇h`.
    fn equality_jacobian(&self, _x: &DVector<f64>, _jacobian: &mut SparseRows) {}
    /// `g`.
    fn inequality_values(&self, _x: &DVector<f64>, _values: &mut DVector<f64>) {}
    /// `∇g`.
    fn inequality_jacobian(&self, _x: &DVector<f64>, _jacobian: &mut SparseRows) {}

    /// Both members of every pair.
    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>);
    /// Gradients of both members of every pair.
    fn pair_jacobians(&self, x: &DVector<f64>, first: &mut SparseRows, second: &mut SparseRows);

    /// Sizes of the cone pairs' members, each 2 or more: 3 for a contact with friction in space.
    fn cone_sizes(&self) -> Vec<usize> {
        Vec::new()
    }
    /// Both members of every cone pair, stacked pair by pair.
    fn cone_values(&self, _x: &DVector<f64>, _first: &mut DVector<f64>, _second: &mut DVector<f64>) {}
    /// Gradients of both members of every cone pair, stacked likewise.
    fn cone_jacobians(&self, _x: &DVector<f64>, _first: &mut DMatrix<f64>, _second: &mut DMatrix<f64>) {}

    /// A positive semidefinite matrix for the quadratic programs' objective. With `None`, the solver approximates such
    /// a matrix by differences of the Lagrangian's gradient (damped BFGS). A problem has to return `Some` for every
    /// `x`, or `None` for every `x`. A model without the constraints' curvature makes convergence linear instead of
    /// superlinear.
    fn quadratic_model(&self, _x: &DVector<f64>) -> Option<SparseRows> {
        None
    }
}
