//! Solutions with the factorisation of a nearby matrix: cheaper than one of the matrix itself.
//!
//! With `F` the matrix that was factorised and `A` the one asked for, `x ← x + F⁻¹ (b - A x)` converges as the powers of
//! `G = F⁻¹ A - I` fall. Where it begins at a vector with a part in every direction, its first contraction tells of all
//! of `G`: where that is small no eigenvalue changes sign between the two, and the determinants have one sign.

use crate::algebra::sparse::factorisation::{SparseFactorisation, backward_error};
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use nalgebra::DVector;

/// The first contraction may be this.
const NEAR: f64 = 1e-3;
/// Backward error at which a solution is as good as rounding allows.
const GOOD: f64 = 1e-15;
/// Backward error up to which a solution is accepted that gets no better.
const ACCEPTED: f64 = 1e-14;
/// Part of an accepted backward error up to which the next one, falling as the last did, need not be looked at.
const CERTAIN: f64 = 1e-3;
/// Corrections of one solution.
const MOST_CORRECTIONS: usize = 8;

/// A matrix whose last row is that of the factorised one.
pub struct Nearby<'a> {
    factorisation: &'a SparseFactorisation,
    matrix: Bordered,
}

impl<'a> Nearby<'a> {
    /// Another matrix with the last row of the factorised one in place of its own; `None` where it has other unknowns.
    pub fn new(factorisation: &'a SparseFactorisation, mut matrix: Bordered) -> Option<Self> {
        if matrix.is_outside || !factorisation.is_like(&matrix) {
            return None;
        }
        matrix.lower.last_mut()?.clone_from(factorisation.last_row()?);
        Some(Self { factorisation, matrix })
    }

    /// The solutions for right-hand sides one after the other, with backward errors up to this one; `None` where the matrix
    /// is not near enough.
    pub fn solve_all(&self, right_hand_sides: &[f64], accepted: f64) -> Option<Vec<f64>> {
        let (size, count) = (self.matrix.size(), right_hand_sides.len() / self.matrix.size());
        let mut solutions = right_hand_sides.to_vec();
        if !self.factorisation.solve_all_once(&mut solutions, count) {
            return None;
        }
        let firsts = self.sizes(&solutions);
        let (mut rest, mut sizes) = (vec![0.0; solutions.len()], vec![0.0; solutions.len()]);
        let mut before = f64::INFINITY;
        for round in 0..MOST_CORRECTIONS {
            // The sizes of the terms hardly change from one solution to the next.
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
            if round == 0 && changes().iter().zip(&firsts).any(|(change, first)| *change > NEAR * first) {
                return None;
            }
            solutions.iter_mut().zip(&rest).for_each(|(value, correction)| *value += correction);
            if round > 0 && error * (error / before) <= CERTAIN * accepted {
                return Some(solutions);
            }
            before = error;
        }
        None
    }

    /// The largest unknown of each of some vectors, borders apart.
    fn sizes(&self, vectors: &[f64]) -> Vec<f64> {
        let unknowns = self.matrix.pattern.size();
        let of_vector = |vector: &[f64]| vector[..unknowns].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        vectors.chunks_exact(self.matrix.size()).map(of_vector).collect()
    }

    /// The solution, as good as rounding allows; where there is one, both determinants have one sign.
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
            if round > 1 && (error <= GOOD || (error <= ACCEPTED && error > 0.5 * least)) {
                return Some(solution);
            }
            if !self.factorisation.solve_once(&mut correction) {
                return None;
            }
            // What is left of borders follows from the unknowns, and is of another size.
            let change = correction.rows(0, self.matrix.pattern.size()).amax();
            match round {
                0 => first = change,
                1 if change > NEAR * first => return None,
                _ => {}
            }
            least = least.min(error);
            solution += correction;
        }
        None
    }
}
