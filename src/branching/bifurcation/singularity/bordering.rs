//! The equations of a mode at a singular point, bordered so that they are regular.
//!
//! Let `F_x` have `k` left null vectors and `k + 1` right ones, the path's direction among them. Borders `Ψ` and `B`
//! not orthogonal to these make
//!
//! ```text
//! [[F_x, Ψ], [Bᵀ, 0]] [[X], [G]] = [[0], [I]],      [[F_x, Ψ], [Bᵀ, 0]]ᵀ [[ψ], [·]] = [[0], [I]]
//! ```
//!
//! regular, and `G` (`k` by `k + 1`) vanishes exactly where the null vectors exist; `X` and `ψ` then are the null
//! vectors. Along a motion `v` the derivative of `G` is `-ψᵀ F''(v, X)` (A. Griewank, G. W. Reddien, IMA J. Numer.
//! Anal. 4 (1984) 493, doi:10.1093/imanum/4.4.493; W. Govaerts, *Numerical Methods for Bifurcations of Dynamical
//! Equilibria*, SIAM 2000, chapter 3). Two sparse factorisations suffice: one of the matrix, one of its transpose.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::{Bordered, SparseFactorisation};
use crate::branching::bifurcation::singularity::null_vectors::NullVectors;
use crate::branching::bifurcation::singularity::tolerances::{
    EXTRAPOLATED_DIFFERENCE_STEP, SYMMETRY_RESIDUAL, SYMMETRY_TEST_FACTOR,
};
use crate::mechanics::equations::{Kind, ModeSystem, matrix, mode_factorisation, rate_recovery};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// The bordered equations at a state; see the module.
pub(crate) struct Bordering<'a> {
    system: &'a ModeSystem<'a>,
    pub state: State,
    factors: Factors,
    /// `X`, one vector for each border row, over the unknowns of the mode.
    pub right: Vec<DVector<f64>>,
    /// `ψ`, one vector for each border column, over the equations of the mode without the last.
    pub left: Vec<DVector<f64>>,
    /// `G`, relative to the largest stiffness.
    pub tests: DMatrix<f64>,
}

/// The factorised bordered matrix.
enum Factors {
    Sparse(Box<SparseFactorisation>),
    Dense(LU<f64, Dyn, Dyn>),
}

impl Factors {
    fn solve(&self, values: &mut DVector<f64>) -> bool {
        match self {
            Self::Sparse(factors) => factors.solve(values),
            Self::Dense(factors) => factors.solve_mut(values),
        }
    }
}

/// `F''(v, ·)`, valid but for the last row.
pub(crate) enum SecondDerivative {
    Sparse(Bordered),
    Dense(DMatrix<f64>),
}

impl SecondDerivative {
    /// The product with a vector over the unknowns of the mode.
    pub fn times(&self, values: &DVector<f64>) -> DVector<f64> {
        match self {
            Self::Sparse(matrix) => matrix.times(values),
            Self::Dense(matrix) => matrix * values,
        }
    }
}

impl<'a> Bordering<'a> {
    /// As [`new`](Self::new), with sparse matrices or dense ones.
    pub fn of_any(system: &'a ModeSystem<'a>, state: State, rows: &[Rate], columns: &[DVector<f64>]) -> Option<Self> {
        if system.loading.structure.layout().is_some() {
            return Self::new(system, state, rows, columns);
        }
        let (size, corank) = (system.size(), columns.len());
        let matrix = matrix::rate_matrix(system, &state);
        let stiffness = matrix.amax();
        let mut matrix = matrix.resize(size + corank, size + corank, 0.0);
        for (index, rate) in rows.iter().enumerate() {
            matrix::border_row(system, size - 1 + index, &mut matrix, |freedom| rate.displacement[freedom], rate.load);
        }
        for (index, column) in columns.iter().enumerate() {
            column.iter().enumerate().for_each(|(row, value)| matrix[(row, size + index)] += stiffness * value);
        }
        let transposed = matrix.transpose().lu();
        let solve = |place: usize| {
            let mut values = unit(size + corank, place);
            transposed.solve_mut(&mut values).then(|| values.rows(0, size - 1).into_owned())
        };
        let left = (0..corank).map(|index| solve(size + index)).collect::<Option<_>>()?;
        let factors = Factors::Dense(matrix.lu());
        let (right, tests) = null_vectors(&factors, size, corank)?;
        Some(Self { system, state, factors, right, left, tests })
    }

    /// Borders the equations by a row along each of `rows`, one more than there are columns; `columns` are forces over
    /// the unknown displacements. `None` with dense matrices, and where the bordered system is singular.
    pub fn new(system: &'a ModeSystem<'a>, state: State, rows: &[Rate], columns: &[DVector<f64>]) -> Option<Self> {
        let (size, corank) = (system.size(), columns.len());
        let mut matrix = matrix::assemble_sparse(system, &system.iterate(state.clone()), Kind::Rates)?.widened(corank);
        let stiffness = matrix.largest_within();
        for (index, rate) in rows.iter().enumerate() {
            matrix::border_row(system, size - 1 + index, &mut matrix, |freedom| rate.displacement[freedom], rate.load);
        }
        for (index, column) in columns.iter().enumerate() {
            column.iter().enumerate().for_each(|(row, value)| matrix.add(row, size + index, stiffness * value));
        }
        let transposed = matrix.transposed();
        let factors = SparseFactorisation::new(matrix, mode_factorisation::holdings(system))?;
        let factors = Factors::Sparse(Box::new(factors));
        let (right, tests) = null_vectors(&factors, size, corank)?;
        let forces: Vec<DVector<f64>> = columns.iter().map(|column| column * stiffness).collect();
        let left = by_symmetry(system, &right, &forces, &transposed, SYMMETRY_TEST_FACTOR * tests.amax());
        let left = match left {
            Some(left) => left,
            None => {
                let transposed =
                    SparseFactorisation::new(transposed, &mode_factorisation::holdings(system).transposed())?;
                let solved = (0..corank).map(|index| {
                    let mut values = unit(size + corank, size + index);
                    transposed.solve(&mut values).then(|| values.rows(0, size - 1).into_owned())
                });
                solved.collect::<Option<_>>()?
            }
        };
        Some(Self { system, state, factors, right, left, tests })
    }

    /// Borders `ψ_j` and `X_i` to replace the chosen ones, normalised and mutually orthogonal.
    pub fn borders(&self) -> Option<(Vec<Rate>, Vec<DVector<f64>>)> {
        let unknowns = self.left.first()?.len().min(self.system.loading.structure.unknowns());
        let mut columns: Vec<DVector<f64>> = Vec::with_capacity(self.left.len());
        for left in &self.left {
            let mut column = left.rows(0, unknowns).into_owned();
            for other in &columns {
                column.axpy(-column.dot(other), other, 1.0);
            }
            columns.push(column.try_normalize(0.0)?);
        }
        Some((orthonormal(self.right.iter().map(|values| self.rate(values)))?, columns))
    }

    /// The null vectors of the equations: `X` and `ψ` themselves where all test functions are zero, and otherwise their
    /// combinations for which the test functions vanish.
    pub fn null_vectors(&self, tolerance: f64) -> Option<NullVectors> {
        let corank = self.left.len();
        if self.tests.amax() <= tolerance {
            return Some(NullVectors { right: self.right.clone(), left: self.left.clone() });
        }
        // Squared up by a zero row, so that the decomposition gives all right vectors.
        let square = self.tests.clone().insert_row(corank, 0.0);
        let parts = square.svd(true, true);
        let (u, v_t) = (parts.u?, parts.v_t?);
        let combined = |vectors: &[DVector<f64>], weights: &mut dyn Iterator<Item = f64>| {
            let mut sum = DVector::zeros(vectors.first()?.len());
            vectors.iter().zip(weights).for_each(|(vector, weight)| sum.axpy(weight, vector, 1.0));
            sum.try_normalize(0.0)
        };
        let zero: Vec<usize> = (0..=corank).filter(|index| parts.singular_values[*index] <= tolerance).collect();
        let right: Option<Vec<_>> =
            zero.iter().map(|index| combined(&self.right, &mut v_t.row(*index).iter().copied())).collect();
        // One of the left vectors belongs to the added row.
        let columns = DMatrix::from_columns(&zero.iter().map(|index| u.column(*index)).collect::<Vec<_>>());
        let own = columns.rows(0, corank).into_owned();
        let parts = own.svd(true, false);
        let u = parts.u?;
        let left: Option<Vec<_>> = (0..zero.len().saturating_sub(1))
            .map(|index| combined(&self.left, &mut u.column(index).iter().copied()))
            .collect();
        Some(NullVectors { right: right?, left: left? })
    }

    pub fn rate(&self, values: &DVector<f64>) -> Rate {
        rate_recovery::rate_from(self.system, &self.state, values)
    }

    /// Solves for a right-hand side over the equations of the mode; returns the unknowns of the solution, which is
    /// orthogonal to `B`.
    pub fn solve(&self, right_hand_side: &DVector<f64>) -> Option<DVector<f64>> {
        Some(self.solve_bordered(right_hand_side)?.0)
    }

    /// As [`solve`](Self::solve), with the weights of the border columns.
    pub fn solve_bordered(&self, right_hand_side: &DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
        let (size, corank) = (self.system.size(), self.left.len());
        let mut values = DVector::zeros(size + corank);
        values.rows_mut(0, size - 1).copy_from(&right_hand_side.rows(0, size - 1));
        let parts = |values: DVector<f64>| (values.rows(0, size).into_owned(), values.rows(size, corank).into_owned());
        self.factors.solve(&mut values).then(|| parts(values))
    }

    /// `F''(v, ·)`, valid but for the last row; `None` where the motion is zero.
    pub fn second_derivative(&self, along: &Rate) -> Option<SecondDerivative> {
        let size = along.size();
        if size <= 0.0 {
            return None;
        }
        let step = EXTRAPOLATED_DIFFERENCE_STEP / size;
        // (4 D(h/2) - D(h)) / 3, as 4/3 (D(h/2) - D(h)/4).
        if let Factors::Dense(_) = self.factors {
            let at = |step: f64| matrix::rate_matrix(self.system, &self.state.advanced(along, step));
            let difference = |step: f64| (at(step) - at(-step)) * (0.5 / step);
            return Some(SecondDerivative::Dense((difference(0.5 * step) - difference(step) * 0.25) * (4.0 / 3.0)));
        }
        let difference = |step: f64| {
            let at = |step: f64| {
                let state = self.state.advanced(along, step);
                matrix::assemble_sparse(self.system, &self.system.iterate(state), Kind::Rates)
            };
            Some(at(step)?.minus(&at(-step)?, 0.5 / step))
        };
        let derivative = difference(0.5 * step)?.minus(&difference(step)?.scaled(0.25), 4.0 / 3.0);
        Some(SecondDerivative::Sparse(derivative))
    }

    /// `ψ_j F''(v, X_i)` for all `j` (rows) and `i` (columns).
    pub fn curvatures(&self, along: &Rate) -> Option<DMatrix<f64>> {
        let derivative = self.second_derivative(along)?;
        let mut curvatures = DMatrix::zeros(self.left.len(), self.right.len());
        for (i, right) in self.right.iter().enumerate() {
            let product = derivative.times(right);
            for (j, left) in self.left.iter().enumerate() {
                curvatures[(j, i)] = left.dot(&product.rows(0, left.len()));
            }
        }
        Some(curvatures)
    }
}

/// A vector of this length with a one at a place.
fn unit(length: usize, place: usize) -> DVector<f64> {
    let mut values = DVector::zeros(length);
    values[place] = 1.0;
    values
}

/// `X` and `G`.
fn null_vectors(factors: &Factors, size: usize, corank: usize) -> Option<(Vec<DVector<f64>>, DMatrix<f64>)> {
    let mut tests = DMatrix::zeros(corank, corank + 1);
    let mut right = Vec::with_capacity(corank + 1);
    for index in 0..=corank {
        let mut values = unit(size + corank, size - 1 + index);
        if !factors.solve(&mut values) {
            return None;
        }
        tests.set_column(index, &values.rows(size, corank));
        right.push(values.rows(0, size).into_owned());
    }
    Some((right, tests))
}

/// The left vectors without a factorisation, where no contact slips against friction: then a motion without load, with
/// its reactions reversed in sign, is a left null vector. `None` where its residual exceeds `left_over` and round-off.
fn by_symmetry(
    system: &ModeSystem<'_>,
    right: &[DVector<f64>],
    forces: &[DVector<f64>],
    transposed: &Bordered,
    left_over: f64,
) -> Option<Vec<DVector<f64>>> {
    let (size, unknowns, corank) = (system.size(), system.loading.structure.unknowns(), forces.len());
    let (own, others) = right.split_first()?;
    let turned = |other: &DVector<f64>| {
        let motion = other - own * (other[unknowns] / own[unknowns]);
        // Rows of equilibrium, and for each reaction the row of its contact, one before its column.
        DVector::from_fn(size - 1, |row, _| if row < unknowns { motion[row] } else { -motion[row + 1] })
    };
    let turned: Vec<DVector<f64>> = others.iter().map(turned).collect();
    let products = DMatrix::from_fn(corank, corank, |j, l| turned[j].rows(0, unknowns).dot(&forces[l]));
    let weights = products.try_inverse()?;
    let (stiffness, mut left) = (transposed.largest_within(), Vec::with_capacity(corank));
    for j in 0..corank {
        let mut sum = DVector::zeros(size - 1);
        turned.iter().enumerate().for_each(|(l, turned)| sum.axpy(weights[(j, l)], turned, 1.0));
        let whole = sum.clone().resize_vertically(size + corank, 0.0);
        let rest = transposed.times(&whole).rows(0, size).amax();
        let most = (SYMMETRY_RESIDUAL + left_over) * stiffness * sum.rows(0, unknowns).amax();
        if rest > most || rest.is_nan() {
            return None;
        }
        left.push(sum);
    }
    Some(left)
}

/// Orthonormalises rates by the Gram-Schmidt process.
pub(crate) fn orthonormal(rates: impl Iterator<Item = Rate>) -> Option<Vec<Rate>> {
    let mut done: Vec<Rate> = Vec::new();
    for mut rate in rates {
        // Two passes suffice (W. Kahan, B. N. Parlett).
        for _ in 0..2 {
            for other in &done {
                rate.add(other, -rate.product(other));
            }
            rate = rate.normalised()?;
        }
        done.push(rate);
    }
    Some(done)
}
