//! Assembly: from the degrees of freedom of the structure to those of an element, and back.
//!
//! ```text
//! u_e = A_e u,      f_int = Σ_e A_eᵀ f_e(u_e),      K = Σ_e A_eᵀ K_e(u_e) A_e
//! ```
//!
//! `A_e` selects the degrees of freedom of the element `e`; it is stored as the list [`ElementAt::freedoms`]. Sums run over
//! the elements in the order of the input.

use crate::mechanics::structure::element_list::{ElementList, ElementRun};
use crate::mechanics::structure::elements::{FiniteElement, Stretching};

/// Elements that follow one another in a run of one kind, and the degrees of freedom that they join, element by element,
/// in the order of the elements.
#[derive(Clone, Copy)]
pub struct ElementBlock<'a> {
    run: &'a dyn ElementRun,
    first: usize,
    /// Number of an element's degrees of freedom.
    size: usize,
    freedoms: &'a [usize],
}

/// An element and the degrees of freedom that it joins, in the order of the element.
#[derive(Clone, Copy)]
pub struct ElementAt<'a> {
    pub element: &'a dyn FiniteElement,
    pub freedoms: &'a [usize],
    block: ElementBlock<'a>,
}

/// The degrees of freedom of two nodes in space.
const FEW: usize = 6;

/// Most elements of few degrees of freedom in a block. The numbers of a block stay in the processor's fastest memory.
const MOST_TOGETHER: usize = 8;

/// Work memory for the displacements of a block and as many entries for what is computed from them, reused for the next
/// block. Elements of few degrees of freedom need none beside the stack.
pub struct BlockBuffer<const ENTRIES: usize> {
    few: ([f64; MOST_TOGETHER * FEW], [f64; ENTRIES]),
    many: (Vec<f64>, Vec<f64>),
}

/// Work memory for nodal forces.
pub type ForceBuffer = BlockBuffer<{ MOST_TOGETHER * FEW }>;

/// Work memory for tangents.
pub type StiffnessBuffer = BlockBuffer<{ MOST_TOGETHER * FEW * FEW }>;

impl<const ENTRIES: usize> Default for BlockBuffer<ENTRIES> {
    #[inline(always)]
    fn default() -> Self {
        Self { few: ([0.0; MOST_TOGETHER * FEW], [0.0; ENTRIES]), many: (Vec::new(), Vec::new()) }
    }
}

impl<const ENTRIES: usize> BlockBuffer<ENTRIES> {
    /// The displacements of a block, and room for so many numbers.
    #[inline(always)]
    fn of(&mut self, freedoms: &[usize], displacement: &[f64], count: usize) -> (&[f64], &mut [f64]) {
        self.filled_with(freedoms.iter().map(|freedom| displacement[*freedom]), freedoms.len(), count)
    }

    /// These displacements, so many, and room for so many numbers.
    #[inline(always)]
    fn filled_with(
        &mut self,
        gathered: impl Iterator<Item = f64>,
        freedoms: usize,
        count: usize,
    ) -> (&[f64], &mut [f64]) {
        if freedoms <= self.few.0.len() && count <= ENTRIES {
            self.few.0.iter_mut().zip(gathered).for_each(|(own, value)| *own = value);
            return (&self.few.0[..freedoms], &mut self.few.1[..count]);
        }
        self.many.0.clear();
        self.many.0.extend(gathered);
        self.many.1.resize(count, 0.0);
        (&self.many.0, &mut self.many.1)
    }
}

/// The elements of a list in blocks; `freedoms`: the degrees of freedom of all elements, one after the other, each with
/// those of its nodes.
pub(super) fn blocks<'a>(
    elements: &'a ElementList,
    dimension: usize,
    freedoms: &'a [usize],
) -> impl Iterator<Item = ElementBlock<'a>> {
    let mut left = freedoms;
    elements.runs().flat_map(move |run| {
        let size = size_of(run.element(0), dimension);
        let (of_run, others) = left.split_at(run.count() * size);
        left = others;
        let together = if size <= FEW { MOST_TOGETHER } else { 1 };
        let chunks = of_run.chunks(size * together).enumerate();
        chunks.map(move |(block, freedoms)| ElementBlock { run, first: block * together, size, freedoms })
    })
}

/// Number of an element's degrees of freedom.
pub(super) fn size_of(element: &dyn FiniteElement, dimension: usize) -> usize {
    element.nodes().len() * (dimension + element.rotations())
}

impl<'a> ElementBlock<'a> {
    /// Whether an element joins a degree of freedom of those asked for.
    pub fn joins(&self, is_asked: impl Fn(usize) -> bool) -> bool {
        self.freedoms.iter().any(|freedom| is_asked(*freedom))
    }

    /// Calls `add` with the strain energy of each element.
    pub fn each_energy(self, displacement: &[f64], buffer: &mut ForceBuffer, add: impl FnMut(f64)) {
        let (own, energies) = buffer.of(self.freedoms, displacement, self.freedoms.len() / self.size);
        self.run.write_energies(self.first, self.size, own, energies);
        energies.iter().copied().for_each(add);
    }

    /// Calls `add(freedom, force)` with the nodal forces; returns the largest force that one of the elements carries.
    #[inline(always)]
    pub fn each_force(self, displacement: &[f64], buffer: &mut ForceBuffer, mut add: impl FnMut(usize, f64)) -> f64 {
        let (own, forces) = buffer.of(self.freedoms, displacement, self.freedoms.len());
        let carried = self.run.write_forces(self.first, self.size, own, forces);
        self.freedoms.iter().zip(forces).for_each(|(freedom, value)| add(*freedom, *value));
        carried
    }

    /// Whether the forces depend on the positions of the nodes relative to each other alone.
    pub fn is_of_relative_positions(&self) -> bool {
        self.run.element(self.first).is_of_relative_positions()
    }

    /// As [`each_force`](Self::each_force), at displacements with what their rounding left. The displacements of an
    /// element's nodes are taken relative to its first one: their differences have more digits than they have themselves.
    pub fn each_force_beyond(
        self,
        dimension: usize,
        displacement: &[f64],
        remainder: &[f64],
        buffer: &mut ForceBuffer,
        mut add: impl FnMut(usize, f64),
    ) -> f64 {
        let of_node = self.size / self.run.element(self.first).nodes().len();
        let relative = self.freedoms.chunks_exact(self.size).flat_map(|own| {
            own.iter().enumerate().map(move |(place, freedom)| {
                let component = place % of_node;
                if component >= dimension {
                    return displacement[*freedom];
                }
                let first = own[component];
                (displacement[*freedom] - displacement[first]) + (remainder[*freedom] - remainder[first])
            })
        });
        let (own, forces) = buffer.filled_with(relative, self.freedoms.len(), self.freedoms.len());
        let carried = self.run.write_forces(self.first, self.size, own, forces);
        self.freedoms.iter().zip(forces).for_each(|(freedom, value)| add(*freedom, *value));
        carried
    }

    /// Calls `add(freedom, size)` with the size of the terms that make up the nodal forces.
    #[inline(always)]
    pub fn each_force_size(
        self,
        displacement: &[f64],
        least: f64,
        buffer: &mut ForceBuffer,
        mut add: impl FnMut(usize, f64),
    ) {
        let (own, sizes) = buffer.of(self.freedoms, displacement, self.freedoms.len());
        self.run.write_force_sizes(self.first, self.size, own, least, sizes);
        self.freedoms.iter().zip(sizes).for_each(|(freedom, size)| add(*freedom, *size));
    }

    /// Calls `add(row, column, value)` for every entry of the tangents.
    #[inline(always)]
    pub fn each_stiffness(
        self,
        displacement: &[f64],
        buffer: &mut StiffnessBuffer,
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        let (own, stiffnesses) = buffer.of(self.freedoms, displacement, self.freedoms.len() * self.size);
        self.run.write_stiffnesses(self.first, self.size, own, stiffnesses);
        self.each_entry(stiffnesses, add);
    }

    /// As [`each_stiffness`](Self::each_stiffness), without the summands that [`ElementAt::stretching`] lists.
    pub fn each_stiffness_across(
        self,
        displacement: &[f64],
        buffer: &mut StiffnessBuffer,
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        let (own, stiffnesses) = buffer.of(self.freedoms, displacement, self.freedoms.len() * self.size);
        self.run.write_stiffnesses_across(self.first, self.size, own, stiffnesses);
        self.each_entry(stiffnesses, add);
    }

    /// Calls `add` with the entries of a matrix of each element, ordered by pairs of components; for each pair, the
    /// entries of a node with itself come first. Sums over the columns of a row thus add the entries of one component
    /// together.
    #[inline(always)]
    pub(super) fn each_entry(self, matrices: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        let nodes = self.run.element(self.first).nodes().len();
        let own = self.freedoms.chunks_exact(self.size).zip(matrices.chunks_exact(self.size * self.size));
        match (nodes, self.size) {
            (2, 4) => own.for_each(|(freedoms, matrix)| each_entry_of_pair::<2>(freedoms, matrix, add)),
            (2, 6) => own.for_each(|(freedoms, matrix)| each_entry_of_pair::<3>(freedoms, matrix, add)),
            (1, _) => own.for_each(|(freedoms, matrix)| each_entry_of_one(freedoms, matrix, add)),
            _ => own.for_each(|(freedoms, matrix)| each_entry_of(nodes, freedoms, matrix, add)),
        }
    }
}

impl<'a> ElementAt<'a> {
    pub(super) fn new(run: &'a dyn ElementRun, index: usize, freedoms: &'a [usize]) -> Self {
        let block = ElementBlock { run, first: index, size: freedoms.len(), freedoms };
        Self { element: run.element(index), freedoms, block }
    }

    /// The element as a block of its own.
    pub fn alone(self) -> ElementBlock<'a> {
        self.block
    }

    /// The summands `k c cᵀ` of the tangent by which the element resists stretching.
    pub fn stretching(self, displacement: &[f64]) -> impl Iterator<Item = Stretching> {
        let freedoms = self.freedoms;
        let own = self.element.stretching(ForceBuffer::default().of(freedoms, displacement, 0).0);
        own.into_iter().map(|mut stretching| {
            stretching.along.iter_mut().for_each(|(freedom, _)| *freedom = freedoms[*freedom]);
            stretching
        })
    }

    /// The stiffness against a motion, expressed as an axial stiffness.
    pub fn axial_stiffness(self, motion: &[f64], buffer: &mut ForceBuffer) -> f64 {
        self.element.axial_stiffness(buffer.of(self.freedoms, motion, 0).0)
    }

    /// Strain energy.
    pub fn energy(self, displacement: &[f64], buffer: &mut ForceBuffer) -> f64 {
        self.element.energy(buffer.of(self.freedoms, displacement, 0).0)
    }

    /// The stretch `L/L0` of an element that may shrink to a point.
    pub fn stretch(self, displacement: &[f64], buffer: &mut ForceBuffer) -> Option<f64> {
        self.element.stretch(buffer.of(self.freedoms, displacement, 0).0)
    }
}

/// The entries between any number of nodes.
fn each_entry_of(nodes: usize, freedoms: &[usize], matrix: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
    let count = freedoms.len();
    let of_node = count / nodes;
    for row in 0..of_node {
        for column in 0..of_node {
            let mut entry = |first: usize, second: usize| {
                let (row, column) = (first * of_node + row, second * of_node + column);
                add(freedoms[row], freedoms[column], matrix[row * count + column]);
            };
            (0..nodes).for_each(|node| entry(node, node));
            for first in 0..nodes {
                (0..nodes).filter(|second| *second != first).for_each(|second| entry(first, second));
            }
        }
    }
}

/// The entries of one node, in the same order.
#[inline(always)]
fn each_entry_of_one(freedoms: &[usize], matrix: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
    for (row, values) in freedoms.iter().zip(matrix.chunks_exact(freedoms.len())) {
        freedoms.iter().zip(values).for_each(|(column, value)| add(*row, *column, *value));
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
