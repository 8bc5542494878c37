//! Block elimination of what is left of the borders.

use super::Entries;
use super::symmetric::SymmetricFactor;
use super::unsymmetric::UnsymmetricFactor;
use nalgebra::{DMatrix, DVector, Dyn, LU};
use smallvec::smallvec;

/// Factors of `K` with some diagonal entries raised.
pub(super) enum Factor {
    Symmetric(SymmetricFactor),
    Unsymmetric(UnsymmetricFactor),
}

impl Factor {
    fn solve(&self, right_hand_sides: &mut [f64], count: usize) -> bool {
        match self {
            Self::Symmetric(factor) => factor.solve(right_hand_sides, count),
            Self::Unsymmetric(factor) => factor.solve(right_hand_sides, count),
        }
    }

    fn raised(&self) -> &[(usize, f64)] {
        match self {
            Self::Symmetric(factor) => factor.raised(),
            Self::Unsymmetric(factor) => factor.raised(),
        }
    }

    /// Smallest pivot over the largest one; those of the symmetric factors are between [`super::symmetric::SMALL`] and 1.
    pub fn pivot_ratio(&self) -> f64 {
        match self {
            Self::Symmetric(_) => 1.0,
            Self::Unsymmetric(factor) => factor.pivot_ratio(),
        }
    }

    /// Sign of the determinant of the raised matrix.
    fn determinant_sign(&self) -> f64 {
        match self {
            Self::Symmetric(factor) if factor.negative_pivots() % 2 == 1 => -1.0,
            Self::Symmetric(_) => 1.0,
            Self::Unsymmetric(factor) => factor.determinant_sign(),
        }
    }
}

/// `[[K, B], [C, D]]` with `K` factorised, and the raises of its pivots as borders more.
pub(super) struct Reduced {
    pub factor: Factor,
    size: usize,
    columns: Vec<Entries>,
    rows: Vec<Entries>,
    /// Each row of the complement was divided by the size of its terms.
    scales: Vec<f64>,
    complement: LU<f64, Dyn, Dyn>,
    /// `K⁻¹ B`, where it is small enough to be kept.
    responses: Option<Vec<f64>>,
    given: usize,
    pub sign: f64,
    /// Smallest pivot of the complement, its terms being about 1.
    pub pivot_ratio: f64,
}

/// Right-hand sides that are solved for together.
const TOGETHER: usize = 16;
/// Numbers of `K⁻¹ B` that are kept.
const KEPT: usize = 4_000_000;

impl Reduced {
    /// `None` where memory does not suffice or a number is not finite.
    pub fn new(
        factor: Factor,
        size: usize,
        mut columns: Vec<Entries>,
        mut rows: Vec<Entries>,
        corner: DMatrix<f64>,
    ) -> Option<Self> {
        let given = columns.len();
        let count = given + factor.raised().len();
        let mut complement = corner.resize(count, count, 0.0);
        for (index, (unknown, raise)) in factor.raised().iter().enumerate() {
            columns.push(smallvec![(*unknown, -raise)]);
            rows.push(smallvec![(*unknown, 1.0)]);
            complement[(given + index, given + index)] = -1.0;
        }
        let mut sizes = complement.abs();
        let mut responses = (size * count <= KEPT).then(|| Vec::with_capacity(size * count));
        for first in (0..count).step_by(TOGETHER) {
            let chunk = &columns[first..count.min(first + TOGETHER)];
            let mut block = vec![0.0; size * chunk.len()];
            for (index, entries) in chunk.iter().enumerate() {
                entries.iter().for_each(|(row, value)| block[index * size + row] += value);
            }
            if !factor.solve(&mut block, chunk.len()) {
                return None;
            }
            for (index, response) in block.chunks_exact(size.max(1)).enumerate() {
                for (row, entries) in rows.iter().enumerate() {
                    for (unknown, value) in entries {
                        complement[(row, first + index)] -= value * response[*unknown];
                        sizes[(row, first + index)] += (value * response[*unknown]).abs();
                    }
                }
            }
            if let Some(responses) = &mut responses {
                responses.extend_from_slice(&block);
            }
        }
        let scales: Vec<f64> = sizes.row_iter().map(|row| row.amax()).collect();
        if !scales.iter().all(|scale| scale.is_finite() && *scale > 0.0) {
            return None;
        }
        for (mut row, scale) in complement.row_iter_mut().zip(&scales) {
            row /= *scale;
        }
        let complement = complement.lu();
        let pivots = complement.lu_internal().diagonal();
        let raises_sign = if factor.raised().len() % 2 == 1 { -1.0 } else { 1.0 };
        let exchanges: f64 = complement.p().determinant();
        let sign = pivots
            .iter()
            .fold(raises_sign * factor.determinant_sign() * exchanges, |sign, pivot| sign * pivot.signum());
        let pivot_ratio = pivots.iter().fold(1.0, |least: f64, pivot| least.min(pivot.abs()));
        if !pivot_ratio.is_finite() {
            return None;
        }
        Some(Self { factor, size, columns, rows, scales, complement, responses, given, sign, pivot_ratio })
    }

    /// Solves, overwriting both parts of the right-hand side.
    pub fn solve(&self, upper: &mut [f64], lower: &mut [f64]) -> bool {
        let count = self.columns.len();
        let right = self.responses.is_none().then(|| upper.to_vec());
        if !self.factor.solve(upper, 1) {
            return false;
        }
        let mut weights = DVector::zeros(count);
        weights.rows_mut(0, self.given).copy_from_slice(lower);
        for (row, entries) in self.rows.iter().enumerate() {
            weights[row] -= entries.iter().map(|(unknown, value)| value * upper[*unknown]).sum::<f64>();
            weights[row] /= self.scales[row];
        }
        // Without borders there is nothing to solve for.
        if count > 0 && !self.complement.solve_mut(&mut weights) {
            return false;
        }
        match (&self.responses, right) {
            (Some(responses), _) => {
                for (response, weight) in responses.chunks_exact(self.size.max(1)).zip(weights.iter()) {
                    upper.iter_mut().zip(response).for_each(|(value, response)| *value -= weight * response);
                }
            }
            (None, Some(right)) => {
                upper.copy_from_slice(&right);
                for (entries, weight) in self.columns.iter().zip(weights.iter()) {
                    entries.iter().for_each(|(row, value)| upper[*row] -= weight * value);
                }
                if !self.factor.solve(upper, 1) {
                    return false;
                }
            }
            (None, None) => return false,
        }
        lower.copy_from_slice(&weights.as_slice()[..self.given]);
        true
    }
}
