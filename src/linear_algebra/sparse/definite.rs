//! Sparse symmetric matrices that are positive definite, by their Cholesky factorisation.

use crate::linear_algebra::counted::count_solves;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{MatMut, Side};

/// Entries of the lower triangle, diagonal included; several at one place are added up.
pub type Triangle = Vec<(usize, usize, f64)>;

/// A factorisation of a matrix that is positive definite.
pub struct Definite {
    factor: Llt<usize, f64>,
    /// What rows and columns were multiplied by.
    scales: Vec<f64>,
}

impl Definite {
    /// Factorises the matrix with `shift` of each diagonal entry added (less than 0: with a margin, so that rounding cannot
    /// have made it definite); `None` where it is not positive definite then, or where a diagonal entry is not above
    /// `|shift|` times the sizes of what adds up to its row.
    pub fn new(size: usize, lower: &Triangle, shift: f64) -> Option<Self> {
        let (mut diagonal, mut sizes) = (vec![0.0; size], vec![0.0_f64; size]);
        for &(row, column, value) in lower {
            sizes[row] += value.abs();
            if row == column {
                diagonal[row] += value;
            } else {
                sizes[column] += value.abs();
            }
        }
        let is_clear =
            |(value, size): (&f64, &f64)| value.is_finite() && size.is_finite() && *value > shift.abs() * size;
        if !diagonal.iter().zip(&sizes).all(is_clear) {
            return None;
        }
        // A congruence: the diagonal becomes 1 and definiteness stays.
        let scales: Vec<f64> = diagonal.iter().map(|value| 1.0 / value.sqrt()).collect();
        let scaled =
            lower.iter().map(|&(row, column, value)| Triplet::new(row, column, value * scales[row] * scales[column]));
        let shifts = (0..size).map(|place| Triplet::new(place, place, shift));
        let triplets: Vec<Triplet<usize, usize, f64>> = scaled.chain(shifts).collect();
        let matrix = SparseColMat::try_new_from_triplets(size, size, &triplets).ok()?;
        let factor = matrix.sp_cholesky(Side::Lower).ok()?;
        Some(Self { factor, scales })
    }

    /// Solves for one right-hand side, overwritten by the solution.
    pub fn solve(&self, values: &mut [f64]) {
        count_solves(1);
        values.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value *= scale);
        let size = values.len();
        self.factor.solve_in_place(MatMut::from_column_major_slice_mut(values, size, 1));
        values.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value *= scale);
    }

    /// A vector in the direction that the matrix resists least, of largest entry 1 where rows and columns are scaled to a
    /// diagonal of 1.
    pub fn softest(&self) -> Vec<f64> {
        const ROUNDS: usize = 4;
        let mut vector: Vec<f64> = (0..self.scales.len()).map(|place| 1.0 + (place % 7) as f64 / 8.0).collect();
        for _ in 0..ROUNDS {
            let scaled = |(value, scale): (&f64, &f64)| (value / scale).abs();
            let largest = vector.iter().zip(&self.scales).map(scaled).fold(f64::MIN_POSITIVE, f64::max);
            // The right-hand side of the scaled matrix is the scaled vector.
            vector.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value /= largest * scale * scale);
            self.solve(&mut vector);
        }
        let scaled = |(value, scale): (&f64, &f64)| (value / scale).abs();
        let largest = vector.iter().zip(&self.scales).map(scaled).fold(f64::MIN_POSITIVE, f64::max);
        vector.iter_mut().for_each(|value| *value /= largest);
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::{Definite, Triangle};

    fn is_positive_definite(size: usize, lower: &Triangle, margin: f64) -> bool {
        Definite::new(size, lower, -margin).is_some()
    }

    /// A chain of springs 1, held at one end by a spring of its own.
    fn chain(size: usize, held: f64) -> Vec<(usize, usize, f64)> {
        let mut lower = vec![(0, 0, held)];
        for place in 1..size {
            lower.extend([(place - 1, place - 1, 1.0), (place, place, 1.0), (place, place - 1, -1.0)]);
        }
        lower
    }

    #[test]
    fn a_long_chain_is_definite_while_something_holds_it() {
        assert!(is_positive_definite(10_000, &chain(10_000, 1.0), 1e-12));
        assert!(!is_positive_definite(10_000, &chain(10_000, 0.0), 1e-12));
        assert!(!is_positive_definite(50, &chain(50, -1e-3), 1e-12));
        assert!(!is_positive_definite(2, &vec![(0, 0, 1.0), (1, 1, f64::NAN)], 1e-12));
        assert!(is_positive_definite(0, &Vec::new(), 1e-12));
    }

    #[test]
    fn a_chain_that_nothing_holds_moves_as_one() {
        let free = Definite::new(50, &chain(50, 0.0), 1e-12).expect("definite with the shift");
        let motion = free.softest();
        assert!(motion.iter().all(|value| (value / motion[0] - 1.0).abs() < 1e-9), "{motion:?}");
        let held = Definite::new(3, &chain(3, 2.0), 0.0).expect("definite");
        let mut values = vec![0.0, 0.0, 1.0];
        held.solve(&mut values);
        assert!(values.iter().zip([0.5, 1.5, 2.5]).all(|(value, exact)| (value - exact).abs() < 1e-14), "{values:?}");
    }
}
