//! The held nodes of the matrices of one pattern that were factorised last. The pattern keeps them, so they know nothing of
//! matrices.

use crate::algebra::sparse::constrained_nodes::held_node::{Coupling, HeldNode};
use crate::algebra::sparse::constrained_nodes::nodal_constraints::{Friction, Holdings};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// All of them, for some entries of the borders.
pub(crate) struct Nodes {
    pub nodes: Vec<HeldNode>,
    /// Entries of the small matrices of the nodes.
    pub numbers: Vec<f64>,
    pub couplings: Vec<Coupling>,
    /// Node and place in it of each unknown.
    pub place_of: Vec<Option<(u32, u32)>>,
    pub friction: Friction,
    pub holdings: Holdings,
    /// Border columns that enter border rows.
    pub enters: Vec<bool>,
    /// Entries of the rows and columns of the holdings, one after the other, each followed by its length.
    pub borders: Vec<(usize, f64)>,
}

/// The nodes of the matrices of one pattern that were factorised last: as long as the holdings and the entries of their
/// border rows and columns are the same, so are the nodes.
#[derive(Default)]
pub(crate) struct LastNodes(Mutex<VecDeque<Arc<Nodes>>>);

/// So many sets of nodes are kept: of the modes on trial at an event and of those before it.
const KEPT: usize = 4;

impl LastNodes {
    /// Those that fit what is given, or else new ones made of it, which are kept.
    pub(crate) fn find<G>(
        &self,
        given: G,
        fit: impl Fn(&Nodes, &G) -> bool,
        make: impl FnOnce(G) -> Nodes,
    ) -> Arc<Nodes> {
        // It is whole at every point where its holder could panic.
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match last.iter().position(|nodes| fit(nodes, &given)) {
            Some(0) => {}
            Some(place) => last.swap(0, place),
            None => {
                last.truncate(KEPT - 1);
                last.push_front(Arc::new(make(given)));
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
