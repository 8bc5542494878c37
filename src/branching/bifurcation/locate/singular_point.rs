//! A singular point of the equations of a mode, by Newton's method on equations that are regular there:
//!
//! ```text
//! F(x) + Ψ μ = 0,      G(x) = 0
//! ```
//!
//! (`bordering`). It is the point where `k` motions become free together. `G = 0` comprises `k (k + 1)` equations for
//! `k + 1` unknowns: where `k > 1` eigenvalues vanish together all of them hold; where the eigenvalues are merely close
//! to each other they do not. The path's own direction at the point is the root of `ψ_j F''(v, v) = 0` that continues
//! it.
//!
//! Where branches cross `μ` is zero. Where they pass each other it is the force that would make them cross: the
//! unfolding parameter of G. Moore, *The numerical treatment of non-trivial bifurcation points*, Numer. Funct. Anal.
//! Optim. 2 (1980) 441.

use crate::branching::bifurcation::locate::tolerances::{
    BORDERED_CORRECTION, REAL_EIGENVALUE_TOLERANCE, STALLED_CORRECTION, START_DISTANCE, TEST_FUNCTION_TOLERANCE,
};
use crate::branching::bifurcation::singularity::bordering::{Bordering, orthonormal};
use crate::mechanics::equations::{ModeSystem, rate_recovery, residual};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::{Complex, DMatrix, DVector};

/// Newton iterations.
const MOST_ITERATIONS: usize = 12;

/// A singular point.
pub(crate) struct LocatedSingularity<'a> {
    pub bordering: Bordering<'a>,
    pub state: State,
    /// `ψ_j F''(X_l, X_i)` for each `l`, with rows `j` and columns `i`.
    pub curvatures: Vec<DMatrix<f64>>,
    /// Remaining values of the test functions, for `k > 1` motions that do not become free together.
    pub rest: DMatrix<f64>,
    /// `μ`, relative to the largest stiffness: a dimensionless displacement.
    pub unfolding: DVector<f64>,
    /// Iterations, each with a factorisation.
    pub iterations: u64,
}

impl<'a> LocatedSingularity<'a> {
    /// The point near a state on a path with this direction, at which motions near to those given become free.
    /// Corrections are at most `reach` long (dimensionless), and only states that `may_be` are passed.
    pub fn near(
        system: &'a ModeSystem<'a>,
        mut state: State,
        (along, motions): (&Rate, Vec<Rate>),
        (reach, may_be): (f64, &dyn Fn(&State) -> bool),
    ) -> Option<Self> {
        let structure = system.loading.structure;
        let mut rows = orthonormal(std::iter::once(along.clone()).chain(motions))?;
        let forces = |rate: &Rate| {
            DVector::from_iterator(
                structure.unknowns(),
                structure.freedom_of.iter().map(|freedom| rate.displacement[*freedom]),
            )
        };
        let mut columns: Vec<DVector<f64>> =
            rows[1..].iter().filter_map(|rate| forces(rate).try_normalize(0.0)).collect();
        if columns.len() + 1 != rows.len() {
            return None;
        }
        let mut values = DVector::zeros(system.size());
        let mut force = vec![0.0; structure.freedoms()];
        let mut least = f64::INFINITY;
        for iterations in 1..=MOST_ITERATIONS {
            let mut iterate = system.iterate(state);
            residual::make_consistent(system, &mut iterate);
            residual::write_residual(system, &iterate, &mut values, &mut force);
            let bordering = Bordering::of_any(system, iterate.state.clone(), &rows, &columns)?;
            let (across, unfolding) = bordering.solve_bordered(&values)?;
            let curvatures: Option<Vec<DMatrix<f64>>> =
                bordering.right.iter().map(|right| bordering.curvatures(&bordering.rate(right))).collect();
            let curvatures = curvatures?;
            let mut tests = bordering.tests.clone();
            // The change of the test functions by the correction across the null vectors; none for too short a
            // correction.
            if let Some(moved) = bordering.curvatures(&bordering.rate(&across)) {
                tests += moved;
            }
            let weights = weights(&tests, &curvatures)?;
            curvatures.iter().zip(weights.iter()).for_each(|(curvatures, weight)| tests -= curvatures * *weight);
            let mut correction = across;
            for (weight, right) in weights.iter().zip(&bordering.right) {
                correction.axpy(-weight, right, 1.0);
            }
            let size = rate_recovery::length_of(system, &correction);
            if !(size.is_finite() && size <= reach) {
                return None;
            }
            state = rate_recovery::corrected_by(system, iterate, &correction).state;
            if !may_be(&state) {
                return None;
            }
            let stalled = size > 0.5 * least;
            // A single test function is zero after each linearised correction; its value before the correction shows
            // convergence.
            let is_zero = || columns.len() > 1 || bordering.tests.amax() <= TEST_FUNCTION_TOLERANCE;
            if size <= BORDERED_CORRECTION || (stalled && size <= STALLED_CORRECTION && is_zero()) {
                let iterations = iterations as u64;
                return Some(Self { bordering, state, curvatures, rest: tests, unfolding, iterations });
            }
            if stalled && least.is_finite() && size > 4.0 * least {
                return None;
            }
            least = least.min(size);
            (rows, columns) = bordering.borders()?;
        }
        None
    }

    /// `ψ_j F''(v, v)` and half its gradient, with `v` the combination of the null vectors with these weights.
    fn forms(&self, weights: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let corank = self.bordering.left.len();
        let mut gradient = DMatrix::zeros(corank, corank + 1);
        for (curvatures, weight) in self.curvatures.iter().zip(weights.iter()) {
            gradient += curvatures * *weight;
        }
        (&gradient * weights, gradient)
    }

    /// The direction among the null vectors that continues a direction close to the path's; `None` where the cosine of the
    /// angle between them is less than this.
    pub fn continued(&self, along: &Rate, least_cosine: f64) -> Option<Rate> {
        let rates: Vec<Rate> = self.bordering.right.iter().map(|right| self.bordering.rate(right)).collect();
        let count = rates.len();
        let gram = DMatrix::from_fn(count, count, |i, j| rates[i].product(&rates[j]));
        let first = gram.lu().solve(&DVector::from_fn(count, |i, _| rates[i].product(along)))?;
        let mut weights = first.clone();
        for _ in 0..MOST_ITERATIONS {
            let (values, gradient) = self.forms(&weights);
            let mut matrix = (gradient * 2.0).insert_row(count - 1, 0.0);
            matrix.set_row(count - 1, &first.transpose());
            let right = values.insert_row(count - 1, first.dot(&weights) - first.norm_squared());
            let correction = matrix.svd(true, true).solve(&right, f64::EPSILON).ok()?;
            weights -= &correction;
            if correction.amax() <= f64::EPSILON {
                break;
            }
        }
        let mut rate = rates[0].clone();
        rate.scale(weights[0]);
        rates[1..].iter().zip(weights.iter().skip(1)).for_each(|(other, weight)| rate.add(other, *weight));
        let rate = rate.normalised()?;
        (rate.product(along) >= least_cosine).then_some(rate)
    }

    /// The first along the path of crossings that are close to each other, but distinct, with its motion.
    pub fn first_apart(&self, start: &State) -> Option<(State, Rate, Rate)> {
        let corank = self.bordering.left.len();
        let along = self.bordering.rate(&self.bordering.right[0]);
        // The first null vector is along the path; G of the other null vectors changes by -ψ F''(t, X).
        let tests = self.rest.columns(1, corank).into_owned();
        let slopes = -self.curvatures[0].columns(1, corank).into_owned();
        let by_place = -(slopes.lu().solve(&tests)?);
        let values = by_place.complex_eigenvalues();
        let is_real = |value: &&Complex<f64>| {
            value.im.abs() <= REAL_EIGENVALUE_TOLERANCE * value.re.abs().max(TEST_FUNCTION_TOLERANCE)
        };
        let is_ahead = |place: &f64| {
            let chord = start.chord(&self.state.advanced(&along, *place));
            chord.product(&along) > START_DISTANCE
        };
        let places = values.iter().filter(is_real).map(|value| value.re).filter(is_ahead);
        let place = places.min_by(f64::total_cmp)?;
        let vectors = (&tests + slopes_times(&self.curvatures[0], corank, place)).svd(false, true).v_t?;
        let weights = vectors.row(corank - 1);
        let mut motion = along.clone();
        motion.scale(0.0);
        for (weight, right) in weights.iter().zip(&self.bordering.right[1..]) {
            motion.add(&self.bordering.rate(right), *weight);
        }
        let state = self.state.advanced(&along, place);
        Some((state, along.normalised()?, motion.normalised()?))
    }
}

/// The change of the test functions of the other null vectors over a distance along the path.
fn slopes_times(curvatures: &DMatrix<f64>, corank: usize, place: f64) -> DMatrix<f64> {
    curvatures.columns(1, corank) * -place
}

/// Weights of the null vectors that bring the test functions to zero, in the least-squares sense:
/// `G_ji = ψ_j F''(X_l, X_i) w_l`.
fn weights(tests: &DMatrix<f64>, curvatures: &[DMatrix<f64>]) -> Option<DVector<f64>> {
    let count = tests.len();
    let matrix = DMatrix::from_fn(count, curvatures.len(), |row, l| curvatures[l][row]);
    let right = DVector::from_column_slice(tests.as_slice());
    let scale = matrix.amax();
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    (matrix / scale).svd(true, true).solve(&(right / scale), TEST_FUNCTION_TOLERANCE).ok()
}
