//! Solves a bordered system by the Schur complement of its borders, with `K` factorised.
//!
//! By hand, since the library has no bordered systems; `block_elimination` has the times beside its sparse LU.

use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::ldl::SymmetricFactor;
use crate::algebra::sparse::factors::static_pivot_lu::UnsymmetricFactor;
use nalgebra::{DMatrix, Dyn, LU};
use pulp::{Arch, NullaryFnOnce};
use smallvec::smallvec;
use std::ops::Range;

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

    /// Ratio of the smallest to the largest pivot magnitude; 1 for symmetric factors, whose pivots are between
    /// [`crate::algebra::sparse::factors::tolerances::SMALLEST_PIVOT`] and 1.
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

/// The factorisation of `[[K, B], [C, D]]`: factors of `K`, whose pivot increments become additional borders, and the
/// complement.
pub(super) struct BorderSchurComplement {
    pub factor: Factor,
    size: usize,
    columns: Vec<SparseEntries>,
    rows: Vec<SparseEntries>,
    /// `D`, without the borders of the increments.
    corner: DMatrix<f64>,
    complement: Complement,
    /// `K⁻¹ B`, where small enough to be stored.
    responses: Option<Vec<f64>>,
    given: usize,
}

/// The factorised complement `D - C K⁻¹ B`, each row divided by the magnitude of its terms.
struct Complement {
    scales: Vec<f64>,
    factors: LU<f64, Dyn, Dyn>,
    sign: f64,
    /// The smallest pivot magnitude, with terms of about 1.
    pivot_ratio: f64,
}

/// The complement during assembly: the sums of its terms and of their magnitudes.
struct Terms {
    sums: DMatrix<f64>,
    sizes: DMatrix<f64>,
}

impl Terms {
    fn new(corner: &DMatrix<f64>, raises: usize) -> Self {
        let given = corner.nrows();
        let count = given + raises;
        let mut sums = corner.clone().resize(count, count, 0.0);
        (given..count).for_each(|raise| sums[(raise, raise)] = -1.0);
        Self { sizes: sums.abs(), sums }
    }

    /// Subtracts `C` times a column of `K⁻¹ B` from a column.
    fn take(&mut self, rows: &[SparseEntries], column: usize, response: &[f64]) {
        for (row, entries) in rows.iter().enumerate() {
            for (unknown, value) in entries {
                self.sums[(row, column)] -= value * response[*unknown];
                self.sizes[(row, column)] += (value * response[*unknown]).abs();
            }
        }
    }

    fn factorised(mut self) -> Option<Complement> {
        let scales: Vec<f64> = self.sizes.row_iter().map(|row| row.amax()).collect();
        if !scales.iter().all(|scale| scale.is_finite() && *scale > 0.0) {
            return None;
        }
        for (mut row, scale) in self.sums.row_iter_mut().zip(&scales) {
            row /= *scale;
        }
        let factors = self.sums.lu();
        let pivots = factors.lu_internal().diagonal();
        let exchanges: f64 = factors.p().determinant();
        let sign = pivots.iter().fold(exchanges, |sign, pivot| sign * pivot.signum());
        let pivot_ratio = pivots.iter().fold(1.0, |least: f64, pivot| least.min(pivot.abs()));
        pivot_ratio.is_finite().then_some(Complement { scales, factors, sign, pivot_ratio })
    }
}

/// Number of right-hand sides solved for together.
const TOGETHER: usize = 32;
/// Number of rows processed together: this many rows of a few columns stay in cache.
const ROWS_TOGETHER: usize = 512;
/// Number of columns of `K⁻¹ B` that are subtracted at once.
const AT_ONCE: usize = 4;
/// Largest number of entries of `K⁻¹ B` that are stored.
const KEPT: usize = 4_000_000;

impl BorderSchurComplement {
    /// Forms the complement and factorises it; `None` where memory runs out or a number is not finite.
    pub fn new(
        factor: Factor,
        size: usize,
        mut columns: Vec<SparseEntries>,
        mut rows: Vec<SparseEntries>,
        corner: DMatrix<f64>,
    ) -> Option<Self> {
        let given = columns.len();
        for (unknown, raise) in factor.raised() {
            columns.push(smallvec![(*unknown, -raise)]);
            rows.push(smallvec![(*unknown, 1.0)]);
        }
        let count = columns.len();
        let mut terms = Terms::new(&corner, factor.raised().len());
        let mut responses = (size * count <= KEPT).then(|| Vec::with_capacity(size * count));
        for (first, chunk) in columns.chunks(TOGETHER).enumerate() {
            let mut block = vec![0.0; size * chunk.len()];
            for (index, entries) in chunk.iter().enumerate() {
                entries.iter().for_each(|(row, value)| block[index * size + row] += value);
            }
            if !factor.solve(&mut block, chunk.len()) {
                return None;
            }
            for (index, response) in block.chunks_exact(size.max(1)).enumerate() {
                terms.take(&rows, first * TOGETHER + index, response);
            }
            if let Some(responses) = &mut responses {
                responses.extend_from_slice(&block);
            }
        }
        let complement = terms.factorised()?;
        Some(Self { factor, size, columns, rows, corner, complement, responses, given })
    }

    /// Replaces a row of `[C, D]`; `None` where `K⁻¹ B` is not stored.
    pub fn with_row(mut self, row: usize, entries: SparseEntries, corner: &[f64]) -> Option<Self> {
        *self.rows.get_mut(row)? = entries;
        corner.iter().enumerate().for_each(|(column, value)| self.corner[(row, column)] = *value);
        let mut terms = Terms::new(&self.corner, self.factor.raised().len());
        for (column, response) in self.responses.as_ref()?.chunks_exact(self.size.max(1)).enumerate() {
            terms.take(&self.rows, column, response);
        }
        self.complement = terms.factorised()?;
        Some(self)
    }

    /// Sign of the determinant.
    pub fn sign(&self) -> f64 {
        let raises = if self.factor.raised().len() % 2 == 1 { -1.0 } else { 1.0 };
        raises * self.factor.determinant_sign() * self.complement.sign
    }

    /// The smallest pivot magnitude of the complement of the borders, with terms of about 1.
    pub fn pivot_ratio(&self) -> f64 {
        self.complement.pivot_ratio
    }

    /// Solves for `count` consecutive right-hand sides, overwriting both parts of each.
    pub fn solve(&self, upper: &mut [f64], lower: &mut [f64], count: usize) -> bool {
        let mut right = self.responses.is_none().then(|| upper.to_vec());
        if !self.factor.solve(upper, count) {
            return false;
        }
        let borders = self.columns.len();
        let mut weights = DMatrix::zeros(borders, count);
        for (number, mut weights) in weights.column_iter_mut().enumerate() {
            let upper = &upper[number * self.size..][..self.size];
            let lower = &mut lower[number * self.given..][..self.given];
            weights.rows_mut(0, self.given).copy_from_slice(lower);
            for (row, entries) in self.rows.iter().enumerate() {
                weights[row] -= entries.iter().map(|(unknown, value)| value * upper[*unknown]).sum::<f64>();
                weights[row] /= self.complement.scales[row];
            }
            // Without borders there is nothing to solve for.
            if borders > 0 && !self.complement.factors.solve_mut(&mut weights) {
                return false;
            }
            lower.copy_from_slice(&weights.as_slice()[..self.given]);
        }
        match (&self.responses, &mut right) {
            (Some(responses), _) => self.take_responses(responses, &weights, upper),
            (None, Some(right)) => {
                for (right, weights) in right.chunks_exact_mut(self.size.max(1)).zip(weights.column_iter()) {
                    for (entries, weight) in self.columns.iter().zip(weights.iter()) {
                        entries.iter().for_each(|(row, value)| right[*row] -= weight * value);
                    }
                }
            }
            (None, None) => return false,
        }
        let Some(right) = right else { return true };
        upper.copy_from_slice(&right);
        self.factor.solve(upper, count)
    }

    /// Subtracts `K⁻¹ B` times the weights from each solution, a few rows at a time: each part of `K⁻¹ B`, once read,
    /// serves all solutions. The widest instructions of the machine compute the same bits as any others, as no operations
    /// are fused.
    fn take_responses(&self, responses: &[f64], weights: &DMatrix<f64>, upper: &mut [f64]) {
        Arch::new().dispatch(TakenResponses { size: self.size.max(1), responses, weights, upper });
    }
}

/// Solutions and the multiples of vectors of this size that are subtracted from them; one column of weights a solution.
struct TakenResponses<'a> {
    size: usize,
    responses: &'a [f64],
    weights: &'a DMatrix<f64>,
    upper: &'a mut [f64],
}

impl NullaryFnOnce for TakenResponses<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { size, responses, weights, upper } = self;
        let borders = weights.nrows();
        for first in (0..size).step_by(ROWS_TOGETHER) {
            let rows = first..size.min(first + ROWS_TOGETHER);
            for (number, solution) in upper.chunks_exact_mut(size).enumerate() {
                let weights = &weights.as_slice()[number * borders..][..borders];
                take_multiples(&mut solution[rows.clone()], (responses, size, rows.clone()), weights);
            }
        }
    }
}

/// Subtracts from some rows of a vector the same rows of vectors of this size, one after the other, times their weights.
/// Several at once, so that each row is read and written once for all of them.
#[inline(always)]
fn take_multiples(values: &mut [f64], (vectors, size, rows): (&[f64], usize, Range<usize>), weights: &[f64]) {
    let count = values.len();
    let part = |which: usize| &vectors[which * size..][rows.clone()][..count];
    for (group, weights) in weights.chunks(AT_ONCE).enumerate() {
        let first = group * AT_ONCE;
        if let [a, b, c, d] = *weights {
            let [p, q, r, s] = [part(first), part(first + 1), part(first + 2), part(first + 3)];
            for row in 0..count {
                values[row] = values[row] - a * p[row] - b * q[row] - c * r[row] - d * s[row];
            }
        } else {
            for (which, weight) in weights.iter().enumerate() {
                values.iter_mut().zip(part(first + which)).for_each(|(value, entry)| *value -= weight * entry);
            }
        }
    }
}
