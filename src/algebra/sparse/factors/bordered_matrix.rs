//! A matrix `[[K, B], [C, D]]` with `K` sparse and nearly symmetric, and few border rows and columns.

use crate::algebra::Inertia;
use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::ldl::SymmetricFactor;
use crate::algebra::sparse::factors::pattern::Pattern;
use crate::resources::spare_memory::Reused;
use nalgebra::DVector;
use smallvec::smallvec;
use std::sync::Arc;

/// The bordered matrix as assembled.
#[derive(Debug, Clone)]
pub struct Bordered {
    pub(crate) pattern: Arc<Pattern>,
    /// Entries of `K`, both triangles.
    pub(crate) values: Reused,
    /// Columns of `B`.
    pub(crate) right: Vec<SparseEntries>,
    /// Rows of `[C, D]`.
    pub(crate) lower: Vec<SparseEntries>,
    /// Entries of `K` that were added one by one, or said to differ: only these may be unsymmetric.
    pub(crate) touched: Vec<(usize, usize)>,
    /// Whether an entry was added outside the pattern.
    pub(crate) is_outside: bool,
}

/// Number of vectors multiplied together.
const SIDE_BY_SIDE: usize = 8;

/// The product with several vectors, by the widest instructions of the machine: the sums are the same with any.
struct Product<'a, const WITH_SIZES: bool> {
    matrix: &'a Bordered,
    rows: &'a [[f64; SIDE_BY_SIDE]],
    sums: &'a mut [[f64; SIDE_BY_SIDE]],
    of_terms: &'a mut [[f64; SIDE_BY_SIDE]],
}

impl<const WITH_SIZES: bool> pulp::NullaryFnOnce for Product<'_, WITH_SIZES> {
    type Output = ();

    // A function that is called rather than inlined would be compiled for the least of machines.
    #[inline(always)]
    fn call(mut self) {
        let matrix = self.matrix;
        let n = matrix.pattern.size();
        for column in 0..n {
            for place in matrix.pattern.column(column) {
                self.add(matrix.pattern.rows[place], column, matrix.values[place]);
            }
        }
        for (border, entries) in matrix.right.iter().enumerate() {
            for (row, entry) in entries {
                self.add(*row, n + border, *entry);
            }
        }
        for (border, entries) in matrix.lower.iter().enumerate() {
            for (column, entry) in entries {
                self.add(n + border, *column, *entry);
            }
        }
    }
}

impl<const WITH_SIZES: bool> Product<'_, WITH_SIZES> {
    #[inline(always)]
    fn add(&mut self, row: usize, column: usize, entry: f64) {
        let (values, sums) = (&self.rows[column], &mut self.sums[row]);
        for number in 0..SIDE_BY_SIDE {
            sums[number] += entry * values[number];
        }
        if WITH_SIZES {
            let of_terms = &mut self.of_terms[row];
            for number in 0..SIDE_BY_SIDE {
                of_terms[number] += (entry * values[number]).abs();
            }
        }
    }
}

impl Bordered {
    /// The zero matrix with `borders` border rows and columns.
    pub fn new(pattern: Arc<Pattern>, borders: usize) -> Self {
        Self {
            values: pattern.matrix_values(),
            pattern,
            right: vec![SparseEntries::new(); borders],
            lower: vec![SparseEntries::new(); borders],
            touched: Vec::new(),
            is_outside: false,
        }
    }

    /// Number of rows, borders included.
    pub fn size(&self) -> usize {
        self.pattern.size() + self.lower.len()
    }

    /// Adds to the entry of `K` with index `place`, as part of a symmetric contribution.
    pub fn add_at(&mut self, place: usize, value: f64) {
        self.values[place] += value;
    }

    /// Says of entries (row, column) that they may differ from their mirror images.
    pub fn let_differ(&mut self, entries: &[(usize, usize)]) {
        self.touched.extend_from_slice(entries);
    }

    /// Whether `K` is symmetric, up to round-off.
    pub fn is_symmetric(&self) -> bool {
        self.differences().next().is_none()
    }

    /// The matrix with `borders` further border rows and columns of zeros.
    #[must_use]
    pub fn widened(mut self, borders: usize) -> Self {
        let count = self.lower.len() + borders;
        self.right.resize(count, SparseEntries::new());
        self.lower.resize(count, SparseEntries::new());
        self
    }

    /// The transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let n = self.pattern.size();
        let mut transposed = Self::new(self.pattern.clone(), self.lower.len());
        transposed
            .values
            .iter_mut()
            .zip(&self.pattern.mirrors)
            .for_each(|(value, mirror)| *value = self.values[*mirror]);
        transposed.touched = self.touched.iter().map(|(row, column)| (*column, *row)).collect();
        transposed.is_outside = self.is_outside;
        transposed.lower.clone_from(&self.right);
        for (border, entries) in self.lower.iter().enumerate() {
            for (column, value) in entries {
                match column.checked_sub(n) {
                    None => transposed.right[border].push((*column, *value)),
                    Some(column) => transposed.lower[column].push((n + border, *value)),
                }
            }
        }
        transposed
    }

    /// `(A - B) f`, `B` another matrix of the same equations.
    #[must_use]
    pub fn minus(&self, other: &Self, factor: f64) -> Self {
        let mut change = self.clone();
        change.values.iter_mut().zip(other.values.iter()).for_each(|(value, other)| *value = (*value - other) * factor);
        let lists = |own: &mut [SparseEntries], others: &[SparseEntries]| {
            for (own, other) in own.iter_mut().zip(others) {
                own.extend(other.iter().map(|(place, value)| (*place, -value)));
                own.sort_by_key(|(place, _)| *place);
                let sums = own.chunk_by(|a, b| a.0 == b.0).map(|same| {
                    let sum: f64 = same.iter().map(|(_, value)| value).sum();
                    (same[0].0, sum * factor)
                });
                *own = sums.collect();
            }
        };
        lists(&mut change.right, &other.right);
        lists(&mut change.lower, &other.lower);
        change.touched.extend_from_slice(&other.touched);
        change.is_outside |= other.is_outside;
        change
    }

    /// `A f`
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self.right.iter_mut().chain(&mut self.lower).flatten().for_each(|(_, value)| *value *= factor);
        self
    }

    /// `A x`
    pub fn times(&self, x: &DVector<f64>) -> DVector<f64> {
        let (mut product, mut sizes) = (DVector::zeros(self.size()), vec![0.0; self.size()]);
        self.multiply(x.as_slice(), product.as_mut_slice(), &mut sizes);
        product
    }

    /// The largest magnitude of the entries, with several entries at one place counted separately.
    pub fn largest(&self) -> f64 {
        let borders = self.right.iter().chain(&self.lower).flatten().map(|(_, value)| *value);
        self.values.iter().copied().chain(borders).fold(0.0, |most, value| value.abs().max(most))
    }

    /// The largest magnitude of the entries of `K`.
    pub fn largest_within(&self) -> f64 {
        self.values.iter().fold(0.0, |most, value| value.abs().max(most))
    }

    /// A column of `B`; entries at the same place add up.
    pub fn right_column(&self, border: usize) -> &[(usize, f64)] {
        &self.right[border]
    }

    /// Computes `y = A x` and the sums of the magnitudes of its terms.
    pub(crate) fn multiply(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) {
        let n = self.pattern.size();
        y.fill(0.0);
        sizes.fill(0.0);
        for (column, value) in x.iter().take(n).enumerate() {
            for place in self.pattern.column(column) {
                let (row, term) = (self.pattern.rows[place], self.values[place] * value);
                y[row] += term;
                sizes[row] += term.abs();
            }
        }
        for (entries, value) in self.right.iter().zip(&x[n..]) {
            for (row, entry) in entries {
                y[*row] += entry * value;
                sizes[*row] += (entry * value).abs();
            }
        }
        for (border, entries) in self.lower.iter().enumerate() {
            for (column, entry) in entries {
                let term = entry * x[*column];
                y[n + border] += term;
                sizes[n + border] += term.abs();
            }
        }
    }

    /// Computes `y = A x` for consecutive vectors: each entry, once read, serves several vectors. `sizes` remains
    /// unchanged without `WITH_SIZES`.
    pub(crate) fn multiply_all<const WITH_SIZES: bool>(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]) {
        let size = self.size();
        let chunk = SIDE_BY_SIDE * size.max(1);
        for ((x, y), sizes) in x.chunks(chunk).zip(y.chunks_mut(chunk)).zip(sizes.chunks_mut(chunk)) {
            let mut rows = vec![[0.0; SIDE_BY_SIDE]; size];
            for (number, x) in x.chunks_exact(size).enumerate() {
                rows.iter_mut().zip(x).for_each(|(row, value)| row[number] = *value);
            }
            let (mut sums, mut of_terms) = (vec![[0.0; SIDE_BY_SIDE]; size], vec![[0.0; SIDE_BY_SIDE]; size]);
            let product = Product::<WITH_SIZES> { matrix: self, rows: &rows, sums: &mut sums, of_terms: &mut of_terms };
            pulp::Arch::new().dispatch(product);
            for (number, (y, sizes)) in y.chunks_exact_mut(size).zip(sizes.chunks_exact_mut(size)).enumerate() {
                y.iter_mut().zip(&sums).for_each(|(value, row)| *value = row[number]);
                if WITH_SIZES {
                    sizes.iter_mut().zip(&of_terms).for_each(|(value, row)| *value = row[number]);
                }
            }
        }
    }

    /// The unit null vectors of `K` alone, taken as symmetric, within a tolerance; `None` where `K` could not be
    /// factorised.
    pub fn null_vectors(&self, tolerance: f64) -> Option<Vec<DVector<f64>>> {
        SymmetricFactor::new(self.pattern.clone(), &self.values).ok()?.null_vectors(tolerance)
    }

    /// The inertia of `K` alone, taken as symmetric.
    pub fn inertia(&self, tolerance: f64) -> Option<Inertia> {
        SymmetricFactor::new(self.pattern.clone(), &self.values).ok()?.inertia(tolerance)
    }

    /// Row, column and difference to the mirror image of the entries below the diagonal that differ by more than round-off, in
    /// order. A difference is round-off relative to the terms that the row and the column add up: of a sum of semidefinite
    /// parts they are bounded by the geometric mean of the diagonal entries.
    fn differences(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let below = self.touched.iter().filter(|(row, column)| row != column);
        let mut below: Vec<(usize, usize)> = below.map(|(row, column)| (*row.max(column), *row.min(column))).collect();
        below.sort_unstable();
        below.dedup();
        below.into_iter().filter_map(|(row, column)| {
            let value = |row, column| self.pattern.place(row, column).map(|place| self.values[place]);
            let (below, above) = (value(row, column)?, value(column, row)?);
            let diagonal = value(row, row)?.abs().sqrt() * value(column, column)?.abs().sqrt();
            let size = below.abs().max(above.abs()).max(diagonal);
            let difference = below - above;
            (difference.abs() > 4.0 * f64::EPSILON * size).then_some((row, column, difference))
        })
    }

    /// The matrix with a symmetric `K`: an unsymmetric remainder `a` of a row becomes a border `[[K, e], [a, -1]]`.
    pub(crate) fn symmetrised(&self) -> Self {
        let mut whole = self.clone();
        let mut extra: Vec<(usize, SparseEntries)> = Vec::new();
        let borders = self.lower.len();
        for (row, column, difference) in self.differences() {
            // The upper triangle defines the symmetric matrix.
            if let (Some(below), Some(above)) = (self.pattern.place(row, column), self.pattern.place(column, row)) {
                whole.values[below] = self.values[above];
            }
            match extra.last_mut().filter(|(known, _)| *known == row) {
                Some((_, entries)) => entries.push((column, difference)),
                None => extra.push((row, smallvec![(column, difference)])),
            }
        }
        for (index, (row, mut entries)) in extra.into_iter().enumerate() {
            let border = self.pattern.size() + borders + index;
            entries.push((border, -1.0));
            whole.right.push(smallvec![(row, 1.0)]);
            whole.lower.push(entries);
        }
        whole
    }

    pub(crate) fn is_finite(&self) -> bool {
        let finite = |entries: &SparseEntries| entries.iter().all(|(_, value)| value.is_finite());
        self.values.iter().all(|value| value.is_finite())
            && self.right.iter().all(finite)
            && self.lower.iter().all(finite)
    }
}

impl Sink for Bordered {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        let n = self.pattern.size();
        if value == 0.0 {
            return;
        }
        if row >= n {
            self.lower[row - n].push((column, value));
        } else if column >= n {
            self.right[column - n].push((row, value));
        } else if let Some(place) = self.pattern.place(row, column) {
            self.values[place] += value;
            self.touched.push((row, column));
        } else {
            self.is_outside = true;
        }
    }
}
