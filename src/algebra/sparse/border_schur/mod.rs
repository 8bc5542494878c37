//! Solves a bordered system by the Schur complement of its borders, with `K = L U` factorised.
//!
//! The complement is `D - (U⁻ᵀ Cᵀ)ᵀ (L⁻¹ B)`, and the solution for `(f, g)`
//!
//! ```text
//! z = L⁻¹ f,      y = (D - C K⁻¹ B)⁻¹ (g - (U⁻ᵀ Cᵀ)ᵀ z),      x = U⁻¹ (z - L⁻¹ B y)
//! ```
//!
//! so that each border takes one substitution with one factor, and each solution one with either: the halves of borders
//! with few entries are sparse themselves.
//!
//! By hand, since the library has no bordered systems; `block_elimination` has the times beside its sparse LU.

mod complement;
mod half_solutions;

use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::ldl::SymmetricFactor;
use crate::algebra::sparse::factors::static_pivot_lu::UnsymmetricFactor;
use crate::algebra::sparse::factors::substitutions::TOGETHER;
use complement::Complement;
use half_solutions::HalfSolutions;
use nalgebra::DMatrix;
use smallvec::smallvec;

/// Factors of `K` with some diagonal entries raised.
pub(super) enum Factor {
    Symmetric(SymmetricFactor),
    Unsymmetric(UnsymmetricFactor),
}

impl Factor {
    fn solve_lower<const N: usize>(&self, values: &mut [[f64; N]]) {
        match self {
            Self::Symmetric(factor) => factor.substitutions().solve_lower(values),
            Self::Unsymmetric(factor) => factor.solve_lower(values),
        }
    }

    fn solve_upper<const N: usize>(&self, values: &mut [[f64; N]]) {
        match self {
            Self::Symmetric(factor) => factor.substitutions().solve_upper(values),
            Self::Unsymmetric(factor) => factor.solve_upper(values),
        }
    }

    /// Solves with `L` for values that are zero but at `starts`; returns the places that may not be zero afterwards,
    /// ascending.
    fn solve_lower_from<const N: usize>(&self, starts: &[usize], values: &mut [[f64; N]]) -> Vec<usize> {
        match self {
            Self::Symmetric(factor) => factor.substitutions().solve_lower_from(starts, values),
            Self::Unsymmetric(factor) => {
                factor.solve_lower(values);
                (0..values.len()).collect()
            }
        }
    }

    /// The same with `Uᵀ`; `pivots`: those of the scaled matrix, in the elimination order.
    fn solve_upper_transposed_from<const N: usize>(
        &self,
        starts: &[usize],
        values: &mut [[f64; N]],
        pivots: &[f64],
    ) -> Vec<usize> {
        match self {
            Self::Symmetric(factor) => {
                let reached = factor.substitutions().solve_lower_from(starts, values);
                reached.iter().for_each(|place| values[*place].iter_mut().for_each(|value| *value /= pivots[*place]));
                reached
            }
            Self::Unsymmetric(factor) => {
                factor.solve_upper_transposed(values);
                (0..values.len()).collect()
            }
        }
    }

    /// The pivots of the scaled matrix in the elimination order.
    fn pivots(&self) -> Vec<f64> {
        match self {
            Self::Symmetric(factor) => factor.substitutions().pivots().collect(),
            Self::Unsymmetric(factor) => factor.pivots().to_vec(),
        }
    }

    /// The place of an unknown in the elimination order.
    fn place(&self, unknown: usize) -> usize {
        match self {
            Self::Symmetric(factor) => factor.places().map_or(unknown, |places| places[unknown]),
            Self::Unsymmetric(factor) => factor.places()[unknown],
        }
    }

    /// The place of an entry of a border, and its value in the scaled matrix.
    fn placed(&self, unknown: usize, value: f64) -> (usize, f64) {
        (self.place(unknown), value * self.scales()[unknown])
    }

    /// The scale factors of rows and columns.
    fn scales(&self) -> &[f64] {
        match self {
            Self::Symmetric(factor) => factor.scales(),
            Self::Unsymmetric(factor) => factor.scales(),
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
    rows: Vec<SparseEntries>,
    /// `D`, with the borders of the increments.
    corner: DMatrix<f64>,
    pivots: Vec<f64>,
    /// `L⁻¹ B` and `U⁻ᵀ Cᵀ`
    column_halves: HalfSolutions,
    row_halves: HalfSolutions,
    complement: Complement,
    given: usize,
}

/// Vectors with a sparse part at the unknowns and a part at the borders, one column each.
pub(super) struct SplitVectors {
    pub upper: Vec<SparseEntries>,
    pub lower: DMatrix<f64>,
}

impl SplitVectors {
    /// Zeros.
    pub fn new(count: usize, borders: usize) -> Self {
        Self { upper: vec![SparseEntries::new(); count], lower: DMatrix::zeros(borders, count) }
    }
}

impl BorderSchurComplement {
    /// Forms the complement and factorises it; `None` where a number is not finite.
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
        let mut corner = corner.resize(count, count, 0.0);
        (given..count).for_each(|raise| corner[(raise, raise)] = -1.0);
        let pivots = factor.pivots();
        let placed = |unknown, value| factor.placed(unknown, value);
        let mut work = vec![[0.0; TOGETHER]; size];
        let column_halves =
            HalfSolutions::new(&columns, &mut work, placed, |starts, values| factor.solve_lower_from(starts, values));
        let solve = |starts: &_, values: &mut _| factor.solve_upper_transposed_from(starts, values, &pivots);
        let row_halves = HalfSolutions::new(&rows, &mut work, placed, solve);
        let complement = Complement::new(&corner, &row_halves, &column_halves, &pivots)?;
        Some(Self { factor, size, rows, corner, pivots, column_halves, row_halves, complement, given })
    }

    /// Replaces a row of `[C, D]`.
    pub fn with_row(mut self, row: usize, entries: SparseEntries, corner: &[f64]) -> Option<Self> {
        *self.rows.get_mut(row)? = entries;
        corner.iter().enumerate().for_each(|(column, value)| self.corner[(row, column)] = *value);
        let factor = &self.factor;
        let placed = |unknown, value| factor.placed(unknown, value);
        let solve = |starts: &_, values: &mut _| factor.solve_upper_transposed_from(starts, values, &self.pivots);
        self.row_halves.renew(&self.rows, row, self.size, placed, solve);
        self.complement = Complement::new(&self.corner, &self.row_halves, &self.column_halves, &self.pivots)?;
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

    /// The products of vectors, one row each, with the solutions for right-hand sides, one column each; `None` where the
    /// complement gives no result. Both are solved for halfway.
    pub fn products(&self, rows: &SplitVectors, rights: &SplitVectors) -> Option<DMatrix<f64>> {
        let factor = &self.factor;
        let placed = |unknown, value| factor.placed(unknown, value);
        let mut work = vec![[0.0; TOGETHER]; self.size];
        let right_halves = HalfSolutions::new(&rights.upper, &mut work, placed, |starts, values| {
            factor.solve_lower_from(starts, values)
        });
        let solve = |starts: &_, values: &mut _| factor.solve_upper_transposed_from(starts, values, &self.pivots);
        let halves = HalfSolutions::new(&rows.upper, &mut work, placed, solve);
        // Rows of raised pivots have no right-hand sides.
        let lower = |split: &SplitVectors| split.lower.clone().resize_vertically(self.rows.len(), 0.0);
        let mut weights = lower(rights) - self.row_halves.products_with(&right_halves, self.size);
        if !self.complement.solve(&mut weights) {
            return None;
        }
        let by_weights = lower(rows).transpose() - halves.products_with(&self.column_halves, self.size);
        let products = halves.products_with(&right_halves, self.size) + by_weights * weights;
        products.iter().all(|value| value.is_finite()).then_some(products)
    }

    /// Solves for `count` consecutive right-hand sides, overwriting both parts of each.
    pub fn solve(&self, upper: &mut [f64], lower: &mut [f64], count: usize) -> bool {
        if count == 1 {
            return self.solve_together(upper, lower, 1, &mut vec![[0.0; 1]; self.size]);
        }
        let mut values = vec![[0.0; TOGETHER]; self.size];
        (0..count).step_by(TOGETHER).all(|first| {
            let some = first..count.min(first + TOGETHER);
            let upper = &mut upper[some.start * self.size..some.end * self.size];
            let lower = &mut lower[some.start * self.given..some.end * self.given];
            self.solve_together(upper, lower, some.len(), &mut values)
        })
    }

    /// Solves for up to `N` right-hand sides, each entry of the factors read once for all of them; `values` is room for
    /// them in the elimination order.
    fn solve_together<const N: usize>(
        &self,
        upper: &mut [f64],
        lower: &mut [f64],
        count: usize,
        values: &mut [[f64; N]],
    ) -> bool {
        let scales = self.factor.scales();
        for unknown in 0..self.size {
            let given =
                |lane: usize| upper.get(lane * self.size + unknown).map_or(0.0, |value| value * scales[unknown]);
            values[self.factor.place(unknown)] = std::array::from_fn(given);
        }
        self.factor.solve_lower(values);
        let mut by_row = self.row_halves.products(values);
        let mut weights = DMatrix::zeros(self.rows.len(), count);
        for (row, products) in by_row.iter().enumerate() {
            for (lane, product) in products.iter().enumerate().take(count) {
                let given = if row < self.given { lower[lane * self.given + row] } else { 0.0 };
                weights[(row, lane)] = given - product;
            }
        }
        if !self.complement.solve(&mut weights) {
            return false;
        }
        for (row, values) in by_row.iter_mut().enumerate() {
            *values = std::array::from_fn(|lane| if lane < count { weights[(row, lane)] } else { 0.0 });
        }
        self.column_halves.take(&by_row, values);
        self.factor.solve_upper(values);
        for unknown in 0..self.size {
            let place = &values[self.factor.place(unknown)];
            (0..count).for_each(|lane| upper[lane * self.size + unknown] = place[lane] * scales[unknown]);
        }
        for (lane, lower) in lower.chunks_exact_mut(self.given.max(1)).enumerate().take(count) {
            lower.iter_mut().zip(weights.column(lane).iter()).for_each(|(value, weight)| *value = *weight);
        }
        upper.iter().all(|value| value.is_finite())
    }
}
