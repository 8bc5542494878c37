//! A factorisation of the whole bordered system that reports when it is unreliable.
//!
//! Block elimination with a symmetric matrix that may be near singular loses digits. Here the small pivots of this
//! matrix are raised and the increments become borders, so that the digits are kept; iterative refinement on the whole
//! system removes the remaining error (after W. Govaerts, J. D. Pryce, IMA J. Numer. Anal. 13 (1993) 161,
//! doi:10.1093/imanum/13.2.161: mixed block elimination). A solution is accepted by its backward error (W. Oettli, W.
//! Prager, Numer. Math. 6 (1964) 405, doi:10.1007/BF01386090); where block elimination fails this test, a sparse LU
//! factorisation of the whole matrix takes over.

use crate::algebra::Inertia;
use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::dense::solve_counters::count_factorisation;
use crate::algebra::sparse::block_elimination::Blocks;
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::ldl::SymmetricFactor;
use crate::algebra::sparse::fallback_lu::WholeLu;
use crate::algebra::sparse::nodal_elimination::{Elimination, Friction, Holdings};
use crate::algebra::sparse::tolerances::{
    ACCEPTED_BACKWARD_ERROR, BORDER_VALUE_ERROR, CONVERGED_BACKWARD_ERROR, KNOWN_SOLUTION_ERROR, REGULAR_PIVOT_RATIO,
};
use nalgebra::{DMatrix, DVector};
use std::sync::{Arc, OnceLock};

/// The factorisation of a bordered system; see the module.
pub struct SparseFactorisation {
    matrix: Bordered,
    blocks: Option<Blocks>,
    /// Computed when first needed.
    whole: OnceLock<Option<WholeLu>>,
    sign: f64,
    pivot_ratio: f64,
}

/// Largest number of refinements of one solution.
const MOST_REFINEMENTS: usize = 6;

impl SparseFactorisation {
    /// Factorises; `None` when the matrix is singular to working precision or has an entry that is not finite.
    pub fn new(matrix: Bordered, holdings: &Holdings) -> Option<Self> {
        let friction = friction_of(&matrix, holdings);
        Self::with(matrix, holdings, friction)
    }

    pub(super) fn with(matrix: Bordered, holdings: &Holdings, friction: Friction) -> Option<Self> {
        if matrix.is_outside || !matrix.is_finite() {
            return None;
        }
        count_factorisation();
        // A complement of pure round-off carries no information.
        let blocks =
            Blocks::new(&matrix, holdings, friction).filter(|blocks| blocks.reduced.pivot_ratio() > f64::EPSILON);
        let (sign, pivot_ratio) =
            blocks.as_ref().map_or((1.0, 0.0), |blocks| (blocks.determinant_sign(), blocks.reduced.pivot_ratio()));
        let factorisation = Self { matrix, blocks, whole: OnceLock::new(), sign, pivot_ratio };
        (pivot_ratio > REGULAR_PIVOT_RATIO || factorisation.finds_what_is_known()).then_some(factorisation)
    }

    /// The factorisation of the matrix with another last row, which `put_last` assembles, equal to a new factorisation
    /// to the last bit: all data independent of this row are reused. `None` where a reliable result requires a new
    /// factorisation.
    pub fn with_last_row(mut self, put_last: impl FnOnce(&mut dyn Sink)) -> Option<Self> {
        let last = self.matrix.lower.len().checked_sub(1)?;
        self.matrix.lower[last].clear();
        put_last(&mut self.matrix);
        let row = &self.matrix.lower[last];
        if self.matrix.is_outside || !row.iter().all(|(_, value)| value.is_finite()) {
            return None;
        }
        let blocks = self.blocks.take()?.with_row(last, row)?;
        (self.sign, self.pivot_ratio) = (blocks.determinant_sign(), blocks.reduced.pivot_ratio());
        (self.blocks, self.whole) = (Some(blocks), OnceLock::new());
        (self.pivot_ratio > REGULAR_PIVOT_RATIO).then_some(self)
    }

    /// Whether known solutions are recovered: near a singular matrix they are not, however small the residual.
    fn finds_what_is_known(&self) -> bool {
        let first = |row: usize| 1.0 + (row % 7) as f64 / 8.0;
        let second = |row: usize| if row % 3 == 1 { -1.0 } else { 1.0 - (row % 11) as f64 / 16.0 };
        let scales = self.column_scales();
        let comes_out = |entry: &dyn Fn(usize) -> f64| {
            let known = DVector::from_fn(self.matrix.size(), |row, _| scales[row] * entry(row));
            let (mut values, mut sizes) = (DVector::zeros(known.len()), vec![0.0; known.len()]);
            self.matrix.multiply(known.as_slice(), values.as_mut_slice(), &mut sizes);
            self.solve(&mut values) && (values - known).component_div(&scales).amax() <= KNOWN_SOLUTION_ERROR
        };
        comes_out(&first) && comes_out(&second)
    }

    /// The magnitude of each unknown at which its terms are about as large as the others': 1 for motions; for what a
    /// border stands for, which causes forces of about 1 where stiffnesses may be 1e9, the ratio of the largest
    /// entries.
    fn column_scales(&self) -> DVector<f64> {
        let largest = |entries: &SparseEntries| entries.iter().fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
        let within = self.matrix.largest_within();
        let borders = self.matrix.right.iter().map(|entries| match largest(entries) {
            most if most > 0.0 && within > 0.0 => within / most,
            _ => 1.0,
        });
        let motions = std::iter::repeat_n(1.0, self.matrix.pattern.size());
        DVector::from_iterator(self.matrix.size(), motions.chain(borders))
    }

    /// Number of rows of the matrix.
    pub fn size(&self) -> usize {
        self.matrix.size()
    }

    /// Sign of the determinant: 1 or -1; certain only where [`Self::pivot_ratio`] is not 0.
    pub fn determinant_sign(&self) -> f64 {
        self.sign
    }

    /// Smallest pivot of the complement of the borders over the magnitude of its terms; 0 where no complement was
    /// formed.
    pub fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }

    /// The smaller of the pivot ratios of the interior and of the border complement: where it is small, stiffnesses of
    /// very different magnitude may have been added.
    pub fn spread(&self) -> f64 {
        self.blocks.as_ref().map_or(0.0, |blocks| blocks.reduced.pivot_ratio().min(blocks.reduced.factor.pivot_ratio()))
    }

    /// Solves for one right-hand side, overwritten by the solution; `false` when no accurate solution was found.
    pub fn solve(&self, right_hand_side: &mut DVector<f64>) -> bool {
        let blocks = self.blocks.as_ref();
        if let Some(solution) =
            blocks.and_then(|blocks| self.refined(right_hand_side, |values| blocks.solve(values, 1)))
        {
            right_hand_side.copy_from(&solution);
            return true;
        }
        let Some(whole) = self.whole.get_or_init(|| WholeLu::new(&self.matrix)) else { return false };
        match self.refined(right_hand_side, |values| whole.solve(values)) {
            Some(solution) => {
                right_hand_side.copy_from(&solution);
                true
            }
            None => false,
        }
    }

    /// Solves without refinement; `false` where block elimination gives no result.
    pub fn solve_once(&self, values: &mut DVector<f64>) -> bool {
        self.solve_all_once(values.as_mut_slice(), 1)
    }

    /// Solves without refinement for `count` consecutive right-hand sides.
    pub fn solve_all_once(&self, values: &mut [f64], count: usize) -> bool {
        self.blocks.as_ref().is_some_and(|blocks| blocks.solve(values, count))
    }

    /// The values at the borders, one row each, of the solutions for right-hand sides with the given entries in border
    /// rows, one column each, by products of half solutions. `None` where block elimination gives no result, or none
    /// that agrees with a refined solution.
    pub fn border_values(&self, rights: &[SparseEntries]) -> Option<DMatrix<f64>> {
        let (unknowns, borders) = (self.matrix.pattern.size(), self.matrix.lower.len());
        let values = self.blocks.as_ref()?.border_values(borders, rights)?;
        let weight = |column: usize| if column * 7 % 11 < 5 { -1.0 } else { 1.0 - (column % 13) as f64 / 26.0 };
        let mut solution = DVector::zeros(self.size());
        for (column, right) in rights.iter().enumerate() {
            right.iter().for_each(|(row, value)| solution[unknowns + row] += weight(column) * value);
        }
        if !self.solve(&mut solution) {
            return None;
        }
        let terms: Vec<f64> = values.row_iter().map(|row| row.lp_norm(1)).collect();
        let largest = terms.iter().copied().fold(0.0, f64::max);
        let agrees = |(row, terms): (usize, &f64)| {
            let sum: f64 = values.row(row).iter().enumerate().map(|(column, value)| weight(column) * value).sum();
            f64::abs(sum - solution[unknowns + row]) <= BORDER_VALUE_ERROR * terms.max(f64::EPSILON * largest)
        };
        terms.iter().enumerate().all(agrees).then_some(values)
    }

    /// The factorised matrix.
    pub(super) fn matrix(&self) -> &Bordered {
        &self.matrix
    }

    /// Whether another matrix has the same unknowns and as many borders.
    pub(super) fn is_like(&self, matrix: &Bordered) -> bool {
        Arc::ptr_eq(&self.matrix.pattern, &matrix.pattern) && self.matrix.lower.len() == matrix.lower.len()
    }

    pub(super) fn last_row(&self) -> Option<&SparseEntries> {
        self.matrix.lower.last()
    }

    fn refined(&self, right: &DVector<f64>, solve: impl Fn(&mut [f64]) -> bool) -> Option<DVector<f64>> {
        let mut solution = right.clone();
        if !solve(solution.as_mut_slice()) {
            return None;
        }
        let mut best: Option<(f64, DVector<f64>)> = None;
        let (mut product, mut sizes) = (DVector::zeros(right.len()), vec![0.0; right.len()]);
        for _ in 0..MOST_REFINEMENTS {
            self.matrix.multiply(solution.as_slice(), product.as_mut_slice(), &mut sizes);
            let mut rest = right - &product;
            let error = backward_error(rest.as_slice(), right.as_slice(), &sizes);
            let halved = best.as_ref().is_none_or(|(least, _)| error < 0.5 * least);
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                best = Some((error, solution.clone()));
            }
            if error <= CONVERGED_BACKWARD_ERROR || !halved || !solve(rest.as_mut_slice()) {
                break;
            }
            solution += rest;
        }
        best.filter(|(error, _)| *error <= ACCEPTED_BACKWARD_ERROR).map(|(_, solution)| solution)
    }
}

/// The largest residual relative to the magnitude of its terms.
pub(super) fn backward_error(rest: &[f64], right: &[f64], sizes: &[f64]) -> f64 {
    let largest = sizes.iter().fold(0.0_f64, |largest, size| largest.max(*size));
    let mut error = 0.0_f64;
    for ((rest, right), size) in rest.iter().zip(right).zip(sizes) {
        if !rest.is_finite() {
            return f64::INFINITY;
        }
        // A row with negligible terms is measured against the largest terms of the other rows.
        let terms = (size + right.abs()).max(f64::EPSILON * largest);
        if terms > 0.0 {
            error = error.max(rest.abs() / terms);
        }
    }
    error
}

/// Multiplications that an unsymmetric factorisation may take in any case.
const LITTLE: u64 = 1_000_000;
/// Cost of one multiplication of the unsymmetric factorisation, in multiplications of the symmetric factorisation and
/// its solves, which work by blocks.
const SLOWER: u64 = 4;

/// The cheaper treatment of friction: borders for the unsymmetric terms, with one solve each, or an unsymmetric
/// factorisation.
fn friction_of(matrix: &Bordered, holdings: &Holdings) -> Friction {
    let pattern = &matrix.pattern;
    let entries = pattern.factor_entries() as u64;
    let rubs = |(row, column): &(&usize, &usize)| {
        let row = &matrix.lower[**row];
        matrix.right[**column].iter().any(|(unknown, value)| !row.contains(&(*unknown, -value)))
    };
    let pairs = holdings.iter().flat_map(|holding| holding.rows.iter().zip(&holding.columns));
    let solves = pairs.filter(rubs).count() as u64;
    // The work is at least the squared number of entries over the number of unknowns: where this bound is too large
    // already, the work need not be counted.
    let least = entries.saturating_mul(entries) / (pattern.size() as u64).max(1);
    let most = LITTLE.max(entries.saturating_mul(2 * solves) / SLOWER);
    if least <= most && pattern.fill().work <= most { Friction::Eliminated } else { Friction::Bordered }
}

/// The inertia of `Zᵀ K Z`, with the columns of `Z` spanning the motions that the holdings allow. `None` where it
/// cannot be determined: `K` is not symmetric, or a holding could not be eliminated.
pub fn held_inertia(matrix: &Bordered, holdings: &Holdings, tolerance: f64) -> Option<Inertia> {
    if matrix.is_outside || !matrix.is_symmetric() {
        return None;
    }
    count_factorisation();
    let (elimination, values) = Elimination::new(matrix, holdings, Friction::Bordered);
    if elimination.nodes().len() != holdings.iter().len() {
        return None;
    }
    let held: usize = elimination.nodes().iter().map(|node| node.held().len()).sum();
    let mut inertia = SymmetricFactor::new(matrix.pattern.clone(), &values).ok()?.inertia(tolerance)?;
    inertia.positive = inertia.positive.checked_sub(held)?;
    Some(inertia)
}
