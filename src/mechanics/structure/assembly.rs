//! From the degrees of freedom of the structure to those of an element, and back.

use crate::mechanics::structure::elements::{FiniteElement, Stretching};
use smallvec::SmallVec;

/// An element and the degrees of freedom that it joins, in the order of the element.
#[derive(Clone, Copy)]
pub struct ElementAt<'a> {
    pub element: &'a dyn FiniteElement,
    pub freedoms: &'a [usize],
}

/// Work memory for one element, reused for the next.
#[derive(Default)]
pub struct ElementBuffer {
    // On the stack for two nodes in space.
    displacement: SmallVec<[f64; 6]>,
    values: SmallVec<[f64; 36]>,
}

impl ElementBuffer {
    /// The element's displacement, and room for `count` numbers.
    fn of(&mut self, at: ElementAt<'_>, displacement: &[f64], count: usize) -> (&[f64], &mut [f64]) {
        self.displacement.clear();
        self.displacement.extend(at.freedoms.iter().map(|freedom| displacement[*freedom]));
        self.values.resize(count, 0.0);
        (&self.displacement, &mut self.values)
    }
}

impl ElementAt<'_> {
    /// Calls `add(freedom, force)` with the nodal forces; returns the size of the force that the element carries.
    pub fn each_force(self, displacement: &[f64], buffer: &mut ElementBuffer, mut add: impl FnMut(usize, f64)) -> f64 {
        let (own, force) = buffer.of(self, displacement, self.freedoms.len());
        let carried = self.element.write_force(own, force);
        self.freedoms.iter().zip(force).for_each(|(freedom, value)| add(*freedom, *value));
        carried
    }

    /// Calls `add(freedom, size)` with the size of the terms that make up the nodal forces.
    pub fn each_force_size(
        self,
        displacement: &[f64],
        least: f64,
        buffer: &mut ElementBuffer,
        mut add: impl FnMut(usize, f64),
    ) {
        let (own, sizes) = buffer.of(self, displacement, self.freedoms.len());
        self.element.write_force_sizes(own, least, sizes);
        self.freedoms.iter().zip(sizes).for_each(|(freedom, size)| add(*freedom, *size));
    }

    /// Calls `add(row, column, value)` for every entry of the tangent.
    pub fn each_stiffness(
        self,
        displacement: &[f64],
        buffer: &mut ElementBuffer,
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        let count = self.freedoms.len();
        let (own, stiffness) = buffer.of(self, displacement, count * count);
        self.element.write_stiffness(own, stiffness);
        self.each_entry(stiffness, add);
    }

    /// As [`each_stiffness`](Self::each_stiffness), without the summands that [`stretching`](Self::stretching) lists.
    pub fn each_stiffness_across(
        self,
        displacement: &[f64],
        buffer: &mut ElementBuffer,
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        let count = self.freedoms.len();
        let (own, stiffness) = buffer.of(self, displacement, count * count);
        self.element.write_stiffness_across(own, stiffness);
        self.each_entry(stiffness, add);
    }

    /// Calls `add` with the entries of a matrix of the element, ordered by pairs of components; for each pair, the
    /// entries of a node with itself come first. Sums over the columns of a row thus add the entries of one component
    /// together.
    fn each_entry(self, matrix: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        let (count, nodes) = (self.freedoms.len(), self.element.nodes().len());
        let of_node = count / nodes;
        for row in 0..of_node {
            for column in 0..of_node {
                let mut entry = |first: usize, second: usize| {
                    let (row, column) = (first * of_node + row, second * of_node + column);
                    add(self.freedoms[row], self.freedoms[column], matrix[row * count + column]);
                };
                (0..nodes).for_each(|node| entry(node, node));
                for first in 0..nodes {
                    (0..nodes).filter(|second| *second != first).for_each(|second| entry(first, second));
                }
            }
        }
    }

    /// The summands `k c cᵀ` of the tangent by which the element resists stretching.
    pub fn stretching(self, displacement: &[f64]) -> impl Iterator<Item = Stretching> {
        let (mut buffer, freedoms) = (ElementBuffer::default(), self.freedoms);
        let own = self.element.stretching(buffer.of(self, displacement, 0).0);
        own.into_iter().map(|mut stretching| {
            stretching.along.iter_mut().for_each(|(freedom, _)| *freedom = freedoms[*freedom]);
            stretching
        })
    }

    /// The stiffness against a motion, expressed as an axial stiffness.
    pub fn axial_stiffness(self, motion: &[f64], buffer: &mut ElementBuffer) -> f64 {
        self.element.axial_stiffness(buffer.of(self, motion, 0).0)
    }

    /// Strain energy.
    pub fn energy(self, displacement: &[f64], buffer: &mut ElementBuffer) -> f64 {
        self.element.energy(buffer.of(self, displacement, 0).0)
    }

    /// The stretch `L/L0` of an element that may shrink to a point.
    pub fn stretch(self, displacement: &[f64], buffer: &mut ElementBuffer) -> Option<f64> {
        self.element.stretch(buffer.of(self, displacement, 0).0)
    }
}
