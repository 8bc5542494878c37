//! Where a symmetric sparse matrix may have entries, and the order in which it is eliminated.

use super::held::LastNodes;
use super::unsymmetric::Fill;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use std::sync::OnceLock;

/// Work of a factorisation by entry of the factor, over forty, from which it goes by dense blocks: those of a plane lattice of
/// 10,000 unknowns take two thirds of the time so.
const BY_BLOCKS: SupernodalThreshold = SupernodalThreshold(0.25);

/// The entries of a symmetric matrix, both triangles, column by column; with the symbolic factorisation.
#[derive(Debug)]
pub struct Pattern {
    size: usize,
    /// First entry of each column, and the number of entries.
    pub(super) starts: Vec<usize>,
    pub(super) rows: Vec<usize>,
    /// Place of the transposed entry.
    pub(super) mirrors: Vec<usize>,
    pub(super) symbolic: SymbolicCholesky<usize>,
    /// Made when first needed.
    fill: OnceLock<Fill>,
    pub(super) last_nodes: LastNodes,
}

impl Pattern {
    /// A pattern with entries on the diagonal and at the given `(row, column)` and their transposes, in any order, repeated
    /// or not. `None` where a place is outside or memory does not suffice.
    ///
    /// The order of elimination is that of P. R. Amestoy, T. A. Davis, I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996)
    /// 886, doi:10.1137/S0895479894278952.
    pub fn new(size: usize, entries: impl IntoIterator<Item = (usize, usize)>) -> Option<Self> {
        let mut places: Vec<(usize, usize)> = (0..size).map(|index| (index, index)).collect();
        for (row, column) in entries {
            if row >= size || column >= size {
                return None;
            }
            places.push((column, row));
            places.push((row, column));
        }
        places.sort_unstable();
        places.dedup();
        let mut starts = vec![0; size + 1];
        places.iter().for_each(|(column, _)| starts[column + 1] += 1);
        (0..size).for_each(|column| starts[column + 1] += starts[column]);
        let rows: Vec<usize> = places.iter().map(|(_, row)| *row).collect();
        // The entries are sorted by column, then row: taken so, the transposed ones come in order in each column.
        let mut next = starts.clone();
        let mirrors = rows
            .iter()
            .map(|row| {
                next[*row] += 1;
                next[*row] - 1
            })
            .collect();
        let view = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        let symbolic = factorize_symbolic_cholesky(
            view,
            faer::Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams { supernodal_flop_ratio_threshold: BY_BLOCKS, ..Default::default() },
        )
        .ok()?;
        Some(Self { size, starts, rows, mirrors, symbolic, fill: OnceLock::new(), last_nodes: LastNodes::default() })
    }

    /// Rows of the matrix.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Number of entries, both triangles.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// Number of entries of the factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Place of an entry among all; `None` where there is none.
    pub fn place(&self, row: usize, column: usize) -> Option<usize> {
        let start = *self.starts.get(column)?;
        let rows = self.rows.get(start..*self.starts.get(column + 1)?)?;
        rows.binary_search(&row).ok().map(|index| start + index)
    }

    /// Where unsymmetric factors have entries.
    pub(super) fn fill(&self) -> &Fill {
        self.fill.get_or_init(|| Fill::new(self))
    }

    pub(super) fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.starts[column]..self.starts[column + 1]
    }

    pub(super) fn view<'a>(&'a self, values: &'a [f64]) -> faer::sparse::SparseColMatRef<'a, usize, f64> {
        let symbolic = SymbolicSparseColMatRef::new_checked(self.size, self.size, &self.starts, None, &self.rows);
        faer::sparse::SparseColMatRef::new(symbolic, values)
    }
}
