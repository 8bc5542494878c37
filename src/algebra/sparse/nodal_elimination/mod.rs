//! Elimination of constrained nodes, each within its own equations.
//!
//! A closed contact adds rows `C u_i + d L = g` at its node `i` and reactions `r` in the node's own equations, so the
//! saddle-point problem needs no border: with `Q` orthogonal, `y = Qᵀ u_i = (y_H, y_T)` and `C Q = [M, 0]`,
//!
//! ```text
//! y_H = M⁻¹ (g - d L),      R r = f_H - (K y)_H - ...,      QᵀB = [R; F]
//! ```
//!
//! Rows and columns `H` are removed from the matrix (with 1 left on the diagonal); its pattern remains. Without
//! friction, `F = 0` and back substitution gives `r`. With friction (`F != 0`) there are two options: `r` remains a
//! border, with the equations `H` as its rows, and the matrix remains symmetric; or `F R⁻¹` times the equations `H` is
//! subtracted from the equations `T`, which makes the matrix unsymmetric, and back substitution gives `r` as well.
//!
//! By hand, since the library has no such elimination. Contacts that stay in the borders take 1.2 to 1.5 times as long
//! up to 1,012 unknowns; with 10,010 and 49 contacts, where the unsymmetric factorisation outweighs the borders, 0.8
//! times (`cargo bench --bench elimination`, two cores, 2026-11-25).

pub(crate) mod constrained_node_construction;
pub(crate) mod constrained_node_set;
pub(crate) mod tolerances;

pub(super) use crate::algebra::sparse::constrained_nodes::constrained_node::{
    Coupling, HeldNode, Matrices, gathered, times,
};
pub(super) use crate::algebra::sparse::constrained_nodes::nodal_constraints::Friction;
pub use crate::algebra::sparse::constrained_nodes::nodal_constraints::{Holding, Holdings, IndexList};

use crate::algebra::sparse::constrained_nodes::node_cache::Nodes;
use crate::algebra::sparse::factors::bordered_matrix::Bordered;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::resources::spare_memory::Reused;
use smallvec::SmallVec;
use std::sync::Arc;

/// The constrained nodes of a matrix, and the rows and columns `H` removed with them.
pub(super) struct Elimination {
    nodes: Arc<Nodes>,
    /// Index of the first entry of each column and of each row `H` of all nodes.
    columns_at: Vec<u32>,
    rows_at: Vec<u32>,
    /// Entries of all rows and columns `H`.
    entries: Vec<(usize, f64)>,
}

impl Elimination {
    /// Eliminates the constrained nodes; returns the values of the remaining matrix, too. A holding that cannot be
    /// eliminated in this way remains in the borders.
    pub fn new(matrix: &Bordered, holdings: &Holdings, friction: Friction) -> (Self, Reused) {
        let all = Nodes::of(matrix, holdings, friction);
        let (nodes, numbers) = (&all.nodes, &all.numbers);
        let mut values = matrix.values.clone();
        nodes.iter().for_each(|node| constrained_node_construction::rotate_matrix(node, matrix, numbers, &mut values));
        let held = nodes.last().map_or(0, |node| node.before as usize + node.held_count());
        let most = nodes.iter().flat_map(HeldNode::held).map(|unknown| matrix.pattern.column(unknown).len());
        let mut entries = Vec::with_capacity(2 * most.sum::<usize>());
        let [mut rows_at, mut columns_at] = [(); 2].map(|()| Vec::with_capacity(held + 1));
        // All rows and columns are extracted before any is cleared: neighbouring nodes have entries in each other's
        // rows and columns.
        nodes.iter().for_each(|node| {
            constrained_node_construction::take(node, matrix, &values, true, &mut entries, &mut rows_at)
        });
        rows_at.push(entries.len() as u32);
        nodes.iter().for_each(|node| constrained_node_construction::fold(node, matrix, numbers, &mut values));
        nodes.iter().for_each(|node| {
            constrained_node_construction::take(node, matrix, &values, false, &mut entries, &mut columns_at)
        });
        columns_at.push(entries.len() as u32);
        nodes.iter().for_each(|node| constrained_node_construction::clear(node, matrix, &mut values));
        (Self { nodes: all, columns_at, rows_at, entries }, values)
    }

    pub fn nodes(&self) -> &[HeldNode] {
        &self.nodes.nodes
    }

    pub fn couplings(&self) -> &[Coupling] {
        &self.nodes.couplings
    }

    /// The small matrices of a node.
    pub fn matrices(&self, node: &HeldNode) -> Matrices<'_> {
        node.matrices(&self.nodes.numbers)
    }

    /// A column `H` of a node.
    pub fn stiffness(&self, node: &HeldNode, index: usize) -> &[(usize, f64)] {
        self.taken(&self.columns_at, node, index)
    }

    /// The column `H` of a constrained unknown; `None` for other unknowns.
    pub fn stiffness_at(&self, unknown: usize) -> Option<&[(usize, f64)]> {
        let (node, local) = self.nodes.place_of[unknown]?;
        let node = &self.nodes()[node as usize];
        ((local as usize) < node.held_count()).then(|| self.stiffness(node, local as usize))
    }

    /// A row `H` of a node.
    pub fn equilibrium(&self, node: &HeldNode, index: usize) -> &[(usize, f64)] {
        self.taken(&self.rows_at, node, index)
    }

    fn taken(&self, starts: &[u32], node: &HeldNode, index: usize) -> &[(usize, f64)] {
        let place = node.before as usize + index;
        &self.entries[starts[place] as usize..starts[place + 1] as usize]
    }

    /// Whether an unknown of the rotated system is constrained.
    pub fn is_held(&self, unknown: usize) -> bool {
        self.nodes.place_of[unknown]
            .is_some_and(|(node, local)| (local as usize) < self.nodes()[node as usize].held_count())
    }

    /// The entries of a row or a column in the rotated unknowns: at free unknowns, and at constrained unknowns.
    pub fn rotated(&self, entries: &[(usize, f64)]) -> (SparseEntries, SparseEntries) {
        let (mut free, mut held) = (SparseEntries::with_capacity(entries.len()), SparseEntries::new());
        let mut at_nodes: SmallVec<[(u32, u32, f64); 8]> = SmallVec::new();
        for (unknown, value) in entries {
            match self.nodes.place_of[*unknown] {
                None => free.push((*unknown, *value)),
                Some((node, local)) => at_nodes.push((node, local, *value)),
            }
        }
        at_nodes.sort_by_key(|(node, local, _)| (*node, *local));
        for group in at_nodes.chunk_by(|a, b| a.0 == b.0) {
            let node = &self.nodes()[group[0].0 as usize];
            let (rotation, count) = (self.matrices(node).rotation, node.count());
            let mut put = |place: usize, value: f64| {
                if value != 0.0 {
                    if place < node.held_count() { &mut held } else { &mut free }.push((node.unknown(place), value));
                }
            };
            if node.turns {
                for (place, column) in rotation.chunks_exact(count).enumerate() {
                    put(place, group.iter().map(|(_, local, value)| column[*local as usize] * value).sum());
                }
            } else {
                for same in group.chunk_by(|a, b| a.1 == b.1) {
                    put(same[0].1 as usize, same.iter().map(|(.., value)| value).sum());
                }
            }
        }
        (free, held)
    }

    /// Appends the entries of a column of the rotated matrix to those at free unknowns and those at constrained
    /// unknowns.
    pub fn split_into(
        &self,
        entries: impl Iterator<Item = (usize, f64)>,
        free: &mut SparseEntries,
        held: &mut SparseEntries,
    ) {
        entries.for_each(|entry| if self.is_held(entry.0) { &mut *held } else { &mut *free }.push(entry));
    }

    /// The contributions of a column's entries at constrained unknowns to the free equations of their nodes, where
    /// friction is eliminated.
    pub fn eliminated_friction(&self, held: &[(usize, f64)]) -> SparseEntries {
        let mut free = SparseEntries::new();
        for (unknown, value) in held {
            let Some((node, local)) = self.nodes.place_of[*unknown] else { continue };
            let node = &self.nodes()[node as usize];
            let others = node.count() - node.held_count();
            let friction = self.matrices(node).friction.chunks_exact(others.max(1)).nth(local as usize);
            for (other, factor) in friction.into_iter().flatten().enumerate() {
                free.push((node.unknown(node.held_count() + other), -factor * value));
            }
        }
        free
    }

    /// Applies `Qᵀ`, or `Q` if `back`, at every node.
    pub fn rotate(&self, x: &mut [f64], back: bool) {
        self.nodes().iter().filter(|node| node.turns).for_each(|node| node.turn(&self.nodes.numbers, x, back));
    }

    /// Eliminates friction from a rotated right-hand side.
    pub fn fold(&self, x: &mut [f64]) {
        for node in self.nodes().iter().filter(|node| node.folds) {
            let (count, held) = (node.count(), node.held_count());
            let taken = times(self.matrices(node).friction, count - held, &gathered(node.held(), x));
            (held..count).zip(taken.iter()).for_each(|(other, value)| x[node.unknown(other)] -= value);
        }
    }
}
