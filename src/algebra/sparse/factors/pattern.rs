//! The sparsity pattern of a symmetric matrix and its elimination order.

use crate::algebra::sparse::constrained_nodes::node_cache::LastNodes;
use crate::algebra::sparse::factors::elimination_order::Symbolic;
use crate::algebra::sparse::factors::lu_pattern::LuPattern;
use crate::algebra::sparse::factors::tolerances::BLOCKED_LDL_WORK;
use crate::resources::budget::{self, Taken};
use crate::resources::spare_memory::{Reused, SpareMemory};
use faer::sparse::SymbolicSparseColMatRef;
use std::sync::OnceLock;

/// The sparsity pattern of a symmetric matrix, both triangles by columns, with its symbolic factorisation.
#[derive(Debug)]
pub struct Pattern {
    size: usize,
    /// Index of the first entry of each column, followed by the number of entries.
    pub(crate) starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    /// Index of the transposed entry of each entry.
    pub(crate) mirrors: Vec<usize>,
    pub(crate) symbolic: Symbolic,
    /// Computed when first needed.
    fill: OnceLock<LuPattern>,
    pub(crate) last_nodes: LastNodes,
    /// Of the entries of matrices, and of those of factors.
    spare: [SpareMemory; 2],
    _held: Taken,
}

impl Pattern {
    /// A pattern with entries on the diagonal, at the given `(row, column)` and at their transposes, in any order, with
    /// or without repetition. `None` where an index is out of range or memory runs out. The budget ends the current
    /// solve where the factors would be too large.
    pub fn new(size: usize, entries: impl IntoIterator<Item = (usize, usize)>) -> Option<Self> {
        let mut places: Vec<(usize, usize)> = (0..size).map(|index| (index, index)).collect();
        for (row, column) in entries {
            if row >= size || column >= size {
                return None;
            }
            places.push((column, row));
            places.push((row, column));
        }
        let sorting = budget::take::<(usize, usize)>(places.capacity());
        budget::spend(places.len());
        places.sort_unstable();
        places.dedup();
        let mut starts = vec![0; size + 1];
        places.iter().for_each(|(column, _)| starts[column + 1] += 1);
        (0..size).for_each(|column| starts[column + 1] += starts[column]);
        let rows: Vec<usize> = places.iter().map(|(_, row)| *row).collect();
        // The entries are sorted by column, then row: in this sequence the transposed entries appear in order in each
        // column.
        let mut next = starts.clone();
        let mirrors = rows
            .iter()
            .map(|row| {
                next[*row] += 1;
                next[*row] - 1
            })
            .collect();
        drop((places, sorting));
        let symbolic = Symbolic::new((&starts, &rows), (&starts, &rows), BLOCKED_LDL_WORK)?;
        let held = budget::take::<usize>(size + 2 * rows.len() + symbolic.indices());
        let (fill, last_nodes) = (OnceLock::new(), LastNodes::default());
        let spare = [3, 1].map(SpareMemory::new);
        Some(Self { size, starts, rows, mirrors, symbolic, fill, last_nodes, spare, _held: held })
    }

    /// Number of rows of the matrix.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Number of entries, both triangles.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// Zeros for all entries.
    pub(crate) fn matrix_values(&self) -> Reused {
        self.spare[0].zeros(self.entries())
    }

    /// Any numbers for all entries.
    pub(crate) fn any_matrix_values(&self) -> Reused {
        self.spare[0].any(self.entries())
    }

    /// Any numbers for the entries of the factor.
    pub(crate) fn any_factor_values(&self) -> Reused {
        self.spare[1].any(self.factor_entries())
    }

    /// Number of entries of the factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.cholesky.len_val()
    }

    /// Index of an entry among all entries; `None` outside the pattern.
    pub fn place(&self, row: usize, column: usize) -> Option<usize> {
        let start = *self.starts.get(column)?;
        let rows = self.rows.get(start..*self.starts.get(column + 1)?)?;
        rows.binary_search(&row).ok().map(|index| start + index)
    }

    /// The patterns of the unsymmetric factors.
    pub(crate) fn fill(&self) -> &LuPattern {
        self.fill.get_or_init(|| LuPattern::new(&self.starts, &self.rows, &self.symbolic))
    }

    pub(crate) fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.starts[column]..self.starts[column + 1]
    }

    pub(crate) fn view<'a>(&'a self, values: &'a [f64]) -> faer::sparse::SparseColMatRef<'a, usize, f64> {
        let symbolic = SymbolicSparseColMatRef::new_checked(self.size, self.size, &self.starts, None, &self.rows);
        faer::sparse::SparseColMatRef::new(symbolic, values)
    }
}
