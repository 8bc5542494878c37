//! Entries of a row or a column of a sparse matrix.

use smallvec::SmallVec;

/// Entries of a row or a column: place and value.
pub type SparseEntries = SmallVec<[(usize, f64); 3]>;
