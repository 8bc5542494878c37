//! All constrained nodes of a matrix, reused as long as they remain the same.

use crate::algebra::sparse::constrained_nodes::constrained_node::HeldNode;
use crate::algebra::sparse::constrained_nodes::nodal_constraints::{Friction, Holdings};
use crate::algebra::sparse::constrained_nodes::node_cache::Nodes;
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::nodal_elimination::constrained_node_construction;
use std::sync::Arc;

/// Usual number of matrix entries of a node, and of entries of its borders, in the plane.
const NUMBERS: usize = 8;
const BORDERS: usize = 14;

impl Nodes {
    /// The nodes of a matrix, reused from an earlier matrix where they are the same.
    pub(super) fn of(matrix: &Bordered, holdings: &Holdings, friction: Friction) -> Arc<Self> {
        let fit = |nodes: &Self, enters: &Vec<bool>| nodes.fit(matrix, holdings, friction, enters);
        let make = |enters| Self::new(matrix, holdings, friction, enters);
        matrix.pattern.last_nodes.find(enters(matrix), fit, make)
    }

    fn new(matrix: &Bordered, holdings: &Holdings, friction: Friction, enters: Vec<bool>) -> Self {
        let n = matrix.pattern.size();
        let mut is_reaction = vec![false; matrix.lower.len()];
        holdings.iter().flat_map(|holding| &holding.columns).for_each(|column| is_reaction[*column] = true);
        let mut place_of = vec![None; n];
        let mut nodes: Vec<HeldNode> = Vec::with_capacity(holdings.iter().len());
        let (mut numbers, mut couplings, mut before) =
            (Vec::with_capacity(NUMBERS * holdings.iter().len()), Vec::new(), 0);
        for holding in holdings.iter() {
            let free = holding.unknowns.iter().all(|unknown| place_of[*unknown].is_none());
            // Reactions with entries in border rows remain borders.
            if !free || holding.columns.iter().any(|column| enters[*column]) {
                continue;
            }
            let place = nodes.len();
            let node = constrained_node_construction::from_borders(
                matrix,
                holding,
                &is_reaction,
                friction,
                place,
                &mut numbers,
                &mut couplings,
            );
            let Some(mut node) = node else { continue };
            for (local, unknown) in node.unknowns().enumerate() {
                place_of[unknown] = Some((place as u32, local as u32));
            }
            node.before = before;
            before += node.held_count() as u32;
            nodes.push(node);
        }
        let mut entries = Vec::with_capacity(BORDERS * holdings.iter().len());
        for list in borders(matrix, holdings) {
            entries.extend_from_slice(list);
            entries.push((list.len(), 0.0));
        }
        Self { nodes, numbers, couplings, place_of, friction, holdings: holdings.clone(), enters, borders: entries }
    }

    /// Whether these nodes are valid for another matrix of this pattern.
    fn fit(&self, matrix: &Bordered, holdings: &Holdings, friction: Friction, enters: &[bool]) -> bool {
        self.friction == friction
            && self.holdings == *holdings
            && self.enters == enters
            && self.has_borders(matrix, holdings)
    }

    /// Whether the rows and columns of the holdings have the stored entries.
    fn has_borders(&self, matrix: &Bordered, holdings: &Holdings) -> bool {
        let mut left = &self.borders[..];
        let is_next = |list: &SparseEntries| {
            let Some((own, rest)) = left.split_at_checked(list.len()) else { return false };
            left = rest.get(1..).unwrap_or_default();
            own == &list[..] && rest.first().is_some_and(|(length, _)| *length == list.len())
        };
        borders(matrix, holdings).all(is_next) && left.is_empty()
    }
}

/// Whether each border column has entries in border rows.
fn enters(matrix: &Bordered) -> Vec<bool> {
    let n = matrix.pattern.size();
    let mut enters = vec![false; matrix.lower.len()];
    for (column, _) in matrix.lower.iter().flatten() {
        if *column >= n {
            enters[*column - n] = true;
        }
    }
    enters
}

/// The border rows and columns of the holdings.
fn borders<'a>(matrix: &'a Bordered, holdings: &'a Holdings) -> impl Iterator<Item = &'a SparseEntries> {
    holdings.iter().flat_map(|holding| {
        let rows = holding.rows.iter().map(|row| &matrix.lower[*row]);
        rows.chain(holding.columns.iter().map(|column| &matrix.right[*column]))
    })
}
