//! The positions of the entries of the factors `L` and `U`, fill-in included, of a matrix whose own pattern
//! (`pattern`) is symmetric.

use crate::algebra::sparse::factors::elimination_order::Symbolic;
use crate::resources::budget::{self, Taken};

/// Columns between two budget checks.
const COLUMNS_AT_ONCE: usize = 256;

/// The patterns of `L` and `U` off the diagonal, both by columns.
#[derive(Debug)]
pub(crate) struct LuPattern {
    /// Unknown at each place of the elimination order, and place of each unknown.
    pub order: Vec<usize>,
    pub place_of: Vec<usize>,
    /// Rows below the diagonal of each column of `L`.
    lower_starts: Vec<usize>,
    pub lower_rows: Vec<usize>,
    /// Rows above the diagonal of each column of `U`, in ascending order.
    upper_starts: Vec<usize>,
    pub upper_rows: Vec<usize>,
    /// Number of multiplications of a factorisation.
    pub work: u64,
    _held: Taken,
}

impl LuPattern {
    /// The patterns for a symmetric pattern by columns, in the order of its symmetric factorisation, from the
    /// elimination tree (J. W. H. Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134, doi:10.1137/0611010).
    pub fn new(starts: &[usize], rows: &[usize], symbolic: &Symbolic) -> Self {
        let size = starts.len().saturating_sub(1);
        let order: Vec<usize> = match symbolic.cholesky.perm() {
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
            let entries = &rows[starts[order[column]]..starts[order[column] + 1]];
            let above = || entries.iter().map(|row| place_of[*row]);
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

    pub fn lower(&self, column: usize) -> std::ops::Range<usize> {
        self.lower_starts[column]..self.lower_starts[column + 1]
    }

    pub fn upper(&self, column: usize) -> std::ops::Range<usize> {
        self.upper_starts[column]..self.upper_starts[column + 1]
    }
}
