//! Semismooth Newton method for the complementarity system itself, to round-off.
//!
//! ```text
//! h(x) = 0,     min(a_i, b_i) = 0,     A_j - P(A_j - B_j) = 0,     c(x) = 0
//! ```
//!
//! `P` projects on the second-order cone (`program::cone`); `c` is one closing equation from the caller where the
//! system has one unknown more than equations, as in an increment (its arc length). `A - P(A - B)` vanishes exactly for
//! complementary members of the cone; where the projection has no derivative, an element of its B-subdifferential is
//! used. The map is strongly semismooth, so local convergence is quadratic whichever member of a pair vanishes, even
//! where the direction of slip is not known beforehand. Global convergence is not guaranteed: steps are halved while
//! the residual does not fall, and the result states whether the method converged. Inequalities, bounds and the
//! objective are ignored.
//!
//! Sources: S. Hayashi, N. Yamashita and M. Fukushima, *A combined smoothing and regularization method for monotone
//! second-order cone complementarity problems*, SIAM J. Optim. 15 (2005), doi:10.1137/S1052623403421516 (the map and its
//! derivatives); L. Qi and J. Sun, *A nonsmooth version of Newton's method*, Math. Program. 58 (1993),
//! doi:10.1007/BF01581275 (convergence).

use crate::complementarity::mpec::tolerances::{ACCEPTED_RESIDUAL, ATTAINABLE_RESIDUAL, RANK_TOLERANCE};
use nalgebra::{DMatrix, DVector};

use crate::algebra::Factorisation;
use crate::complementarity::mpec::program::cone;
use crate::complementarity::mpec::program::evaluation::{ProgramEvaluation, Quantity};
use crate::complementarity::mpec::program::problem::Problem;
use crate::resources::cancel::CancelFlag;

/// Largest number of iterations.
const MOST_ITERATIONS: usize = 30;
/// Largest number of halvings of a step.
const HALVINGS: usize = 12;
/// Number of full steps taken although no fraction of them reduces the residual: where a pair changes its zero member,
/// the residual may have to grow on the way to the solution.
const WATCHDOG_STEPS: usize = 3;
/// Largest number of sweeps of the singular value decomposition.
const SWEEPS: usize = 1000;

/// An equation that closes the system: its value and gradient.
pub type Closing<'a> = &'a dyn Fn(&DVector<f64>) -> (f64, DVector<f64>);

/// The end point of the method.
#[derive(Debug, Clone)]
pub struct Polished {
    pub x: DVector<f64>,
    /// Largest residual at the start and after every step.
    pub residuals: Vec<f64>,
    pub is_converged: bool,
}

impl Polished {
    /// Linear systems solved.
    pub fn iterations(&self) -> usize {
        self.residuals.len().saturating_sub(1)
    }
}

/// Runs the method from `start`.
///
/// # Errors
/// The quantity that is not finite at the start.
pub fn polish<P: Problem + ?Sized>(
    problem: &P,
    start: &DVector<f64>,
    closing: Option<Closing<'_>>,
    cancel: &CancelFlag,
) -> Result<Polished, Quantity> {
    if start.len() != problem.variables() || start.iter().any(|value| !value.is_finite()) {
        return Err(Quantity::Start);
    }
    let mut at = ProgramEvaluation::new(problem);
    at.update_values(problem, start)?;
    let mut x = start.clone();
    let mut values = residual(&at, &x, closing);
    let mut residuals = vec![values.amax()];
    let mut best = (values.amax(), x.clone());
    let mut watchdog_steps = WATCHDOG_STEPS;
    for _ in 0..MOST_ITERATIONS {
        let size = values.amax();
        if cancel.is_cancelled() || size <= ATTAINABLE_RESIDUAL || at.update_derivatives(problem, &x).is_err() {
            break;
        }
        let Some(step) = newton_step(jacobian(&at, &x, closing), &values) else { break };
        let (next, next_values) = match shortened(problem, &mut at, &x, &step, &values, closing) {
            Some(better) => better,
            // Below the convergence tolerance, a step without progress is round-off.
            None if size <= ACCEPTED_RESIDUAL || watchdog_steps == 0 => break,
            None => {
                watchdog_steps -= 1;
                let trial = &x + step;
                if at.update_values(problem, &trial).is_err() {
                    break;
                }
                let trial_values = residual(&at, &trial, closing);
                if trial_values.iter().any(|value| !value.is_finite()) {
                    break;
                }
                (trial, trial_values)
            }
        };
        residuals.push(next_values.amax());
        x = next;
        values = next_values;
        if values.amax() < best.0 {
            best = (values.amax(), x.clone());
        }
    }
    Ok(Polished { x: best.1, is_converged: best.0 <= ACCEPTED_RESIDUAL, residuals })
}

/// The first point after `step`, `step/2`, ... with a smaller residual, and the residual; `at` then has the values at
/// this point. `None` where no point has a smaller residual.
fn shortened<P: Problem + ?Sized>(
    problem: &P,
    at: &mut ProgramEvaluation,
    x: &DVector<f64>,
    step: &DVector<f64>,
    values: &DVector<f64>,
    closing: Option<Closing<'_>>,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let mut length = 1.0;
    for _ in 0..=HALVINGS {
        let trial = x + step * length;
        if at.update_values(problem, &trial).is_ok() {
            let trial_values = residual(at, &trial, closing);
            let enough = (1.0 - 1e-4 * length) * values.norm();
            if trial_values.iter().all(|value| value.is_finite()) && trial_values.norm() <= enough {
                return Some((trial, trial_values));
            }
        }
        length *= 0.5;
    }
    None
}

fn residual(at: &ProgramEvaluation, x: &DVector<f64>, closing: Option<Closing<'_>>) -> DVector<f64> {
    let mut values: Vec<f64> = at.equality.iter().copied().collect();
    values.extend(at.first.iter().zip(at.second.iter()).map(|(a, b)| a.min(*b)));
    for (a, b) in at.cones.pairs() {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        values.extend(a.iter().zip(cone::projection(&difference).iter()).map(|(a, p)| a - p));
    }
    values.extend(closing.map(|closing| closing(x).0));
    DVector::from_vec(values)
}

fn jacobian(at: &ProgramEvaluation, x: &DVector<f64>, closing: Option<Closing<'_>>) -> DMatrix<f64> {
    let variables = x.len();
    let (equalities, pairs, in_cones) = (at.equality.len(), at.first.len(), at.cones.first.len());
    let rows = equalities + pairs + in_cones + usize::from(closing.is_some());
    let mut matrix = DMatrix::zeros(rows, variables);
    put_rows(&mut matrix, 0, at.equality_jacobian.entries());
    for pair in 0..pairs {
        let smaller =
            if at.first[pair] <= at.second[pair] { at.first_jacobian.row(pair) } else { at.second_jacobian.row(pair) };
        put_rows(&mut matrix, equalities + pair, smaller.iter().map(|&(column, value)| (0, column, value)));
    }
    for pair in 0..at.cones.count() {
        let range = at.cones.range(pair);
        let difference: Vec<f64> =
            at.cones.first_of(pair).iter().zip(at.cones.second_of(pair)).map(|(a, b)| a - b).collect();
        let derivative = cone::projection_derivative(&difference);
        let of_first = at.cones.first_jacobian.rows(range.start, range.len());
        let of_second = at.cones.second_jacobian.rows(range.start, range.len());
        let block = of_first - &derivative * (of_first - of_second);
        matrix.rows_mut(equalities + pairs + range.start, range.len()).copy_from(&block);
    }
    if let Some(closing) = closing {
        matrix.set_row(rows - 1, &closing(x).1.transpose());
    }
    matrix
}

fn put_rows(matrix: &mut DMatrix<f64>, first: usize, entries: impl Iterator<Item = (usize, usize, f64)>) {
    entries.for_each(|(row, column, value)| matrix[(first + row, column)] = value);
}

/// The step `-J⁻¹ F`, or the least-squares solution of minimum norm where `J` is singular: an open contact leaves the
/// bound on its slip undetermined.
fn newton_step(matrix: DMatrix<f64>, values: &DVector<f64>) -> Option<DVector<f64>> {
    let right = -values;
    if matrix.is_square()
        && let Some(factors) = Factorisation::new(matrix.clone())
    {
        let mut step = right.clone();
        if factors.solve(&mut step) && (&matrix * &step - &right).amax() <= 1e-8 * (1.0 + right.amax()) {
            return Some(step);
        }
    }
    if matrix.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let decomposition = matrix.try_svd(true, true, f64::EPSILON, SWEEPS)?;
    let cutoff = RANK_TOLERANCE * decomposition.singular_values.amax();
    let step = decomposition.solve(&right, cutoff).ok()?;
    step.iter().all(|value| value.is_finite()).then_some(step)
}
