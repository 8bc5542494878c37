//! Solutions with the factorisation of a nearby matrix: cheaper than one of the matrix itself.
//!
//! With `F` the matrix that was factorised and `A` the one asked for, `x ← x + F⁻¹ (b - A x)` converges as the powers of
//! `G = F⁻¹ A - I` fall. It begins at a vector with a part in every direction, so that its first contraction tells of all
//! of `G`: where that is small no eigenvalue changes sign between the two, and the determinants have one sign.

use super::bordered::Bordered;
use super::factorisation::{SparseFactorisation, backward_error};
use nalgebra::DVector;

/// The first contraction may be this.
const NEAR: f64 = 1e-3;
/// Backward error at which a solution is as good as rounding allows.
const GOOD: f64 = 1e-15;
/// Backward error up to which a solution is accepted that gets no better.
const ACCEPTED: f64 = 1e-14;
/// Corrections of one solution.
const MOST_CORRECTIONS: usize = 8;

impl SparseFactorisation {
    /// The solution with another matrix whose last row is that of this one, as good as rounding allows; `None` where the
    /// matrix is not near enough.
    pub fn solve_nearby(&self, mut matrix: Bordered, right_hand_side: &DVector<f64>) -> Option<DVector<f64>> {
        let size = right_hand_side.len();
        if matrix.is_outside || !self.is_like(&matrix) {
            return None;
        }
        matrix.lower.last_mut()?.clone_from(self.last_row()?);
        let mut solution = DVector::from_fn(size, |row, _| {
            let part = 0.5 + (row * 5 % 13) as f64 / 26.0;
            if row * 7 % 11 < 5 { -part } else { part }
        });
        let (mut product, mut sizes) = (DVector::zeros(size), vec![0.0; size]);
        let (mut least, mut first) = (f64::INFINITY, 0.0);
        for round in 0..MOST_CORRECTIONS {
            matrix.multiply(solution.as_slice(), product.as_mut_slice(), &mut sizes);
            let mut correction = right_hand_side - &product;
            let error = backward_error(correction.as_slice(), right_hand_side.as_slice(), &sizes);
            if round > 1 && (error <= GOOD || (error <= ACCEPTED && error > 0.5 * least)) {
                return Some(solution);
            }
            if !self.solve_once(&mut correction) {
                return None;
            }
            // What is left of borders follows from the unknowns, and is of another size.
            let change = correction.rows(0, matrix.pattern.size()).amax();
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
