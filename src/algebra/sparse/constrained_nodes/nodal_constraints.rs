//! The border rows that constrain the nodes of a matrix.

use smallvec::SmallVec;
use std::sync::Arc;

/// Border rows that constrain unknowns of one node, and the border columns with its reactions, one for each row.
#[derive(Debug, Clone, PartialEq)]
pub struct Holding {
    /// Unknowns of the node: at most three.
    pub unknowns: IndexList,
    pub rows: IndexList,
    pub columns: IndexList,
}

/// Indices of rows, columns or unknowns.
pub type IndexList = SmallVec<[usize; 3]>;

impl Holding {
    /// A holding without rows, for a node that is not constrained yet.
    pub fn new(unknowns: impl IntoIterator<Item = usize>) -> Self {
        Self { unknowns: unknowns.into_iter().collect(), rows: IndexList::new(), columns: IndexList::new() }
    }
}

/// All holdings of a matrix; copies share them.
#[derive(Default, Clone, PartialEq)]
pub struct Holdings {
    list: Arc<Vec<Holding>>,
}

impl Holdings {
    pub fn new(list: Vec<Holding>) -> Self {
        Self { list: Arc::new(list) }
    }

    /// The holdings of the transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let turned = |holding: &Holding| Holding {
            unknowns: holding.unknowns.clone(),
            rows: holding.columns.clone(),
            columns: holding.rows.clone(),
        };
        Self::new(self.list.iter().map(turned).collect())
    }

    pub fn iter(&self) -> std::slice::Iter<'_, Holding> {
        self.list.iter()
    }
}

/// The treatment of the reactions of contacts with friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Friction {
    /// Reactions remain borders.
    Bordered,
    /// Reactions are eliminated, which makes the matrix unsymmetric.
    Eliminated,
}
