//! What a mathematical program with complementarity constraints has to tell about itself.

use nalgebra::{DMatrix, DVector};

/// `min f(x)` s.t. `h(x) = 0`, `g(x) >= 0`, `lower <= x <= upper`, `0 <= a(x) ⊥ b(x) >= 0`.
///
/// All functions are evaluated at `x` of length [`Problem::variables`]; outputs are overwritten. Jacobians have one
/// row a function and one column a variable and arrive zeroed.
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

    fn objective(&self, x: &DVector<f64>) -> f64;
    fn objective_gradient(&self, x: &DVector<f64>, gradient: &mut DVector<f64>);

    fn equality_values(&self, _x: &DVector<f64>, _values: &mut DVector<f64>) {}
    fn equality_jacobian(&self, _x: &DVector<f64>, _jacobian: &mut DMatrix<f64>) {}
    fn inequality_values(&self, _x: &DVector<f64>, _values: &mut DVector<f64>) {}
    fn inequality_jacobian(&self, _x: &DVector<f64>, _jacobian: &mut DMatrix<f64>) {}

    /// Both members of every pair.
    fn pair_values(&self, x: &DVector<f64>, first: &mut DVector<f64>, second: &mut DVector<f64>);
    fn pair_jacobians(&self, x: &DVector<f64>, first: &mut DMatrix<f64>, second: &mut DMatrix<f64>);

    /// A positive semidefinite matrix for the quadratic programs' objective. Where `None` is returned, the solver
    /// builds one from differences of the Lagrangian's gradient (damped BFGS).
    fn quadratic_model(&self, _x: &DVector<f64>) -> Option<DMatrix<f64>> {
        None
    }
}
