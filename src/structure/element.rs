//! The kinds of elements, and what each must be able to do.

use super::{Stretching, Structure, bar::Bar, spring::Spring};

/// One element.
#[derive(Debug, Clone)]
pub enum Element {
    Bar(Bar),
    Spring(Spring),
}

impl Element {
    /// Adds the element's nodal forces (gradient of its energy) and returns the size of the force it carries.
    pub fn add_force(&self, structure: &Structure, displacement: &[f64], force: &mut [f64]) -> f64 {
        match self {
            Self::Bar(bar) => bar.add_force(structure, displacement, force),
            Self::Spring(spring) => spring.add_force(structure, displacement, force),
        }
    }

    /// Calls `add(freedom, size)` with the size of the numbers that the element's nodal forces are made of: stiffness times
    /// displacements as they are (`least` at least), not their differences, and the force carried.
    pub fn each_size(&self, structure: &Structure, displacement: &[f64], least: f64, add: &mut impl FnMut(usize, f64)) {
        match self {
            Self::Bar(bar) => bar.each_size(structure, displacement, least, add),
            Self::Spring(spring) => spring.each_size(structure, displacement, least, add),
        }
    }

    /// The nodes it joins, one or two.
    pub fn nodes(&self) -> impl Iterator<Item = usize> {
        let (first, second) = match self {
            Self::Bar(bar) => (bar.nodes[0], Some(bar.nodes[1])),
            Self::Spring(spring) => (spring.node, spring.other),
        };
        std::iter::once(first).chain(second)
    }

    /// Calls `add(row, column, value)` for every entry of the element's tangent, rows and columns being degrees of
    /// freedom.
    pub fn add_stiffness(&self, structure: &Structure, displacement: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        match self {
            Self::Bar(bar) => bar.add_stiffness(structure, displacement, add),
            Self::Spring(spring) => spring.add_stiffness(structure, add),
        }
    }

    /// The element's tangent without what [`Self::stretching`] lists.
    pub fn add_stiffness_across(
        &self,
        structure: &Structure,
        displacement: &[f64],
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        match self {
            Self::Bar(bar) => bar.add_stiffness_across(structure, displacement, add),
            Self::Spring(spring) if spring.other.is_some() => {}
            Self::Spring(spring) => spring.add_stiffness(structure, add),
        }
    }

    /// The summands `k c cᵀ` of the tangent by which the element resists being stretched; none for springs to the ground.
    pub fn stretching(&self, structure: &Structure, displacement: &[f64]) -> Vec<Stretching> {
        match self {
            Self::Bar(bar) => bar.stretching(structure, displacement).into_iter().collect(),
            Self::Spring(spring) => spring.stretching(structure),
        }
    }

    /// Strain energy.
    pub fn energy(&self, structure: &Structure, displacement: &[f64]) -> f64 {
        match self {
            Self::Bar(bar) => bar.energy(structure, displacement),
            Self::Spring(spring) => spring.energy(structure, displacement),
        }
    }

    /// Whether the nodal forces are linear in the displacements.
    pub fn is_linear(&self) -> bool {
        match self {
            Self::Bar(_) => false,
            Self::Spring(_) => true,
        }
    }
}
