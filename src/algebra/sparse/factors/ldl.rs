//! `K = L D Lᵀ` of a symmetric sparse matrix, without exchanges.
//!
//! Rows and columns are first scaled to entries of about 1 (by powers of two, so without rounding). A pivot lost to
//! cancellation, as at a limit point or where only a contact constrains a node, is raised by 1: the factorised matrix
//! is `K + Σ θ e eᵀ`, and the caller removes the increments by borders `[[K + θ e eᵀ, -θ e], [eᵀ, -1]]`. The factors
//! are therefore never near singular, however many eigenvalues of `K` are zero.

use crate::algebra::dense::inertia::{Inertia, inertia};
use crate::algebra::sparse::factors::pattern::Pattern;
use crate::algebra::sparse::factors::substitutions::{self, Substitutions};
use crate::algebra::sparse::factors::supernodal_ldl;
use crate::algebra::sparse::factors::tolerances::{PIVOT_SUBSTITUTE, SMALLEST_PIVOT};
use crate::resources::budget::{self, Taken};
use crate::resources::spare_memory::Reused;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{LdltError, LdltRegularization};
use faer::sparse::linalg::cholesky::{LdltRef, SymbolicCholeskyRaw};
use faer::{Conj, MatMut, Par, Side};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// The reason why a matrix was not factorised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LdlFailure {
    /// An entry of the matrix or of the factors is not finite.
    NotFinite,
    /// Too many pivots had to be raised.
    TooManySmallPivots,
    OutOfMemory,
}

/// A factorisation of `K` with some diagonal entries raised.
pub struct SymmetricFactor {
    pattern: Arc<Pattern>,
    values: Reused,
    /// Scale factors of rows and columns: powers of two.
    scales: Vec<f64>,
    /// Unknowns with raised diagonal entries, and the increments `θ` in the units of the matrix.
    raised: Vec<(usize, f64)>,
    _held: Taken,
}

/// Number of raised pivots beyond which the factorisation is given up.
const MOST_RAISED: usize = 256;

impl SymmetricFactor {
    /// Factorises; `values` in the sequence of the pattern. Only one triangle is read.
    pub fn new(pattern: Arc<Pattern>, values: &[f64]) -> Result<Self, LdlFailure> {
        let size = pattern.size();
        if !values.iter().all(|value| value.is_finite()) {
            return Err(LdlFailure::NotFinite);
        }
        let scales = scales(&pattern, values);
        let mut scaled = pattern.any_matrix_values();
        for column in 0..size {
            for place in pattern.column(column) {
                scaled[place] = values[place] * scales[pattern.rows[place]] * scales[column];
            }
        }
        let held = budget::take::<f64>(size);
        let mut factor = Self { values: pattern.any_factor_values(), pattern, scales, raised: Vec::new(), _held: held };
        factor.raise(factor.last(), &mut scaled);
        loop {
            factor.factorise(&scaled)?;
            let mut small = Vec::new();
            factor.each_pivot(&mut |unknown, pivot| {
                if pivot.abs() < SMALLEST_PIVOT || !pivot.is_finite() {
                    small.push((unknown, pivot));
                }
            });
            if small.iter().any(|(_, pivot)| !pivot.is_finite()) {
                return Err(LdlFailure::NotFinite);
            }
            if small.is_empty() {
                return Ok(factor);
            }
            if factor.raised.len() + small.len() > MOST_RAISED {
                return Err(LdlFailure::TooManySmallPivots);
            }
            small.into_iter().for_each(|(unknown, _)| factor.raise(Some(unknown), &mut scaled));
        }
    }

    /// The unknown eliminated last. Cancellation nearly always occurs at its pivot: raising this pivot from the start
    /// costs one more solve and saves a second factorisation.
    fn last(&self) -> Option<usize> {
        let last = self.pattern.size().checked_sub(1)?;
        Some(self.pattern.symbolic.cholesky.perm().map_or(last, |perm| perm.arrays().0[last]))
    }

    fn raise(&mut self, unknown: Option<usize>, scaled: &mut [f64]) {
        let Some(unknown) = unknown else { return };
        let scale = self.scales[unknown];
        self.raised.push((unknown, 1.0 / (scale * scale)));
        if let Some(place) = self.pattern.place(unknown, unknown) {
            scaled[place] += 1.0;
        }
    }

    fn factorise(&mut self, scaled: &[f64]) -> Result<(), LdlFailure> {
        let symbolic = &self.pattern.symbolic;
        if let Some((blocks, (order, place_of))) = symbolic.in_pieces() {
            let pattern = &self.pattern;
            let each_below = |place: usize, each: &mut dyn FnMut(usize, f64)| {
                for entry in pattern.column(order[place]) {
                    let row = place_of[pattern.rows[entry]];
                    if row >= place {
                        each(row, scaled[entry]);
                    }
                }
            };
            supernodal_ldl::factorise(blocks, &mut self.values, &each_below, PIVOT_SUBSTITUTE);
            return Ok(());
        }
        budget::spend(usize::try_from(symbolic.fill.multiplications).unwrap_or(usize::MAX));
        self.values.fill(0.0);
        let symbolic = &symbolic.cholesky;
        let request = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(request).map_err(|_| LdlFailure::OutOfMemory)?;
        let regularization = LdltRegularization {
            dynamic_regularization_signs: None,
            dynamic_regularization_delta: PIVOT_SUBSTITUTE,
            dynamic_regularization_epsilon: PIVOT_SUBSTITUTE,
        };
        let done = symbolic.factorize_numeric_ldlt(
            &mut self.values,
            self.pattern.view(scaled),
            Side::Lower,
            regularization,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        match done {
            Ok(_) => Ok(()),
            Err(LdltError::ZeroPivot { .. }) => Err(LdlFailure::NotFinite),
        }
    }

    /// Calls `each` with each unknown and its pivot in `D`, for the scaled matrix.
    fn each_pivot(&self, each: &mut dyn FnMut(usize, f64)) {
        let order = self.pattern.symbolic.cholesky.perm().map(|perm| perm.arrays().0);
        let unknown = |place: usize| order.map_or(place, |order| order[place]);
        match self.pattern.symbolic.cholesky.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                for (place, start) in symbolic.col_ptr().iter().take(self.pattern.size()).enumerate() {
                    each(unknown(place), self.values[*start]);
                }
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                for node in 0..symbolic.n_supernodes() {
                    let (begin, end) = (symbolic.supernode_begin()[node], symbolic.supernode_end()[node]);
                    let rows = end - begin + symbolic.supernode(node).pattern().len();
                    let first = symbolic.col_ptr_for_val()[node];
                    for column in 0..end - begin {
                        each(unknown(begin + column), self.values[first + column * rows + column]);
                    }
                }
            }
        }
    }

    /// The unknowns whose diagonal entries were raised, and the increments.
    pub fn raised(&self) -> &[(usize, f64)] {
        &self.raised
    }

    /// The factors for substitutions by themselves, of the raised and scaled matrix.
    pub(crate) fn substitutions(&self) -> Substitutions<'_> {
        Substitutions::new(&self.pattern.symbolic, &self.values)
    }

    /// The place of each unknown in the elimination order; `None` where both are the same.
    pub(crate) fn places(&self) -> Option<&[usize]> {
        self.pattern.symbolic.cholesky.perm().map(|perm| perm.arrays().1)
    }

    /// The scale factors of rows and columns.
    pub(crate) fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Number of negative pivots: the negative eigenvalues of the raised matrix (Sylvester's law).
    pub fn negative_pivots(&self) -> usize {
        let mut negative = 0;
        self.each_pivot(&mut |_, pivot| negative += usize::from(pivot < 0.0));
        negative
    }

    /// The inertia of `K` itself.
    ///
    /// The inertia of `[[K + EΘEᵀ, E], [Eᵀ, 1/Θ]]` is that of `K` plus one positive eigenvalue per increment, and also
    /// that of the raised matrix plus that of `1/Θ - Eᵀ (K + EΘEᵀ)⁻¹ E` (E. V. Haynsworth, Linear Algebra Appl. 1
    /// (1968) 73, doi:10.1016/0024-3795(68)90050-5). Eigenvalues of the latter matrix of relative magnitude up to
    /// `tolerance` count as zero.
    pub fn inertia(&self, tolerance: f64) -> Option<Inertia> {
        let (size, count) = (self.pattern.size(), self.raised.len());
        let negative = self.negative_pivots();
        let mut whole = Inertia { negative, zero: 0, positive: size - negative };
        if count > 0 {
            let own = inertia(self.complement()?, tolerance)?;
            whole.negative += own.negative;
            whole.zero += own.zero;
            whole.positive = (whole.positive + own.positive).checked_sub(count)?;
        }
        Some(whole)
    }

    /// `1 - √Θ Eᵀ (K + EΘEᵀ)⁻¹ E √Θ`
    fn complement(&self) -> Option<DMatrix<f64>> {
        let mut complement = DMatrix::identity(self.raised.len(), self.raised.len());
        for (column, (unknown, raise)) in self.raised.iter().enumerate() {
            let mut response = vec![0.0; self.pattern.size()];
            response[*unknown] = raise.sqrt();
            if !self.solve(&mut response, 1) {
                return None;
            }
            for (row, (other, raise)) in self.raised.iter().enumerate() {
                complement[(row, column)] -= response[*other] * raise.sqrt();
            }
        }
        Some(complement)
    }

    /// The unit null vectors of `K`: `(K + EΘEᵀ)⁻¹ E √Θ w` for every eigenvector `w` of the complement with an
    /// eigenvalue of magnitude up to `tolerance`.
    pub fn null_vectors(&self, tolerance: f64) -> Option<Vec<DVector<f64>>> {
        let complement = self.complement()?;
        let (size, count) = (self.pattern.size(), self.raised.len());
        let eigen = complement.symmetric_eigen();
        let mut vectors = Vec::new();
        for index in (0..count).filter(|index| eigen.eigenvalues[*index].abs() <= tolerance) {
            let mut vector = DVector::zeros(size);
            for ((unknown, raise), weight) in self.raised.iter().zip(eigen.eigenvectors.column(index).iter()) {
                vector[*unknown] += raise.sqrt() * weight;
            }
            if !self.solve(vector.as_mut_slice(), 1) {
                return None;
            }
            vectors.extend(vector.try_normalize(0.0));
        }
        Some(vectors)
    }

    /// Solves with the raised matrix for `count` consecutive right-hand sides, overwritten by the solutions; `false`
    /// when memory runs out or a result is not finite.
    pub fn solve(&self, right_hand_sides: &mut [f64], count: usize) -> bool {
        let size = self.pattern.size();
        if size == 0 || count == 0 {
            return true;
        }
        if count > 1 {
            substitutions::solve(&self.pattern.symbolic, &self.values, &self.scales, right_hand_sides);
            return right_hand_sides.iter().all(|value| value.is_finite());
        }
        let scale = |values: &mut [f64]| {
            for column in values.chunks_exact_mut(size) {
                column.iter_mut().zip(&self.scales).for_each(|(value, scale)| *value *= scale);
            }
        };
        scale(right_hand_sides);
        budget::spend(2 * self.values.len() * count);
        let symbolic = &self.pattern.symbolic.cholesky;
        let Ok(mut memory) = MemBuffer::try_new(symbolic.solve_in_place_scratch::<f64>(count, Par::Seq)) else {
            return false;
        };
        LdltRef::<'_, usize, f64>::new(symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right_hand_sides, size, count),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        scale(right_hand_sides);
        right_hand_sides.iter().all(|value| value.is_finite())
    }
}

/// Powers of two near `1/√(largest entry of the row)`; a row of zeros is scaled like the row with the largest entry.
pub(crate) fn scales(pattern: &Pattern, values: &[f64]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; pattern.size()];
    for (row, value) in pattern.rows.iter().zip(values) {
        largest[*row] = largest[*row].max(value.abs());
    }
    let most = largest.iter().fold(0.0_f64, |most, value| most.max(*value));
    let usual = if most > 0.0 { most } else { 1.0 };
    // The binary exponent, from the bits of the number.
    let exponent = |value: f64| ((value.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    let power = |value: &f64| {
        let value = if *value > 0.0 { *value } else { usual };
        f64::from_bits(((1023 - exponent(value).div_euclid(2)) as u64) << 52)
    };
    largest.iter().map(power).collect()
}
