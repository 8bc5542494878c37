//! The degrees of freedom of each node.
//!
//! A node has as many translations as the space has dimensions, then its rotations (none at the nodes of bars). The
//! degrees of freedom are numbered node by node. Only this module knows the index of a degree of freedom.
//!
//! All degrees of freedom are dimensionless: translations over the length scale, rotations in radians. The norm of the
//! arc length adds their squares, so that a rotation counts as the displacement of a point one length scale away from
//! its node.

use std::ops::Range;

/// The degrees of freedom of the nodes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbering {
    dimension: usize,
    /// The first degree of freedom of each node, and the total number.
    first_of: Vec<usize>,
}

impl Numbering {
    /// The numbering in a space of dimension 2 or 3; `rotations` gives the number of rotations of each node.
    pub fn new(dimension: usize, rotations: impl IntoIterator<Item = usize>) -> Self {
        let mut first_of = vec![0];
        let mut next = 0;
        for rotations in rotations {
            next += dimension + rotations;
            first_of.push(next);
        }
        Self { dimension, first_of }
    }

    /// The numbering of nodes that have only translations.
    pub fn of_translations(dimension: usize, nodes: usize) -> Self {
        Self::new(dimension, std::iter::repeat_n(0, nodes))
    }

    /// The dimension of the space.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.first_of.len() - 1
    }

    /// Number of degrees of freedom.
    pub fn freedoms(&self) -> usize {
        self.first_of[self.nodes()]
    }

    /// All degrees of freedom of a node.
    #[inline(always)]
    pub fn freedoms_of(&self, node: usize) -> Range<usize> {
        self.first_of[node]..self.first_of[node + 1]
    }

    /// The translations of a node.
    #[inline(always)]
    pub fn translations_of(&self, node: usize) -> Range<usize> {
        let first = self.first_of[node];
        first..first + self.dimension
    }

    /// The rotations of a node.
    pub fn rotations_of(&self, node: usize) -> Range<usize> {
        self.first_of[node] + self.dimension..self.first_of[node + 1]
    }

    /// The motion along one of a node's degrees of freedom, in words.
    pub fn motion_of(&self, which: usize) -> &'static str {
        match (which, self.dimension) {
            (0, _) => "move along x",
            (1, _) => "move along y",
            (2, 3) => "move along z",
            (3, 3) => "turn about x",
            (4, 3) => "turn about y",
            (5, 3) => "turn about z",
            _ => "turn",
        }
    }

    /// The node of a degree of freedom, and the index of the degree of freedom among the node's.
    pub fn node_of(&self, freedom: usize) -> (usize, usize) {
        let node = self.first_of.partition_point(|first| *first <= freedom) - 1;
        (node, freedom - self.first_of[node])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_with_and_without_rotations_stand_side_by_side() {
        let numbering = Numbering::new(2, [0, 1, 0]);
        assert_eq!((numbering.nodes(), numbering.freedoms()), (3, 7));
        assert_eq!((numbering.freedoms_of(1), numbering.translations_of(1)), (2..5, 2..4));
        assert_eq!((numbering.rotations_of(1), numbering.rotations_of(0)), (4..5, 2..2));
        assert_eq!([1, 4, 5].map(|freedom| numbering.node_of(freedom)), [(0, 1), (1, 2), (2, 0)]);
        assert_eq!(Numbering::of_translations(3, 2).freedoms_of(1), 3..6);
    }
}
