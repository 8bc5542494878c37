//! What a mathematical program with complementarity constraints has to tell about itself.

use crate::complementarity::mpec::program::sparse_rows::SparseRows;
use nalgebra::{DMatrix, DVector};

/// `min f(x)` s.t. `h(x) = 0`, `g(x) >= 0`, `lower <= x <= upper`, `0 <= a(x) ⊥ b(x) >= 0`, and cone pairs
/// `K ∋ A_i(x) ⊥ B_i(x) ∈ K`, `K` the second-order cone (`program::cone`).
///
/// All functions are evaluated at `x` of length [`Problem::variables`]; outputs are overwritten. Jacobians have one
/// row a function and one column a variable and arrive empty: what is not written is zero. Everything is dimensionless and best scaled to numbers
/// near one: tolerances are absolute. A value that is not finite ends the solve with a status that names its function,
/// except at a trial point, where it only shortens the step.
pub trait Problem {
    /// Number of variables.
    fn variables(&self) -> usize;
    /// Number of equalities `h`.
    fn equalities(&self) -> usize;
    /// Number of inequalities `g`.
    fn inequalities(&self) -> usize;
    /// Number of complementary pairs.
    fn pairs(&self) -> usize;
    /// Lower and upper bounds; infinite where there is none.
    fn bounds(&self) -> (DVector<f64>, DVector<f64>);

    /// `f`, the function that is minimised.
    fn objective(&self, x: &DVector<f64>) -> f64;
    /// `∇f`; arrives zeroed.
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
    /// Both members of every cone pair, one pair below the other.
    fn cone_values(&self, _x: &DVector<f64>, _first: &mut DVector<f64>, _second: &mut DVector<f64>) {}
    /// Their gradients, stacked likewise.
    fn cone_jacobians(&self, _x: &DVector<f64>, _first: &mut DMatrix<f64>, _second: &mut DMatrix<f64>) {}

    /// A positive semidefinite matrix for the quadratic programs' objective. Where `None` is returned, the solver
    /// builds one from differences of the Lagrangian's gradient (damped BFGS). The answer has to be of one kind at every
    /// `x`. A model that leaves out the constraints' curvature makes convergence linear instead of superlinear.
    fn quadratic_model(&self, _x: &DVector<f64>) -> Option<SparseRows> {
        None
    }
}
