//! The structure: positions, unknowns and elements; internal forces, tangent and strain energy.
//!
//! ```text
//! f_int(u) = Σ_e ∂W_e/∂u,   K(u) = Σ_e ∂²W_e/∂u²
//! ```
//!
//! Loads that follow the structure are elements, too, whose forces are no derivative of an energy: see [`following_loads`].
//!
//! All quantities are dimensionless (`scene` divides by the scales). The module knows nothing of contacts, loads or
//! paths. Each kind of element has a file of its own behind [`elements::FiniteElement`]; only [`numbering`] knows which
//! degrees of freedom a node has.

pub mod assembly;
pub mod basis_transformation;
pub mod element_list;
pub mod elements;
pub mod following_loads;
pub mod mixed_iteration;
pub mod numbering;
mod resistance;
pub mod sparsity;
pub mod turning_nodes;

use assembly::{ElementAt, ElementBlock, ForceBuffer, StiffnessBuffer};
use element_list::ElementList;
use elements::{FiniteElement, Resultants, Stretching};
use nalgebra::DMatrix;
use numbering::Numbering;
use smallvec::SmallVec;
use sparsity::Layout;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;
use turning_nodes::TurningNodes;

/// Largest number of unknowns for which matrices are dense.
pub const MOST_DENSE: usize = 16;

/// Force, over the force scale, that the rounding of a displacement of 1 may cause without harm: the tolerance up to which
/// reactions count as zero. States of stiffer structures keep what rounding leaves.
const ROUNDING_THAT_MATTERS: f64 = 1e-10;

/// Largest number of unknowns for which null spaces and eigenvalues are computed, in dense matrices: beyond it, smooth
/// bifurcation points and directions at singular points are not sought.
pub const MOST_ANALYSED: usize = 3_000;

/// A checked structure.
#[derive(Debug, Clone)]
pub struct Structure {
    /// Dimension of the space.
    pub dimension: usize,
    /// The degrees of freedom of each node.
    pub numbering: Numbering,
    /// The unknown of each degree of freedom; `None` where it is supported.
    pub unknown_of: Vec<Option<usize>>,
    /// The degree of freedom of each unknown.
    pub freedom_of: Vec<usize>,
    elements: ElementList,
    /// The degrees of freedom of the elements, one element after the other, and the index of the first of each element.
    element_freedoms: Vec<usize>,
    first_freedom: Vec<usize>,
    /// The elements at the nodes, node by node, and the index of the first of each node.
    elements_at: Vec<usize>,
    first_at: Vec<usize>,
    /// Pairs of groups of nodes whose degrees of freedom are coupled otherwise than by elements, each node of one with each
    /// of the other.
    couplings: Vec<[Vec<usize>; 2]>,
    layout: Option<Arc<Layout>>,
    /// The nodes that turn freely in space.
    pub turning: TurningNodes,
    /// Whether an element has forces that are variables of the iteration.
    independent_forces: bool,
    /// Whether loads follow the structure: see [`following_loads`].
    following_loads: bool,
    /// The largest force that a displacement of one may cause.
    largest_stiffness: f64,
}

impl Structure {
    /// A structure whose nodes have the rotations of their elements. A support fixes a degree of freedom of a node,
    /// given by its index among the node's.
    pub fn new(dimension: usize, nodes: usize, supports: &[(usize, usize)], elements: ElementList) -> Self {
        Self::like(None, dimension, nodes, supports, elements)
    }

    /// As [`new`](Self::new), with the sparsity layout of another structure if the other one has the same unknowns and
    /// elements between the same nodes.
    pub fn like(
        other: Option<&Self>,
        dimension: usize,
        nodes: usize,
        supports: &[(usize, usize)],
        elements: ElementList,
    ) -> Self {
        let mut rotations = vec![0; nodes];
        for element in elements.iter() {
            for (place, node) in element.nodes().iter().enumerate().filter(|_| element.rotations() > 0) {
                let most = element.first_rotation_at(place) + element.rotations();
                rotations[*node] = most.max(rotations[*node]);
            }
        }
        let numbering = Numbering::new(dimension, rotations);
        let mut is_held = vec![false; numbering.freedoms()];
        for (node, which) in supports {
            is_held[numbering.freedoms_of(*node)][*which] = true;
        }
        let freedom_of: Vec<usize> = (0..numbering.freedoms()).filter(|freedom| !is_held[*freedom]).collect();
        let mut unknown_of = vec![None; numbering.freedoms()];
        freedom_of.iter().enumerate().for_each(|(unknown, freedom)| unknown_of[*freedom] = Some(unknown));
        let mut structure = Self {
            dimension,
            numbering,
            unknown_of,
            freedom_of,
            elements: ElementList::default(),
            element_freedoms: Vec::new(),
            first_freedom: vec![0],
            elements_at: Vec::new(),
            first_at: Vec::new(),
            couplings: Vec::new(),
            layout: None,
            turning: TurningNodes::default(),
            independent_forces: elements.iter().any(|element| element.independent_forces() > 0),
            following_loads: elements.iter().any(FiniteElement::is_load),
            largest_stiffness: 0.0,
        };
        structure.turning = TurningNodes::of(&structure.numbering, &structure.unknown_of);
        structure.set_elements(elements);
        let (still, mut sizes) = (vec![0.0; structure.freedoms()], vec![0.0; structure.freedoms()]);
        structure.force_sizes(&still, 1.0, &mut sizes);
        structure.largest_stiffness = sizes.into_iter().fold(0.0, f64::max);
        match other.filter(|other| other.layout.is_some() && other.has_places_of(&structure)) {
            Some(other) => structure.layout.clone_from(&other.layout),
            None => structure.set_sparse(structure.unknowns() > MOST_DENSE),
        }
        structure
    }

    /// The structure with the same nodes, supports and couplings, and with more elements.
    pub fn with_elements(&self, more: &ElementList) -> Self {
        let held = (0..self.freedoms()).filter(|freedom| self.unknown_of[*freedom].is_none());
        let supports: Vec<(usize, usize)> = held.map(|freedom| self.numbering.node_of(freedom)).collect();
        let mut elements = self.elements.clone();
        elements.append(more);
        let mut structure = Self::new(self.dimension, self.numbering.nodes(), &supports, elements);
        if !self.couplings.is_empty() {
            structure.couple(self.couplings.clone());
        }
        structure
    }

    fn set_elements(&mut self, elements: ElementList) {
        let mut first_at = vec![0; self.numbering.nodes() + 1];
        elements.iter().flat_map(|element| element.nodes()).for_each(|node| first_at[node + 1] += 1);
        (1..first_at.len()).for_each(|node| first_at[node] += first_at[node - 1]);
        let mut next = first_at.clone();
        let mut elements_at = vec![0; first_at.last().copied().unwrap_or(0)];
        for (index, element) in elements.iter().enumerate() {
            for (place, node) in element.nodes().iter().enumerate() {
                elements_at[next[*node]] = index;
                next[*node] += 1;
                self.element_freedoms.extend(self.numbering.translations_of(*node));
                let rotations = self.numbering.rotations_of(*node).skip(element.first_rotation_at(place));
                self.element_freedoms.extend(rotations.take(element.rotations()));
            }
            self.first_freedom.push(self.element_freedoms.len());
        }
        (self.elements, self.elements_at, self.first_at) = (elements, elements_at, first_at);
    }

    /// Measures the rotations in space from those at the given displacements from now on; a displacement vector of before
    /// is expressed anew by [`TurningNodes`].
    pub fn refer(&mut self, displacement: &[f64]) {
        let totals = self.turning.totals(displacement).into_owned();
        self.refer_to(&totals);
    }

    /// Measures the rotations in space from the given total rotation vectors, over all degrees of freedom.
    pub fn refer_to(&mut self, totals: &[f64]) {
        let references = self.turning.refer_to(totals);
        let gathered: Vec<f64> = self.element_freedoms.iter().map(|freedom| references[*freedom]).collect();
        self.elements.refer(&gathered, |element| assembly::size_of(element, self.dimension));
    }

    /// Adds entries to the layout of the tangent for degrees of freedom that are coupled otherwise than by elements;
    /// each coupling is of every node of one list with every node of another.
    pub fn couple(&mut self, couplings: Vec<[Vec<usize>; 2]>) {
        self.couplings = couplings;
        self.set_sparse(self.layout.is_some());
    }

    /// Whether the entries of both tangents have the same positions and the same order.
    fn has_places_of(&self, other: &Self) -> bool {
        self.numbering == other.numbering
            && self.unknown_of == other.unknown_of
            && self.first_freedom == other.first_freedom
            && self.element_freedoms == other.element_freedoms
            && self.couplings == other.couplings
            && self
                .elements
                .iter()
                .zip(other.elements.iter())
                .all(|(one, other)| one.nodes().len() == other.nodes().len())
    }

    /// The degrees of freedom of a node's translations.
    #[inline(always)]
    pub fn translations_of(&self, node: usize) -> Range<usize> {
        self.numbering.translations_of(node)
    }

    /// All degrees of freedom of a node.
    pub fn freedoms_of(&self, node: usize) -> Range<usize> {
        self.numbering.freedoms_of(node)
    }

    /// A node's translations in a vector over all degrees of freedom; in 2D the third component is 0.
    #[inline(always)]
    pub fn translation_at(&self, node: usize, values: &[f64]) -> [f64; 3] {
        match values[self.translations_of(node)] {
            [x, y] => [x, y, 0.0],
            [x, y, z] => [x, y, z],
            _ => [0.0; 3],
        }
    }

    /// The translations of all nodes, node by node, of a vector over all degrees of freedom.
    pub fn translations<'a>(&self, values: &'a [f64]) -> Cow<'a, [f64]> {
        if self.dimension * self.numbering.nodes() == self.freedoms() {
            return Cow::Borrowed(values);
        }
        (0..self.numbering.nodes()).flat_map(|node| &values[self.translations_of(node)]).copied().collect()
    }

    /// The elements, each with the degrees of freedom that it joins.
    pub fn elements(&self) -> impl Iterator<Item = ElementAt<'_>> {
        (0..self.elements.len()).map(|index| self.element(index))
    }

    fn element(&self, index: usize) -> ElementAt<'_> {
        let (run, place) = self.elements.place(index);
        ElementAt::new(run, place, &self.element_freedoms[self.first_freedom[index]..self.first_freedom[index + 1]])
    }

    /// The elements in blocks of one kind.
    fn blocks(&self) -> impl Iterator<Item = ElementBlock<'_>> {
        assembly::blocks(&self.elements, self.dimension, &self.element_freedoms)
    }

    /// Whether an element has forces that are variables of the iteration: see [`mixed_iteration`].
    pub fn has_independent_forces(&self) -> bool {
        self.independent_forces
    }

    /// Whether some elements stand for loads: see [`following_loads`].
    pub fn has_following_loads(&self) -> bool {
        self.following_loads
    }

    /// Whether the forces of all elements are linear in the displacements.
    pub fn is_linear(&self) -> bool {
        self.elements.iter().all(|element| element.is_linear())
    }

    /// Whether the forces of all elements that resist are linear in the displacements; loads may follow the structure.
    pub fn resists_linearly(&self) -> bool {
        self.elements.iter().all(|element| element.is_load() || element.is_linear())
    }

    /// Makes matrices sparse or dense; they stay dense where memory does not suffice to find the layout.
    pub fn set_sparse(&mut self, sparse: bool) {
        self.layout = if sparse { Layout::new(self).map(Arc::new) } else { None };
        if self.layout.is_none() {
            // Whether a dense matrix fits into memory is checked now, not only when it is formed.
            drop(crate::resources::budget::take::<f64>(self.unknowns().saturating_mul(self.unknowns())));
        }
    }

    /// Whether dense matrices of this size may be formed.
    pub fn allows_dense(&self) -> bool {
        self.unknowns() <= MOST_ANALYSED
    }

    /// The positions of the tangent's entries; `None` where matrices are dense.
    pub fn layout(&self) -> Option<&Layout> {
        self.layout.as_deref()
    }

    /// Number of unknown displacements.
    pub fn unknowns(&self) -> usize {
        self.freedom_of.len()
    }

    /// Number of degrees of freedom, supported ones included.
    pub fn freedoms(&self) -> usize {
        self.unknown_of.len()
    }

    /// Writes `f_int(u)` over all degrees of freedom and returns the largest force that any element carries.
    pub fn internal_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        self.internal_force_beyond(displacement, &[], force)
    }

    /// As [`internal_force`](Self::internal_force), at displacements with what their rounding left; no `remainder` stands
    /// for none.
    pub fn internal_force_beyond(&self, displacement: &[f64], remainder: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let mut buffer = ForceBuffer::default();
        let mut add = |freedom: usize, value: f64| force[freedom] += value;
        self.blocks().fold(0.0, |largest: f64, block| {
            largest.max(if remainder.is_empty() || !block.is_of_relative_positions() {
                block.each_force(displacement, &mut buffer, &mut add)
            } else {
                block.each_force_beyond(self.dimension, displacement, remainder, &mut buffer, &mut add)
            })
        })
    }

    /// Whether the rounding of displacements causes forces that matter, as in a beam of many short elements. A state then
    /// keeps what rounding leaves ([`State::remainder`](crate::mechanics::problem::state::State::remainder)).
    pub fn keeps_remainders(&self) -> bool {
        f64::EPSILON * self.largest_stiffness > ROUNDING_THAT_MATTERS
    }

    /// Writes `f_int(u)` over all degrees of freedom with moments in global axes in space, where otherwise they are
    /// derivatives by the components of rotation vectors.
    pub fn internal_forces_in_global_axes(&self, displacement: &[f64], force: &mut [f64]) {
        if self.dimension == 2 || !self.elements.iter().any(|element| element.rotations() > 0) {
            self.internal_force(displacement, force);
            return;
        }
        let (all, totals) = self.turning.all_placed(&self.numbering, displacement);
        let mut placed = Self { turning: all, ..self.clone() };
        placed.refer(displacement);
        placed.internal_force(&totals, force);
    }

    /// The force that an element carries, by the element's place in the input.
    pub fn resultants(&self, element: usize, displacement: &[f64]) -> Option<Resultants> {
        let at = self.element(element);
        let own: SmallVec<[f64; 12]> = at.freedoms.iter().map(|freedom| displacement[*freedom]).collect();
        at.element.resultants(&own)
    }

    /// A bound on the rounding of the displacements in `f_int(u)`, one value per degree of freedom: stiffness times
    /// unit round-off times the displacements that meet there. No state can be closer to equilibrium than this bound.
    pub fn rounding(&self, displacement: &[f64]) -> Vec<f64> {
        let mut rounding = vec![0.0; self.freedoms()];
        self.force_sizes(displacement, 0.0, &mut rounding);
        rounding.iter_mut().for_each(|size| *size *= f64::EPSILON);
        rounding
    }

    /// The largest of a bound on the rounding in `f_int(u)`, by the largest displacement and the stiffest element.
    pub fn largest_rounding(&self, displacement: &[f64]) -> f64 {
        let reach = displacement.iter().fold(0.0_f64, |reach, value| reach.max(value.abs()));
        f64::EPSILON * self.largest_stiffness * reach
    }

    /// Writes the size of the terms that make up `f_int(u)`, one per degree of freedom: `|K| |u|` and the forces that
    /// the elements carry, with displacements of at least `least`. A residual is small or not relative to this size,
    /// whatever the forces elsewhere (W. Oettli, W. Prager, Numer. Math. 6 (1964) 405, doi:10.1007/BF01386090).
    pub fn force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        sizes.fill(0.0);
        let mut buffer = ForceBuffer::default();
        for block in self.blocks() {
            block.each_force_size(displacement, least, &mut buffer, |freedom, size| sizes[freedom] += size);
        }
    }

    /// The largest of the [`force_sizes`](Self::force_sizes) of a node's translations.
    pub fn force_size_at(&self, node: usize, displacement: &[f64], least: f64) -> f64 {
        let first = self.translations_of(node).start;
        let (mut sizes, mut buffer) = ([0.0; 3], ForceBuffer::default());
        for element in &self.elements_at[self.first_at[node]..self.first_at[node + 1]] {
            self.element(*element).alone().each_force_size(displacement, least, &mut buffer, |freedom, size| {
                if let Some(sum) = freedom.checked_sub(first).and_then(|component| sizes.get_mut(component)) {
                    *sum += size;
                }
            });
        }
        sizes[..self.dimension].iter().fold(0.0, |largest, size| size.max(largest))
    }

    /// Calls `add(row, column, value)` for every entry of every element's tangent; rows and columns are degrees of
    /// freedom, supported ones included.
    pub fn each_stiffness(&self, displacement: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        let mut buffer = StiffnessBuffer::default();
        self.blocks().for_each(|block| block.each_stiffness(displacement, &mut buffer, add));
    }

    /// Turns `add(row, column, value)` over unknowns into the same over degrees of freedom. Rows of supports are left
    /// out; a column of a support goes to the load factor's column, `unknowns()`, times the rate at which the load
    /// factor moves the support.
    #[inline(always)]
    pub fn over_unknowns(
        &self,
        support_rate: impl Fn(usize) -> f64,
        mut add: impl FnMut(usize, usize, f64),
    ) -> impl FnMut(usize, usize, f64) {
        move |row, column, value| {
            let Some(row) = self.unknown_of[row] else { return };
            match self.unknown_of[column] {
                Some(column) => add(row, column, value),
                None => add(row, self.unknowns(), value * support_rate(column)),
            }
        }
    }

    /// Adds `K(u) v` to forces on all degrees of freedom, `v` a motion of all degrees of freedom.
    pub fn add_stiffness_times(&self, displacement: &[f64], motion: &[f64], forces: &mut [f64]) {
        self.each_stiffness(displacement, &mut |row, column, value| forces[row] += value * motion[column]);
    }

    /// `f_int(u)` and `K(u) v` over all degrees of freedom, `v` a motion of all of them, right at those asked for: from
    /// the elements that join one of these alone.
    pub fn forces_where(
        &self,
        displacement: &[f64],
        motion: &[f64],
        is_asked: impl Fn(usize) -> bool + Copy,
    ) -> [Vec<f64>; 2] {
        let (mut forces, mut changes) = (vec![0.0; self.freedoms()], vec![0.0; self.freedoms()]);
        let (mut of_forces, mut of_stiffness) = (ForceBuffer::default(), StiffnessBuffer::default());
        for block in self.blocks().filter(|block| block.joins(is_asked)) {
            block.each_force(displacement, &mut of_forces, |freedom, value| forces[freedom] += value);
            let mut add = |row: usize, column: usize, value: f64| changes[row] += value * motion[column];
            block.each_stiffness(displacement, &mut of_stiffness, &mut add);
        }
        [forces, changes]
    }

    /// Adds `K(u)` into the leading `unknowns x unknowns` block.
    pub fn add_tangent(&self, displacement: &[f64], matrix: &mut DMatrix<f64>) {
        self.each_stiffness(displacement, &mut |row, column, value| {
            if let (Some(row), Some(column)) = (self.unknown_of[row], self.unknown_of[column]) {
                matrix[(row, column)] += value;
            }
        });
    }

    /// Calls `add` for every entry of every element's tangent without the summands that [`Self::stretching`] lists.
    pub fn each_stiffness_across(&self, displacement: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        let mut buffer = StiffnessBuffer::default();
        self.blocks().for_each(|block| block.each_stiffness_across(displacement, &mut buffer, add));
    }

    /// The summands `k c cᵀ` of the tangent by which elements resist stretching, `c` over degrees of freedom.
    pub fn stretching(&self, displacement: &[f64]) -> Vec<Stretching> {
        self.elements().flat_map(|element| element.stretching(displacement)).collect()
    }

    /// The smallest stretch `L/L0` of the elements that may shrink to a point; infinite where there are none.
    pub fn smallest_stretch(&self, displacement: &[f64]) -> f64 {
        let mut buffer = ForceBuffer::default();
        self.elements().filter_map(|element| element.stretch(displacement, &mut buffer)).fold(f64::INFINITY, f64::min)
    }

    /// The strain energy `W(u)`.
    pub fn strain_energy(&self, displacement: &[f64]) -> f64 {
        let mut buffer = ForceBuffer::default();
        let mut sum = 0.0;
        self.blocks().for_each(|block| block.each_energy(displacement, &mut buffer, |energy| sum += energy));
        sum
    }

    /// The largest change of any element's nodal forces under a displacement rate, over its stiffness times the rate's
    /// size: zero for a motion that no element resists. The stiffness is the largest of the element; for a linear
    /// element it is the largest of the row, since the user prescribes the rows, and a soft row beside a stiff one is
    /// no round-off. Of elements that share nodes and move together as a rigid body, the sum of the changes counts.
    pub fn resistance(&self, displacement: &[f64], rate: &[f64]) -> f64 {
        resistance::resistance(self, displacement, rate)
    }
}
