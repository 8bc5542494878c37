//! The constrained nodes of the most recently factorised matrices of one pattern. The pattern stores them, so this
//! module does not depend on matrices.

use crate::algebra::sparse::constrained_nodes::constrained_node::{Coupling, HeldNode};
use crate::algebra::sparse::constrained_nodes::nodal_constraints::{Friction, Holdings};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// All constrained nodes of a matrix, with the border entries for which they are valid.
pub(crate) struct Nodes {
    pub nodes: Vec<HeldNode>,
    /// Entries of the small matrices of the nodes.
    pub numbers: Vec<f64>,
    pub couplings: Vec<Coupling>,
    /// For each unknown, its node and its local index in the node.
    pub place_of: Vec<Option<(u32, u32)>>,
    pub friction: Friction,
    pub holdings: Holdings,
    /// Whether each border column has entries in border rows.
    pub enters: Vec<bool>,
    /// Entries of the rows and columns of the holdings, one after the other, each followed by its length.
    pub borders: Vec<(usize, f64)>,
}

/// The nodes of the most recently factorised matrices of one pattern: nodes remain valid as long as the holdings and
/// the entries of their border rows and columns remain the same.
#[derive(Default)]
pub(crate) struct LastNodes(Mutex<VecDeque<Arc<Nodes>>>);

/// Number of stored sets of nodes: for the contact modes tried at an event and for those before it.
const KEPT: usize = 4;

impl LastNodes {
    /// Returns stored nodes that fit `given`, or else makes and stores new nodes.
    pub(crate) fn find<G>(
        &self,
        given: G,
        fit: impl Fn(&Nodes, &G) -> bool,
        make: impl FnOnce(G) -> Nodes,
    ) -> Arc<Nodes> {
        // The list is consistent at every point where a thread that has locked it could panic.
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
