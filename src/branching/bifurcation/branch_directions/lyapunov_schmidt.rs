//! The directions of the branches where several eigenvalues vanish together, by Lyapunov-Schmidt reduction of the
//! equations to the null vectors (M. Golubitsky, D. G. Schaeffer, *Singularities and Groups in Bifurcation Theory* 1,
//! Springer 1985, chapter VII).
//!
//! A branch is `x + α t + β φ + ½ w(β, β) + ...` with `F_x w = -F''(β φ, β φ)` across the null vectors. Where the
//! reduced equations have quadratic terms in the null vectors alone, `ψ_j F''(v, v) = 0` gives the direction
//! `v = α t + β φ`. Where they have none, `α` is of second order, and
//!
//! ```text
//! α ψ_j F''(t, β φ) + c_j(β) = 0,      c_j(β) = ½ ψ_j F''(β φ, w(β, β)) + ⅙ ψ_j F'''(β φ, β φ, β φ)
//! ```
//!
//! with cubics `c_j` fitted to their values. Newton's method solves both systems from starting directions all around.
//! All of it takes one factorisation of the matrix and one of its transpose.

use crate::branching::bifurcation::branch_directions::tolerances::{
    REDUCED_RESIDUAL, SINGULAR_VALUE_BOUND, THIRD_DERIVATIVE_STEP,
};
use crate::branching::bifurcation::branch_directions::{AROUND, Null};
use crate::branching::bifurcation::singularity::bordering::{Bordering, orthonormal};
use crate::branching::bifurcation::singularity::null_vectors::NullVectors;
use crate::mechanics::equations::{Kind, ModeSystem, matrix};
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::budget;
use nalgebra::{DMatrix, DVector};

/// Newton iterations.
const MOST_ITERATIONS: usize = 30;

/// The reduced equations for the shares of the path's own direction and of the other null vectors.
pub(super) struct LyapunovSchmidtEquations {
    /// `ψ_j F''(X_l, X_i)` for each `j`, the path's own direction first.
    quadratic: Vec<DMatrix<f64>>,
    /// Coefficients of each `c_j`, where the cubic terms count.
    cubic: Option<Vec<DVector<f64>>>,
}

impl LyapunovSchmidtEquations {
    /// Assembles the equations, with cubic terms where they are not `curved`.
    pub fn new(
        system: &ModeSystem<'_>,
        state: &State,
        nulls: &NullVectors,
        own: &Null,
        others: &[Null],
        curved: bool,
    ) -> Option<Self> {
        let bordering = bordering(system, state, nulls, own, others)?;
        let motions: Vec<&Null> = std::iter::once(own).chain(others).collect();
        let mut quadratic = vec![DMatrix::zeros(motions.len(), motions.len()); others.len()];
        for (l, along) in motions.iter().enumerate() {
            let derivative = bordering.second_derivative(&along.rate)?;
            for (i, motion) in motions.iter().enumerate() {
                let product = derivative.times(&motion.values);
                for (form, left) in quadratic.iter_mut().zip(&bordering.left) {
                    form[(l, i)] = left.dot(&product.rows(0, left.len()));
                }
            }
        }
        let cubic = if curved { None } else { Some(cubics(system, state, &bordering, others)?) };
        Some(Self { quadratic, cubic })
    }

    /// The root of the equations near some shares: shares of unit size along a branch.
    pub fn root(&self, mut shares: DVector<f64>) -> Option<DVector<f64>> {
        let unit = |shares: &mut DVector<f64>| {
            // Where `α` is of second order it does not count towards the size.
            let size = if self.cubic.is_some() { shares.rows(1, shares.len() - 1).norm() } else { shares.norm() };
            shares.unscale_mut(size);
            size > 0.0 && size.is_finite()
        };
        for _ in 0..MOST_ITERATIONS {
            if !unit(&mut shares) {
                return None;
            }
            let (values, slopes, size) = self.at(&shares);
            if values.amax() <= REDUCED_RESIDUAL * size {
                return Some(shares);
            }
            let scale = slopes.amax().max(f64::MIN_POSITIVE);
            shares -= (slopes / scale).svd(true, true).solve(&(values / scale), SINGULAR_VALUE_BOUND).ok()?;
        }
        None
    }

    /// Values, derivatives and the size of the terms.
    fn at(&self, shares: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>, f64) {
        let count = shares.len();
        let mut values = DVector::zeros(self.quadratic.len());
        let mut slopes = DMatrix::zeros(self.quadratic.len(), count);
        let mut size = 0.0_f64;
        let across = shares.rows(1, count - 1).into_owned();
        for (j, form) in self.quadratic.iter().enumerate() {
            match &self.cubic {
                None => {
                    let product = form * shares;
                    values[j] = shares.dot(&product);
                    slopes.set_row(j, &(product * 2.0).transpose());
                    size = size.max(form.amax());
                }
                Some(cubic) => {
                    let mixed = form.row(0).columns(1, count - 1).transpose();
                    values[j] = shares[0] * mixed.dot(&across);
                    slopes[(j, 0)] = mixed.dot(&across);
                    (1..count).for_each(|i| slopes[(j, i)] = shares[0] * mixed[i - 1]);
                    for ((places, monomial), coefficient) in monomials(&across).zip(cubic[j].iter()) {
                        values[j] += coefficient * monomial;
                        for place in 0..3 {
                            let others: f64 = (0..3).filter(|k| *k != place).map(|k| across[places[k]]).product();
                            slopes[(j, 1 + places[place])] += coefficient * others;
                        }
                    }
                    size = size.max(cubic[j].amax());
                }
            }
        }
        (values, slopes, size)
    }

    /// Starting shares all around each plane of two null vectors, with a part of the path's own direction where it
    /// counts.
    pub fn starts(&self) -> Vec<DVector<f64>> {
        let count = self.quadratic.len();
        let tilts: &[f64] = if self.cubic.is_none() { &[0.0, 0.5, -0.5] } else { &[0.0] };
        let mut starts = Vec::new();
        for first in 0..count {
            for second in first + 1..count {
                for tilt in tilts {
                    for number in 0..AROUND {
                        let angle = std::f64::consts::TAU * (number as f64 + 0.3) / AROUND as f64;
                        let mut shares = DVector::zeros(count + 1);
                        (shares[0], shares[1 + first], shares[1 + second]) = (*tilt, angle.cos(), angle.sin());
                        starts.push(shares);
                    }
                }
            }
        }
        starts
    }
}

/// The cubic monomials of some numbers.
fn monomials(across: &DVector<f64>) -> impl Iterator<Item = ([usize; 3], f64)> + '_ {
    let count = across.len();
    (0..count).flat_map(move |i| {
        (i..count).flat_map(move |j| (j..count).map(move |k| ([i, j, k], across[i] * across[j] * across[k])))
    })
}

fn bordering<'a>(
    system: &'a ModeSystem<'a>,
    state: &State,
    nulls: &NullVectors,
    own: &Null,
    others: &[Null],
) -> Option<Bordering<'a>> {
    let unknowns = system.loading.structure.unknowns();
    let rows = orthonormal(std::iter::once(own).chain(others).map(|null| null.rate.clone()))?;
    let columns: Option<Vec<DVector<f64>>> =
        nulls.left.iter().map(|left| left.rows(0, unknowns).into_owned().try_normalize(0.0)).collect();
    Bordering::new(system, state.clone(), &rows, &columns?)
}

/// The coefficients of each `c_j`, a least-squares fit to more values than coefficients.
fn cubics(
    system: &ModeSystem<'_>,
    state: &State,
    bordering: &Bordering<'_>,
    others: &[Null],
) -> Option<Vec<DVector<f64>>> {
    let count = others.len();
    let number = count * (count + 1) * (count + 2) / 6;
    let samples = 2 * number;
    let (mut matrix, mut values) = (DMatrix::zeros(samples, number), DMatrix::zeros(samples, count));
    for sample in 0..samples {
        budget::spend(system.size());
        // Evenly around the circle for two null vectors, well apart for more.
        let across = DVector::from_fn(count, |i, _| {
            (std::f64::consts::PI * (sample as f64 + 0.5) * (1 + i / 2) as f64 / samples as f64
                - if i % 2 == 1 { std::f64::consts::FRAC_PI_2 } else { 0.0 })
            .cos()
        })
        .normalize();
        monomials(&across).enumerate().for_each(|(place, (_, value))| matrix[(sample, place)] = value);
        let mut motion = DVector::zeros(system.size());
        others.iter().zip(across.iter()).for_each(|(null, share)| motion.axpy(*share, &null.values, 1.0));
        let rate = bordering.rate(&motion);
        let second = bordering.second_derivative(&rate)?;
        let bent = -bordering.solve(&second.times(&motion))?;
        let mixed = second.times(&bent);
        let third = third_derivative(system, state, &rate, &motion)?;
        for (j, left) in bordering.left.iter().enumerate() {
            let of = |vector: &DVector<f64>| left.dot(&vector.rows(0, left.len()));
            values[(sample, j)] = 0.5 * of(&mixed) + of(&third) / 6.0;
        }
    }
    let fitted = matrix.svd(true, true).solve(&values, SINGULAR_VALUE_BOUND).ok()?;
    Some(fitted.column_iter().map(|column| column.into_owned()).collect())
}

/// `F'''(v, v, v)`
fn third_derivative(
    system: &ModeSystem<'_>,
    state: &State,
    along: &Rate,
    motion: &DVector<f64>,
) -> Option<DVector<f64>> {
    let step = THIRD_DERIVATIVE_STEP / along.size();
    let at = |step: f64| {
        let state = state.advanced(along, step);
        Some(matrix::assemble_sparse(system, &system.iterate(state), Kind::Rates)?.times(motion))
    };
    Some((at(step)? - at(0.0)? * 2.0 + at(-step)?) / (step * step))
}
