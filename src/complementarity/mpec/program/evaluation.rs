//! A problem's functions and derivatives at one point, checked for numbers that are not finite, and measures of the
//! point's infeasibility.

use crate::resources::budget::{self, Taken};
use nalgebra::{DMatrix, DVector};

use crate::complementarity::mpec::program::cone;
use crate::complementarity::mpec::program::problem::Problem;
use crate::complementarity::mpec::program::sparse_rows::SparseRows;

/// The function of a [`Problem`] that returned a number that is not finite.
#[warn(missing_docs)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The point from which the solve was to start.
    Start,
    /// [`Problem::objective`].
    Objective,
    /// [`Problem::objective_gradient`].
    ObjectiveGradient,
    /// [`Problem::equality_values`].
    Equalities,
    /// [`Problem::equality_jacobian`].
    EqualityJacobian,
    /// [`Problem::inequality_values`].
    Inequalities,
    /// [`Problem::inequality_jacobian`].
    InequalityJacobian,
    /// [`Problem::pair_values`].
    Pairs,
    /// [`Problem::pair_jacobians`].
    PairJacobians,
    /// [`Problem::cone_values`].
    Cones,
    /// [`Problem::cone_jacobians`].
    ConeJacobians,
    /// [`Problem::quadratic_model`].
    QuadraticModel,
}

/// All values and derivatives of a [`Problem`] at one point.
#[derive(Debug, Clone)]
pub struct ProgramEvaluation {
    pub objective: f64,
    pub gradient: DVector<f64>,
    pub equality: DVector<f64>,
    pub equality_jacobian: SparseRows,
    pub inequality: DVector<f64>,
    pub inequality_jacobian: SparseRows,
    pub first: DVector<f64>,
    pub second: DVector<f64>,
    pub first_jacobian: SparseRows,
    pub second_jacobian: SparseRows,
    pub cones: ConeMembers,
}

/// Both members of every cone pair, stacked pair by pair.
#[derive(Debug, Clone)]
pub struct ConeMembers {
    /// Index of the first entry of each pair, and the end of the last pair.
    starts: Vec<usize>,
    pub first: DVector<f64>,
    pub second: DVector<f64>,
    pub first_jacobian: DMatrix<f64>,
    pub second_jacobian: DMatrix<f64>,
    _held: Taken,
}

impl ConeMembers {
    fn new(sizes: &[usize], variables: usize) -> Self {
        let mut starts = vec![0];
        let mut total = 0;
        for size in sizes {
            total += size;
            starts.push(total);
        }
        let held = budget::take::<f64>(2 * total * variables);
        Self {
            starts,
            first: DVector::zeros(total),
            second: DVector::zeros(total),
            first_jacobian: DMatrix::zeros(total, variables),
            second_jacobian: DMatrix::zeros(total, variables),
            _held: held,
        }
    }

    /// Number of cone pairs.
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Entries of a pair in the stacked members.
    pub fn range(&self, pair: usize) -> std::ops::Range<usize> {
        self.starts[pair]..self.starts[pair + 1]
    }

    pub fn first_of(&self, pair: usize) -> &[f64] {
        &self.first.as_slice()[self.range(pair)]
    }

    pub fn second_of(&self, pair: usize) -> &[f64] {
        &self.second.as_slice()[self.range(pair)]
    }

    /// Members of every pair.
    pub fn pairs(&self) -> impl Iterator<Item = (&[f64], &[f64])> {
        (0..self.count()).map(|pair| (self.first_of(pair), self.second_of(pair)))
    }
}

impl ProgramEvaluation {
    pub fn new<P: Problem + ?Sized>(problem: &P) -> Self {
        let n = problem.variables();
        let (equalities, inequalities, pairs) = (problem.equalities(), problem.inequalities(), problem.pairs());
        Self {
            objective: 0.0,
            gradient: DVector::zeros(n),
            equality: DVector::zeros(equalities),
            equality_jacobian: SparseRows::zeros(equalities, n),
            inequality: DVector::zeros(inequalities),
            inequality_jacobian: SparseRows::zeros(inequalities, n),
            first: DVector::zeros(pairs),
            second: DVector::zeros(pairs),
            first_jacobian: SparseRows::zeros(pairs, n),
            second_jacobian: SparseRows::zeros(pairs, n),
            cones: ConeMembers::new(&problem.cone_sizes(), n),
        }
    }

    /// Updates the function values at `x`.
    ///
    /// # Errors
    /// The quantity that is not finite.
    pub fn update_values<P: Problem + ?Sized>(&mut self, problem: &P, x: &DVector<f64>) -> Result<(), Quantity> {
        self.objective = problem.objective(x);
        problem.equality_values(x, &mut self.equality);
        problem.inequality_values(x, &mut self.inequality);
        problem.pair_values(x, &mut self.first, &mut self.second);
        finite(&[self.objective], Quantity::Objective)?;
        finite(self.equality.as_slice(), Quantity::Equalities)?;
        finite(self.inequality.as_slice(), Quantity::Inequalities)?;
        finite(self.first.as_slice(), Quantity::Pairs)?;
        finite(self.second.as_slice(), Quantity::Pairs)?;
        if self.cones.count() > 0 {
            problem.cone_values(x, &mut self.cones.first, &mut self.cones.second);
        }
        finite(self.cones.first.as_slice(), Quantity::Cones)?;
        finite(self.cones.second.as_slice(), Quantity::Cones)
    }

    /// Updates the derivatives at `x`.
    ///
    /// # Errors
    /// The quantity that is not finite.
    pub fn update_derivatives<P: Problem + ?Sized>(&mut self, problem: &P, x: &DVector<f64>) -> Result<(), Quantity> {
        for jacobian in [
            &mut self.equality_jacobian,
            &mut self.inequality_jacobian,
            &mut self.first_jacobian,
            &mut self.second_jacobian,
        ] {
            jacobian.clear();
        }
        self.cones.first_jacobian.fill(0.0);
        self.cones.second_jacobian.fill(0.0);
        self.gradient.fill(0.0);
        problem.objective_gradient(x, &mut self.gradient);
        problem.equality_jacobian(x, &mut self.equality_jacobian);
        problem.inequality_jacobian(x, &mut self.inequality_jacobian);
        problem.pair_jacobians(x, &mut self.first_jacobian, &mut self.second_jacobian);
        finite(self.gradient.as_slice(), Quantity::ObjectiveGradient)?;
        finite_rows(&self.equality_jacobian, Quantity::EqualityJacobian)?;
        finite_rows(&self.inequality_jacobian, Quantity::InequalityJacobian)?;
        finite_rows(&self.first_jacobian, Quantity::PairJacobians)?;
        finite_rows(&self.second_jacobian, Quantity::PairJacobians)?;
        if self.cones.count() > 0 {
            problem.cone_jacobians(x, &mut self.cones.first_jacobian, &mut self.cones.second_jacobian);
        }
        finite(self.cones.first_jacobian.as_slice(), Quantity::ConeJacobians)?;
        finite(self.cones.second_jacobian.as_slice(), Quantity::ConeJacobians)
    }

    /// Exchanges the function values with those of another point; the derivatives remain.
    pub fn swap_values(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.objective, &mut other.objective);
        std::mem::swap(&mut self.equality, &mut other.equality);
        std::mem::swap(&mut self.inequality, &mut other.inequality);
        std::mem::swap(&mut self.first, &mut other.first);
        std::mem::swap(&mut self.second, &mut other.second);
        std::mem::swap(&mut self.cones.first, &mut other.cones.first);
        std::mem::swap(&mut self.cones.second, &mut other.cones.second);
    }

    /// Largest violation of `h = 0`, `g >= 0`, `a >= 0`, `b >= 0` and of the cones.
    pub fn largest_violation(&self) -> f64 {
        let below_zero = |values: &DVector<f64>| values.iter().fold(0.0_f64, |worst, value| worst.max(-value));
        self.equality
            .amax_or_zero()
            .max(below_zero(&self.inequality))
            .max(below_zero(&self.first))
            .max(below_zero(&self.second))
            .max(self.cones.pairs().fold(0.0, |worst, (a, b)| worst.max(-cone::slack(a)).max(-cone::slack(b))))
    }

    /// Largest `|a_i b_i|`, or `|A_i·B_i|` for cone pairs.
    pub fn largest_product(&self) -> f64 {
        let scalar = self.first.iter().zip(self.second.iter()).fold(0.0_f64, |worst, (a, b)| worst.max((a * b).abs()));
        self.cones.pairs().fold(scalar, |worst, (a, b)| worst.max(cone::product(a, b).abs()))
    }
}

trait AbsoluteMaximum {
    fn amax_or_zero(&self) -> f64;
}

impl AbsoluteMaximum for DVector<f64> {
    fn amax_or_zero(&self) -> f64 {
        self.iter().fold(0.0, |worst, value| worst.max(value.abs()))
    }
}

fn finite(values: &[f64], quantity: Quantity) -> Result<(), Quantity> {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(quantity) }
}

fn finite_rows(rows: &SparseRows, quantity: Quantity) -> Result<(), Quantity> {
    if rows.is_finite() { Ok(()) } else { Err(quantity) }
}
