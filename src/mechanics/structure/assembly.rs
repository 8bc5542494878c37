//! Assembly: from the degrees of freedom of the structure to those of an element, and back.
//!
//! ```text
//! u_e = A_e u,      f_int = Σ_e A_eᵀ f_e(u_e),      K = Σ_e A_eᵀ K_e(u_e) A_e
//! ```
//!
//! `A_e` selects the degrees of freedom of the element `e`; the list [`ElementAt::freedoms`] stands for it.

use crate::mechanics::structure::elements::{FiniteElement, Stretching};

/// An element and the degrees of freedom that it joins, in the order of the element.
#[derive(Clone, Copy)]
pub struct ElementAt<'a> {
    pub element: &'a dyn FiniteElement,
    pub freedoms: &'a [usize],
}

/// The degrees of freedom of two nodes in space.
const FEW: usize = 6;

/// Work memory for one element, reused for the next. Elements of few degrees of freedom need none beside the stack.
#[derive(Default)]
pub struct ElementBuffer {
    few: ([f64; FEW], [[f64; FEW]; FEW]),
    many: (Vec<f64>, Vec<f64>),
}

impl ElementBuffer {
    /// The displacement of an element, and room for so many numbers, at most the entries of its tangent.
    #[inline(always)]
    fn of(&mut self, at: ElementAt<'_>, displacement: &[f64], count: usize) -> (&[f64], &mut [f64]) {
        let gathered = at.freedoms.iter().map(|freedom| displacement[*freedom]);
        if at.freedoms.len() <= FEW {
            self.few.0.iter_mut().zip(gathered).for_each(|(own, value)| *own = value);
            return (&self.few.0[..at.freedoms.len()], &mut self.few.1.as_flattened_mut()[..count]);
        }
        self.many.0.clear();
        self.many.0.extend(gathered);
        self.many.1.resize(count, 0.0);
        (&self.many.0, &mut self.many.1)
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
        match (self.element.nodes().len(), self.freedoms.len()) {
            (2, 4) => each_entry_of_pair::<2>(self.freedoms, matrix, add),
            (2, 6) => each_entry_of_pair::<3>(self.freedoms, matrix, add),
            (nodes, _) => self.each_entry_of(nodes, matrix, add),
        }
    }

    /// As [`each_entry`](Self::each_entry), for any number of nodes.
    fn each_entry_of(self, nodes: usize, matrix: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        let count = self.freedoms.len();
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

/// The entries between two nodes of so many degrees of freedom, in the same order.
#[inline(always)]
fn each_entry_of_pair<const OF_NODE: usize>(
    freedoms: &[usize],
    matrix: &[f64],
    add: &mut impl FnMut(usize, usize, f64),
) {
    let (first, second) = freedoms.split_at(OF_NODE);
    let (upper, lower) = matrix.split_at(2 * OF_NODE * OF_NODE);
    for row in 0..OF_NODE {
        let upper = &upper[2 * OF_NODE * row..][..2 * OF_NODE];
        let lower = &lower[2 * OF_NODE * row..][..2 * OF_NODE];
        for column in 0..OF_NODE {
            add(first[row], first[column], upper[column]);
            add(second[row], second[column], lower[OF_NODE + column]);
            add(first[row], second[column], upper[OF_NODE + column]);
            add(second[row], first[column], lower[column]);
        }
    }
}
