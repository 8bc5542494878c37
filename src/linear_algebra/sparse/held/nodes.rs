//! All held nodes of a matrix, kept as long as they stay the same.

use super::node::{Coupling, HeldNode};
use super::{Friction, Holdings};
use crate::linear_algebra::sparse::Entries;
use crate::linear_algebra::sparse::bordered::Bordered;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// All of them, for some entries of the borders.
pub(super) struct Nodes {
    pub nodes: Vec<HeldNode>,
    /// Entries of the small matrices of the nodes.
    pub numbers: Vec<f64>,
    pub couplings: Vec<Coupling>,
    /// Node and place in it of each unknown.
    pub place_of: Vec<Option<(u32, u32)>>,
    friction: Friction,
    holdings: Holdings,
    /// Border columns that enter border rows.
    enters: Vec<bool>,
    /// Entries of the rows and columns of the holdings, one after the other, each followed by its length.
    borders: Vec<(usize, f64)>,
}

/// The nodes of the matrices of one pattern that were factorised last: as long as the holdings and the entries of their
/// border rows and columns are the same, so are the nodes.
#[derive(Default)]
pub(in crate::linear_algebra::sparse) struct LastNodes(Mutex<VecDeque<Arc<Nodes>>>);

/// So many sets of nodes are kept: of the modes on trial at an event and of those before it.
const KEPT: usize = 4;

/// Numbers of a node, and entries of its borders, as they mostly are in the plane.
const NUMBERS: usize = 8;
const BORDERS: usize = 14;

impl LastNodes {
    pub(super) fn of(&self, matrix: &Bordered, holdings: &Holdings, friction: Friction) -> Arc<Nodes> {
        // It is whole at every point where its holder could panic.
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let enters = enters(matrix);
        match last.iter().position(|nodes| nodes.fit(matrix, holdings, friction, &enters)) {
            Some(0) => {}
            Some(place) => last.swap(0, place),
            None => {
                last.truncate(KEPT - 1);
                last.push_front(Arc::new(Nodes::new(matrix, holdings, friction, enters)));
            }
        }
        Arc::clone(&last[0])
    }
}

impl std::fmt::Debug for LastNodes {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str("LastNodes")
    }
}

impl Nodes {
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
            // Reactions that enter border equations stay.
            if !free || holding.columns.iter().any(|column| enters[*column]) {
                continue;
            }
            let place = nodes.len();
            let node = HeldNode::new(matrix, holding, &is_reaction, friction, place, &mut numbers, &mut couplings);
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

    /// Whether they are those of a matrix with this pattern, too.
    fn fit(&self, matrix: &Bordered, holdings: &Holdings, friction: Friction, enters: &[bool]) -> bool {
        self.friction == friction
            && self.holdings == *holdings
            && self.enters == enters
            && self.has_borders(matrix, holdings)
    }

    /// Whether the entries of the rows and columns of the holdings are these.
    fn has_borders(&self, matrix: &Bordered, holdings: &Holdings) -> bool {
        let mut left = &self.borders[..];
        let is_next = |list: &Entries| {
            let Some((own, rest)) = left.split_at_checked(list.len()) else { return false };
            left = rest.get(1..).unwrap_or_default();
            own == &list[..] && rest.first().is_some_and(|(length, _)| *length == list.len())
        };
        borders(matrix, holdings).all(is_next) && left.is_empty()
    }
}

/// Which border columns have entries in border rows.
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

/// The rows and columns of holdings.
fn borders<'a>(matrix: &'a Bordered, holdings: &'a Holdings) -> impl Iterator<Item = &'a Entries> {
    holdings.iter().flat_map(|holding| {
        let rows = holding.rows.iter().map(|row| &matrix.lower[*row]);
        rows.chain(holding.columns.iter().map(|column| &matrix.right[*column]))
    })
}
