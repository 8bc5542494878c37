//! `K = L U` of a sparse matrix with a symmetric pattern, without exchanges.
//!
//! Friction makes a tangent unsymmetric where contacts slip; its pattern remains symmetric. The elimination order is
//! that of the symmetric factorisation; rows and columns are scaled to entries of about 1, and a pivot lost to
//! cancellation is raised by 1 as in the symmetric factorisation. Iterative refinement recovers the digits lost without
//! row exchanges; the residual shows where it does not (X. S. Li, J. W. Demmel, ACM Trans. Math. Softw. 29 (2003) 110,
//! doi:10.1145/779359.779361: static pivoting).
//!
//! By hand, since the library's LU exchanges rows and analyses the pattern as one without symmetry: the table of
//! `cargo bench --bench elimination` has both.

use crate::algebra::sparse::factors::ldl::scales;
use crate::algebra::sparse::factors::pattern::Pattern;
use crate::algebra::sparse::factors::substitutions::take;
use crate::algebra::sparse::factors::tolerances::SMALLEST_PIVOT;
use crate::resources::budget::{self, Taken};
use std::sync::Arc;

/// A factorisation of `K` with some diagonal entries raised.
pub(crate) struct UnsymmetricFactor {
    pattern: Arc<Pattern>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    pivots: Vec<f64>,
    /// Scale factors of rows and columns: powers of two.
    scales: Vec<f64>,
    /// Unknowns with raised diagonal entries, and the increments in the units of the matrix.
    raised: Vec<(usize, f64)>,
    _held: Taken,
}

/// Number of raised pivots beyond which the factorisation is given up.
const MOST_RAISED: usize = 64;
/// Multiplications between two budget checks.
const AT_ONCE: usize = 1_000_000;

impl UnsymmetricFactor {
    /// Factorises; `values` in the sequence of the pattern. `None` where a pivot is not finite or too many pivots are
    /// lost.
    pub fn new(pattern: Arc<Pattern>, values: &[f64]) -> Option<Self> {
        let size = pattern.size();
        let scales = scales(&pattern, values);
        let fill = pattern.fill();
        let held = budget::take::<f64>(fill.lower_rows.len() + fill.upper_rows.len() + 2 * size);
        let mut factor = Self {
            lower: vec![0.0; fill.lower_rows.len()],
            upper: vec![0.0; fill.upper_rows.len()],
            pivots: vec![0.0; size],
            raised: Vec::new(),
            scales,
            pattern: pattern.clone(),
            _held: held,
        };
        let mut work = vec![0.0; size];
        // Approximate number of multiplications since the last budget check.
        let mut ahead = 0;
        for column in 0..size {
            let unknown = fill.order[column];
            for entry in pattern.column(unknown) {
                let row = pattern.rows[entry];
                work[fill.place_of[row]] = values[entry] * factor.scales[row] * factor.scales[unknown];
            }
            ahead += fill.upper(column).len() * (1 + fill.lower(column).len());
            if ahead > AT_ONCE {
                budget::spend(std::mem::take(&mut ahead));
            }
            for entry in fill.upper(column) {
                let row = fill.upper_rows[entry];
                let value = std::mem::take(&mut work[row]);
                factor.upper[entry] = value;
                if value != 0.0 {
                    for below in fill.lower(row) {
                        work[fill.lower_rows[below]] -= factor.lower[below] * value;
                    }
                }
            }
            let mut pivot = std::mem::take(&mut work[column]);
            if !pivot.is_finite() {
                return None;
            }
            if pivot.abs() < SMALLEST_PIVOT {
                if factor.raised.len() == MOST_RAISED {
                    return None;
                }
                pivot += 1.0;
                factor.raised.push((unknown, 1.0 / (factor.scales[unknown] * factor.scales[unknown])));
            }
            factor.pivots[column] = pivot;
            for below in fill.lower(column) {
                factor.lower[below] = std::mem::take(&mut work[fill.lower_rows[below]]) / pivot;
            }
        }
        Some(factor)
    }

    /// The unknowns whose diagonal entries were raised, and the increments.
    pub fn raised(&self) -> &[(usize, f64)] {
        &self.raised
    }

    /// Sign of the determinant of the raised matrix.
    pub fn determinant_sign(&self) -> f64 {
        self.pivots.iter().fold(1.0, |sign, pivot| sign * pivot.signum())
    }

    /// Ratio of the smallest to the largest pivot magnitude.
    pub fn pivot_ratio(&self) -> f64 {
        let (least, most) =
            self.pivots.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), pivot| (l.min(pivot.abs()), m.max(pivot.abs())));
        if most > 0.0 { least / most } else { 1.0 }
    }

    /// The place of each unknown in the elimination order.
    pub fn places(&self) -> &[usize] {
        &self.pattern.fill().place_of
    }

    /// The scale factors of rows and columns.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// The pivots of the raised and scaled matrix, in the elimination order.
    pub fn pivots(&self) -> &[f64] {
        &self.pivots
    }

    /// Solves with `L` of the raised and scaled matrix; values in the elimination order.
    pub fn solve_lower<const N: usize>(&self, values: &mut [[f64; N]]) {
        let fill = self.pattern.fill();
        budget::spend(self.lower.len() * N);
        for column in 0..values.len() {
            let value = values[column];
            if value != [0.0; N] {
                fill.lower(column)
                    .for_each(|entry| take(&mut values[fill.lower_rows[entry]], self.lower[entry], &value));
            }
        }
    }

    /// Solves with `U`; values in the elimination order.
    pub fn solve_upper<const N: usize>(&self, values: &mut [[f64; N]]) {
        let fill = self.pattern.fill();
        budget::spend(self.upper.len() * N);
        for column in (0..values.len()).rev() {
            let value = values[column].map(|value| value / self.pivots[column]);
            values[column] = value;
            if value != [0.0; N] {
                fill.upper(column)
                    .for_each(|entry| take(&mut values[fill.upper_rows[entry]], self.upper[entry], &value));
            }
        }
    }

    /// Solves with `Uᵀ`; values in the elimination order.
    pub fn solve_upper_transposed<const N: usize>(&self, values: &mut [[f64; N]]) {
        let fill = self.pattern.fill();
        budget::spend(self.upper.len() * N);
        // Before the first entry all remain zero.
        let first = values.iter().position(|value| *value != [0.0; N]).unwrap_or(values.len());
        for column in first..values.len() {
            let mut value = values[column];
            fill.upper(column).for_each(|entry| take(&mut value, self.upper[entry], &values[fill.upper_rows[entry]]));
            values[column] = value.map(|value| value / self.pivots[column]);
        }
    }
}
