//! Solutions with the factorisation of a nearby matrix, cheaper than a factorisation of the matrix itself.
//!
//! With `F` the factorised matrix and `A` the matrix of the system, `x ← x + F⁻¹ (b - A x)` converges like the powers
//! of `G = F⁻¹ A - I`. From an initial vector with components in every direction, the first contraction measures the
//! whole of `G`: where it is small, no eigenvalue changes sign between the two matrices, and their determinants have
//! the same sign.

use crate::algebra::sparse::bordered_factorisation::{SparseFactorisation, backward_error};
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::tolerances::{
    CONVERGED_BACKWARD_ERROR, EXTRAPOLATION_MARGIN, FIRST_CONTRACTION, STAGNATED_BACKWARD_ERROR,
};
use nalgebra::DVector;
use std::borrow::Cow;

/// Largest number of corrections of one solution.
const MOST_CORRECTIONS: usize = 8;
/// Number of right-hand sides solved for together: their vectors stay in cache from one round to the next.
const TOGETHER: usize = 32;

/// A matrix near a factorised matrix, with the last row of the factorised matrix.
pub struct Nearby<'a> {
    factorisation: &'a SparseFactorisation,
    matrix: Cow<'a, Bordered>,
}

impl<'a> Nearby<'a> {
    /// Replaces the last row of `matrix` by that of the factorised matrix; `None` where the patterns or the numbers of
    /// borders differ.
    pub fn new(factorisation: &'a SparseFactorisation, mut matrix: Bordered) -> Option<Self> {
        if matrix.is_outside || !factorisation.is_like(&matrix) {
            return None;
        }
        matrix.lower.last_mut()?.clone_from(factorisation.last_row()?);
        Some(Self { factorisation, matrix: Cow::Owned(matrix) })
    }

    /// The factorised matrix itself.
    pub fn itself(factorisation: &'a SparseFactorisation) -> Self {
        Self { factorisation, matrix: Cow::Borrowed(factorisation.matrix()) }
    }

    /// Returns the solutions for consecutive right-hand sides, with backward errors up to `accepted`; `None` where the
    /// matrix is not near enough.
    pub fn solve_all(&self, right_hand_sides: &[f64], accepted: f64) -> Option<Vec<f64>> {
        let mut solutions = Vec::with_capacity(right_hand_sides.len());
        for rights in right_hand_sides.chunks(TOGETHER * self.matrix.size().max(1)) {
            solutions.extend(self.solve_together(rights, accepted)?);
        }
        Some(solutions)
    }

    fn solve_together(&self, right_hand_sides: &[f64], accepted: f64) -> Option<Vec<f64>> {
        let (size, count) = (self.matrix.size(), right_hand_sides.len() / self.matrix.size());
        let mut solutions = right_hand_sides.to_vec();
        if !self.factorisation.solve_all_once(&mut solutions, count) {
            return None;
        }
        let firsts = self.sizes(&solutions);
        let (mut rest, mut sizes) = (vec![0.0; solutions.len()], vec![0.0; solutions.len()]);
        let mut before = f64::INFINITY;
        for round in 0..MOST_CORRECTIONS {
            // The magnitudes of the terms hardly change from one solution to the next.
            match round {
                0 => self.matrix.multiply_all::<true>(&solutions, &mut rest, &mut sizes),
                _ => self.matrix.multiply_all::<false>(&solutions, &mut rest, &mut sizes),
            }
            let mut error = 0.0_f64;
            for ((rest, right), sizes) in
                rest.chunks_exact_mut(size).zip(right_hand_sides.chunks_exact(size)).zip(sizes.chunks_exact(size))
            {
                rest.iter_mut().zip(right).for_each(|(rest, right)| *rest = right - *rest);
                error = error.max(backward_error(rest, right, sizes));
            }
            if error <= accepted {
                return Some(solutions);
            }
            if error > 0.5 * before || !self.factorisation.solve_all_once(&mut rest, count) {
                return None;
            }
            let changes = || self.sizes(&rest);
            if round == 0 && changes().iter().zip(&firsts).any(|(change, first)| *change > FIRST_CONTRACTION * first) {
                return None;
            }
            solutions.iter_mut().zip(&rest).for_each(|(value, correction)| *value += correction);
            if round > 0 && error * (error / before) <= EXTRAPOLATION_MARGIN * accepted {
                return Some(solutions);
            }
            before = error;
        }
        None
    }

    /// The largest magnitude of the unknowns of each vector, without the borders.
    fn sizes(&self, vectors: &[f64]) -> Vec<f64> {
        let unknowns = self.matrix.pattern.size();
        let of_vector = |vector: &[f64]| vector[..unknowns].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        vectors.chunks_exact(self.matrix.size()).map(of_vector).collect()
    }

    /// Returns the solution, as accurate as rounding allows; the determinants of the two matrices then have the same
    /// sign. `None` where the matrix is not near enough.
    pub fn solve(&self, right_hand_side: &DVector<f64>) -> Option<DVector<f64>> {
        let size = right_hand_side.len();
        let mut solution = DVector::from_fn(size, |row, _| {
            let part = 0.5 + (row * 5 % 13) as f64 / 26.0;
            if row * 7 % 11 < 5 { -part } else { part }
        });
        let (mut product, mut sizes) = (DVector::zeros(size), vec![0.0; size]);
        let (mut least, mut first) = (f64::INFINITY, 0.0);
        for round in 0..MOST_CORRECTIONS {
            self.matrix.multiply(solution.as_slice(), product.as_mut_slice(), &mut sizes);
            let mut correction = right_hand_side - &product;
            let error = backward_error(correction.as_slice(), right_hand_side.as_slice(), &sizes);
            if round > 1
                && (error <= CONVERGED_BACKWARD_ERROR || (error <= STAGNATED_BACKWARD_ERROR && error > 0.5 * least))
            {
                return Some(solution);
            }
            if !self.factorisation.solve_once(&mut correction) {
                return None;
            }
            // The border values follow from the unknowns and have a different magnitude.
            let change = correction.rows(0, self.matrix.pattern.size()).amax();
            match round {
                0 => first = change,
                1 if change > FIRST_CONTRACTION * first => return None,
                _ => {}
            }
            least = least.min(error);
            solution += correction;
        }
        None
    }
}
