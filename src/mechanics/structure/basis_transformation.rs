//! A basis of quadratic solids whose functions have positive integrals over faces in space.
//!
//! An even pressure on a quadratic face has no forces at the corners of a triangle and pulling ones at those of a
//! quadrilateral: contacts there would open. Therefore part of the function of the middle `m` of an edge is given to its
//! ends `a` and `b`. The displacements stay what they are, and unknowns and forces become
//!
//! ```text
//! Ñ_m = (1 - 2α) N_m,     Ñ_a = N_a + α Σ_m N_m  (of the edges at a)
//! û_m = (u_m - α (u_a + u_b))/(1 - 2α),           û_a = u_a
//! f̂_m = (1 - 2α) f_m,     f̂_a = f_a + α Σ_m f_m
//! ```
//!
//! With `α = 1/5` the integrals over a plane face are 2/15 and 1/5 of the area of a triangle at corners and middles, and
//! 1/20 and 1/5 of that of a quadrilateral. The gap of a contact at `m` is that of `û_m`, whose shares of the nodes are 5/3
//! and -1/3: a contact of one unknown each, as at any node. (B. P. Lamichhane, R. P. Stevenson, B. I. Wohlmuth,
//! Numer. Math. 102 (2005) 93, doi:10.1007/s00211-005-0636-z; A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, SIAM J. Sci.
//! Comput. 34 (2012) B421, doi:10.1137/110848190.)
//!
//! Where bodies touch each other their faces are linear: the middle follows the ends of its edge, `û_m = u_m - (u_a + u_b)/2`
//! is held at zero, and half of the force on it goes to each end. Displacements are then those of the corners along the
//! faces, quadratic inside the body.

use crate::mechanics::structure::numbering::Numbering;
use std::collections::BTreeMap;

/// `α`, the part of a middle's function that each end of its edge takes.
const SHARE: f64 = 0.2;

/// `1 - 2α`
const KEPT: f64 = 1.0 - 2.0 * SHARE;

/// What the unknown of a middle is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MiddleUnknown {
    /// That of the functions with positive integrals.
    Extrapolated,
    /// The distance from the mean of the ends, which is held at zero.
    OffTheChord,
}

/// An edge with a middle whose unknown is transformed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TransformedEdge {
    pub ends: [usize; 2],
    pub unknown: MiddleUnknown,
}

/// The middles of edges whose unknowns are transformed, by number of the node.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BasisTransformation {
    edges: BTreeMap<usize, TransformedEdge>,
}

/// A middle and the ends of its edge: their places among values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePlaces {
    pub middle: usize,
    pub ends: [usize; 2],
    pub unknown: MiddleUnknown,
}

impl MiddleUnknown {
    /// The parts of the middle's function that each end takes and that the middle keeps.
    fn parts(self) -> [f64; 2] {
        match self {
            Self::Extrapolated => [SHARE, KEPT],
            Self::OffTheChord => [0.5, 1.0],
        }
    }
}

impl EdgePlaces {
    /// `u_m` of the unknowns.
    pub fn displace(&self, values: &mut [f64]) {
        let [share, kept] = self.unknown.parts();
        let [a, b] = self.ends.map(|end| values[end]);
        values[self.middle] = kept * values[self.middle] + share * (a + b);
    }

    /// `û_m` of the displacements.
    fn extrapolate(&self, values: &mut [f64]) {
        let [share, kept] = self.unknown.parts();
        let [a, b] = self.ends.map(|end| values[end]);
        values[self.middle] = (values[self.middle] - share * (a + b)) / kept;
    }

    /// `f̂` of the forces on the nodes.
    pub fn distribute(&self, forces: &mut [f64]) {
        let [share, kept] = self.unknown.parts();
        let of_middle = forces[self.middle];
        self.ends.iter().for_each(|end| forces[*end] += share * of_middle);
        forces[self.middle] = kept * of_middle;
    }

    /// The forces on the nodes of `f̂`; a middle that follows its ends takes none.
    fn collect(&self, forces: &mut [f64]) {
        if self.unknown == MiddleUnknown::OffTheChord {
            forces[self.middle] = 0.0;
            return;
        }
        let of_middle = forces[self.middle] / KEPT;
        self.ends.iter().for_each(|end| forces[*end] -= SHARE * of_middle);
        forces[self.middle] = of_middle;
    }

    /// The tangent over the unknowns of that over the displacements, row by row.
    pub fn transform(&self, size: usize, tangent: &mut [f64]) {
        tangent.chunks_exact_mut(size).for_each(|row| self.distribute(row));
        for column in 0..size {
            let at = |row: usize| row * size + column;
            Self { middle: at(self.middle), ends: self.ends.map(at), ..*self }.distribute(tangent);
        }
    }
}

impl BasisTransformation {
    /// The transformed edges by their middles.
    pub fn new(edges: BTreeMap<usize, TransformedEdge>) -> Self {
        Self { edges }
    }

    /// Whether no unknown is transformed.
    pub fn is_identity(&self) -> bool {
        self.edges.is_empty()
    }

    /// The ends of the edge of a middle whose unknown is extrapolated.
    pub fn extrapolated_from(&self, node: usize) -> Option<[usize; 2]> {
        let edge = self.edges.get(&node).filter(|edge| edge.unknown == MiddleUnknown::Extrapolated)?;
        Some(edge.ends)
    }

    /// The middles that follow the ends of their edges: all of their unknowns are held.
    pub fn following(&self) -> impl Iterator<Item = usize> {
        let follows = |edge: &TransformedEdge| edge.unknown == MiddleUnknown::OffTheChord;
        self.edges.iter().filter(move |(_, edge)| follows(edge)).map(|(node, _)| *node)
    }

    /// The edges of an element, by the places of its nodes.
    pub fn edges_among(&self, nodes: &[usize]) -> Vec<EdgePlaces> {
        if self.is_identity() {
            return Vec::new();
        }
        let place_of = |node: usize| nodes.iter().position(|own| *own == node);
        let edge = |(middle, node): (usize, &usize)| {
            let TransformedEdge { ends: [a, b], unknown } = *self.edges.get(node)?;
            Some(EdgePlaces { middle, ends: [place_of(a)?, place_of(b)?], unknown })
        };
        nodes.iter().enumerate().filter_map(edge).collect()
    }

    /// The edges, by degrees of freedom.
    fn edges<'a>(&'a self, numbering: &'a Numbering) -> impl Iterator<Item = EdgePlaces> + 'a {
        self.edges.iter().flat_map(|(node, TransformedEdge { ends, unknown })| {
            let [a, b] = ends.map(|end| numbering.translations_of(end));
            let together = numbering.translations_of(*node).zip(a.zip(b));
            together.map(|(middle, (a, b))| EdgePlaces { middle, ends: [a, b], unknown: *unknown })
        })
    }

    /// The displacements of the nodes, of unknowns over all degrees of freedom.
    pub fn displacements(&self, numbering: &Numbering, values: &mut [f64]) {
        self.edges(numbering).for_each(|edge| edge.displace(values));
    }

    /// The norm of a change of the displacements of all nodes, given that of the change of the unknowns, between two vectors
    /// of unknowns.
    pub fn norm_of_displacements(&self, numbering: &Numbering, from: &[f64], to: &[f64], norm: f64) -> f64 {
        if self.is_identity() {
            return norm;
        }
        let change = |freedom: usize| to[freedom] - from[freedom];
        let more = self.edges(numbering).map(|edge| {
            let [middle, a, b] = [edge.middle, edge.ends[0], edge.ends[1]].map(change);
            let mut values = [middle, a, b];
            EdgePlaces { middle: 0, ends: [1, 2], ..edge }.displace(&mut values);
            values[0].powi(2) - middle.powi(2)
        });
        (norm * norm + more.sum::<f64>()).max(0.0).sqrt()
    }

    /// The unknowns that displacements prescribe: those of degrees of freedom that are held. Middles that follow stay on
    /// their chords.
    pub fn prescribed(&self, numbering: &Numbering, is_held: impl Fn(usize) -> bool, values: &mut [f64]) {
        for edge in self.edges(numbering).filter(|edge| is_held(edge.middle)) {
            match edge.unknown {
                MiddleUnknown::Extrapolated => edge.extrapolate(values),
                MiddleUnknown::OffTheChord => values[edge.middle] = 0.0,
            }
        }
    }

    /// The forces on the unknowns, of forces on the nodes.
    pub fn forces_on_unknowns(&self, numbering: &Numbering, forces: &mut [f64]) {
        self.edges(numbering).for_each(|edge| edge.distribute(forces));
    }

    /// The forces on the nodes, of forces on the unknowns.
    pub fn forces_on_nodes(&self, numbering: &Numbering, forces: &mut [f64]) {
        self.edges(numbering).for_each(|edge| edge.collect(forces));
    }
}

/// The same combination of coordinates or gaps at a middle and the ends of its edge as `û_m` is of displacements.
pub fn extrapolated(middle: f64, ends: [f64; 2]) -> f64 {
    // For the middle of a straight edge without rounding.
    middle + 2.0 * SHARE / KEPT * (middle - 0.5 * (ends[0] + ends[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Work of forces and displacements is the same in both bases; both ways undo each other.
    #[test]
    fn forces_are_dual_to_displacements() {
        let numbering = Numbering::of_translations(3, 4);
        let extrapolated = |ends| TransformedEdge { ends, unknown: MiddleUnknown::Extrapolated };
        let basis = BasisTransformation::new(BTreeMap::from([(1, extrapolated([0, 3])), (2, extrapolated([3, 0]))]));
        let unknowns: Vec<f64> = (0..12).map(|place| (1.7 * f64::from(place)).sin()).collect();
        let mut displacements = unknowns.clone();
        basis.displacements(&numbering, &mut displacements);
        let forces: Vec<f64> = (0..12).map(|place| (2.3 * f64::from(place)).cos()).collect();
        let mut on_unknowns = forces.clone();
        basis.forces_on_unknowns(&numbering, &mut on_unknowns);
        let work = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!((work(&forces, &displacements) - work(&on_unknowns, &unknowns)).abs() < 1e-14);
        basis.forces_on_nodes(&numbering, &mut on_unknowns);
        basis.prescribed(&numbering, |_| true, &mut displacements);
        for (one, other) in on_unknowns.iter().zip(&forces).chain(displacements.iter().zip(&unknowns)) {
            assert!((one - other).abs() < 1e-15, "{one} {other}");
        }
    }
}
