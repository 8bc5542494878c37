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

use crate::mechanics::structure::numbering::Numbering;
use std::collections::BTreeMap;

/// `α`, the part of a middle's function that each end of its edge takes.
const SHARE: f64 = 0.2;

/// `1 - 2α`
const KEPT: f64 = 1.0 - 2.0 * SHARE;

/// The middles of edges whose unknowns are transformed, by number of the node, each with the ends of its edge.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BasisTransformation {
    ends: BTreeMap<usize, [usize; 2]>,
}

/// A middle and the ends of its edge: their places among values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePlaces {
    pub middle: usize,
    pub ends: [usize; 2],
}

impl EdgePlaces {
    /// `u_m` of the unknowns.
    pub fn displace(&self, values: &mut [f64]) {
        let [a, b] = self.ends.map(|end| values[end]);
        values[self.middle] = KEPT * values[self.middle] + SHARE * (a + b);
    }

    /// `û_m` of the displacements.
    fn extrapolate(&self, values: &mut [f64]) {
        let [a, b] = self.ends.map(|end| values[end]);
        values[self.middle] = (values[self.middle] - SHARE * (a + b)) / KEPT;
    }

    /// `f̂` of the forces on the nodes.
    pub fn distribute(&self, forces: &mut [f64]) {
        let of_middle = forces[self.middle];
        self.ends.iter().for_each(|end| forces[*end] += SHARE * of_middle);
        forces[self.middle] = KEPT * of_middle;
    }

    /// The forces on the nodes of `f̂`.
    fn collect(&self, forces: &mut [f64]) {
        let of_middle = forces[self.middle] / KEPT;
        self.ends.iter().for_each(|end| forces[*end] -= SHARE * of_middle);
        forces[self.middle] = of_middle;
    }

    /// The tangent over the unknowns of that over the displacements, row by row.
    pub fn transform(&self, size: usize, tangent: &mut [f64]) {
        tangent.chunks_exact_mut(size).for_each(|row| self.distribute(row));
        for column in 0..size {
            let at = |row: usize| row * size + column;
            let Self { middle, ends } = *self;
            Self { middle: at(middle), ends: ends.map(at) }.distribute(tangent);
        }
    }
}

impl BasisTransformation {
    /// The middles, each with the ends of its edge.
    pub fn new(ends: BTreeMap<usize, [usize; 2]>) -> Self {
        Self { ends }
    }

    /// Whether no unknown is transformed.
    pub fn is_identity(&self) -> bool {
        self.ends.is_empty()
    }

    /// The ends of the edge of a middle whose unknowns are transformed.
    pub fn ends_of(&self, node: usize) -> Option<[usize; 2]> {
        self.ends.get(&node).copied()
    }

    /// The edges of an element, by the places of its nodes.
    pub fn edges_among(&self, nodes: &[usize]) -> Vec<EdgePlaces> {
        if self.is_identity() {
            return Vec::new();
        }
        let place_of = |node: usize| nodes.iter().position(|own| *own == node);
        let edge = |(middle, node): (usize, &usize)| {
            let [a, b] = self.ends_of(*node)?;
            Some(EdgePlaces { middle, ends: [place_of(a)?, place_of(b)?] })
        };
        nodes.iter().enumerate().filter_map(edge).collect()
    }

    /// The edges, by degrees of freedom.
    fn edges<'a>(&'a self, numbering: &'a Numbering) -> impl Iterator<Item = EdgePlaces> + 'a {
        self.ends.iter().flat_map(|(node, ends)| {
            let [a, b] = ends.map(|end| numbering.translations_of(end));
            let together = numbering.translations_of(*node).zip(a.zip(b));
            together.map(|(middle, (a, b))| EdgePlaces { middle, ends: [a, b] })
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
        let more = self.edges(numbering).map(|EdgePlaces { middle, ends: [a, b] }| {
            let mut values = [change(middle), change(a), change(b)];
            EdgePlaces { middle: 0, ends: [1, 2] }.displace(&mut values);
            values[0].powi(2) - change(middle).powi(2)
        });
        (norm * norm + more.sum::<f64>()).max(0.0).sqrt()
    }

    /// The unknowns that displacements prescribe: those of degrees of freedom that are held.
    pub fn prescribed(&self, numbering: &Numbering, is_held: impl Fn(usize) -> bool, values: &mut [f64]) {
        self.edges(numbering).filter(|edge| is_held(edge.middle)).for_each(|edge| edge.extrapolate(values));
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
        let numbering = Numbering::of_translations(4, 3);
        let basis = BasisTransformation::new(BTreeMap::from([(1, [0, 3]), (2, [3, 0])]));
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
