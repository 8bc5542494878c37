//! `K = L U` of a sparse matrix with a symmetric pattern, without exchanges.
//!
//! Friction makes a tangent unsymmetric where contacts slip; its pattern stays. The order is that of the symmetric
//! factorisation, rows and columns are brought to entries of about 1, and a pivot that is lost in cancellation is raised by
//! 1 as there; what is lost without exchanges is mended by refinement, and seen in the residual where it is not (X. S. Li,
//! J. W. Demmel, ACM Trans. Math. Softw. 29 (2003) 110, doi:10.1145/779359.779361: static pivoting).

use super::pattern::Pattern;
use super::symmetric::{SMALL, scales};
use crate::budget::{self, Taken};
use std::sync::Arc;

/// Where `L` (by columns) and `U` (by columns) have entries off the diagonal.
#[derive(Debug)]
pub(super) struct Fill {
    /// Unknown at each place of the order, and place of each unknown.
    order: Vec<usize>,
    place_of: Vec<usize>,
    /// Rows below the diagonal of each column of `L`.
    lower_starts: Vec<usize>,
    lower_rows: Vec<usize>,
    /// Rows above the diagonal of each column of `U`, in ascending order.
    upper_starts: Vec<usize>,
    upper_rows: Vec<usize>,
    /// Multiplications of a factorisation.
    pub work: u64,
    _held: Taken,
}

impl Fill {
    /// By the elimination tree (J. W. H. Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134, doi:10.1137/0611010).
    pub fn new(pattern: &Pattern) -> Self {
        let size = pattern.size();
        let order: Vec<usize> = match pattern.symbolic.cholesky.perm() {
            Some(perm) => perm.arrays().0.to_vec(),
            None => (0..size).collect(),
        };
        let mut place_of = vec![0; size];
        order.iter().enumerate().for_each(|(place, unknown)| place_of[*unknown] = place);
        let mut parent = vec![usize::MAX; size];
        let mut ancestor = vec![usize::MAX; size];
        let mut mark = vec![usize::MAX; size];
        let (mut upper_starts, mut upper_rows) = (vec![0], Vec::new());
        for column in 0..size {
            let above = || pattern.column(order[column]).map(|entry| place_of[pattern.rows[entry]]);
            for row in above().filter(|row| *row < column) {
                let mut node = row;
                while ancestor[node] != usize::MAX && ancestor[node] != column {
                    node = std::mem::replace(&mut ancestor[node], column);
                }
                if ancestor[node] == usize::MAX {
                    ancestor[node] = column;
                    parent[node] = column;
                }
            }
            mark[column] = column;
            for row in above().filter(|row| *row < column) {
                let mut node = row;
                while mark[node] != column {
                    mark[node] = column;
                    upper_rows.push(node);
                    node = parent[node];
                }
            }
            if column % COLUMNS_AT_ONCE == 0 {
                budget::spend(upper_rows.len());
            }
            upper_rows[upper_starts[column]..].sort_unstable();
            upper_starts.push(upper_rows.len());
        }
        let mut lower_starts = vec![0; size + 1];
        upper_rows.iter().for_each(|row| lower_starts[row + 1] += 1);
        let work = lower_starts.iter().fold(0_u64, |sum, count| sum.saturating_add((count * count) as u64));
        (0..size).for_each(|column| lower_starts[column + 1] += lower_starts[column]);
        let held = budget::take::<usize>(2 * upper_rows.len() + 4 * size);
        let mut next = lower_starts.clone();
        let mut lower_rows = vec![0; upper_rows.len()];
        for column in 0..size {
            for row in &upper_rows[upper_starts[column]..upper_starts[column + 1]] {
                lower_rows[next[*row]] = column;
                next[*row] += 1;
            }
        }
        Self { order, place_of, lower_starts, lower_rows, upper_starts, upper_rows, work, _held: held }
    }

    fn lower(&self, column: usize) -> std::ops::Range<usize> {
        self.lower_starts[column]..self.lower_starts[column + 1]
    }

    fn upper(&self, column: usize) -> std::ops::Range<usize> {
        self.upper_starts[column]..self.upper_starts[column + 1]
    }
}

/// A factorisation of `K` with some diagonal entries raised.
pub(super) struct UnsymmetricFactor {
    pattern: Arc<Pattern>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    pivots: Vec<f64>,
    /// What rows and columns were multiplied by: powers of two.
    scales: Vec<f64>,
    /// Unknown and raise, in the units of the matrix.
    raised: Vec<(usize, f64)>,
    _held: Taken,
}

/// Raises beyond which there is something else wrong.
const MOST_RAISED: usize = 64;
/// Multiplications, and columns, between two looks at whether the solve goes on.
const AT_ONCE: usize = 1_000_000;
const COLUMNS_AT_ONCE: usize = 256;

impl UnsymmetricFactor {
    /// Factorises; `values` as the pattern has them. `None` where a number is not finite or too many pivots are lost.
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
        // Multiplications since the last look at the flag, roughly.
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
            if pivot.abs() < SMALL {
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

    /// Unknowns whose diagonal entry was raised, and by how much.
    pub fn raised(&self) -> &[(usize, f64)] {
        &self.raised
    }

    /// Sign of the determinant of the raised matrix.
    pub fn determinant_sign(&self) -> f64 {
        self.pivots.iter().fold(1.0, |sign, pivot| sign * pivot.signum())
    }

    /// Smallest pivot over the largest one.
    pub fn pivot_ratio(&self) -> f64 {
        let (least, most) =
            self.pivots.iter().fold((f64::INFINITY, 0.0_f64), |(l, m), pivot| (l.min(pivot.abs()), m.max(pivot.abs())));
        if most > 0.0 { least / most } else { 1.0 }
    }

    /// Solves with the raised matrix for right-hand sides one after the other, overwritten; `false` when a result is not
    /// finite.
    pub fn solve(&self, right_hand_sides: &mut [f64], count: usize) -> bool {
        let size = self.pattern.size();
        if size == 0 || count == 0 {
            return true;
        }
        let fill = self.pattern.fill();
        let mut work = vec![0.0; size];
        for values in right_hand_sides.chunks_exact_mut(size) {
            budget::spend(self.lower.len() + self.upper.len());
            for (place, unknown) in work.iter_mut().zip(&fill.order) {
                *place = values[*unknown] * self.scales[*unknown];
            }
            for column in 0..size {
                let value = work[column];
                if value != 0.0 {
                    fill.lower(column).for_each(|entry| work[fill.lower_rows[entry]] -= self.lower[entry] * value);
                }
            }
            for column in (0..size).rev() {
                let value = work[column] / self.pivots[column];
                work[column] = value;
                if value != 0.0 {
                    fill.upper(column).for_each(|entry| work[fill.upper_rows[entry]] -= self.upper[entry] * value);
                }
            }
            for (place, unknown) in work.iter().zip(&fill.order) {
                values[*unknown] = place * self.scales[*unknown];
            }
        }
        right_hand_sides.iter().all(|value| value.is_finite())
    }
}
