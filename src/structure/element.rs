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

    /// Adds what the rounding of the displacements puts into the element's nodal forces.
    pub fn add_rounding(&self, structure: &Structure, displacement: &[f64], rounding: &mut [f64]) {
        match self {
            Self::Bar(bar) => bar.add_rounding(structure, displacement, rounding),
            Self::Spring(spring) => spring.add_rounding(structure, displacement, rounding),
        }
    }

    /// Calls `add(row, column, value)` for every entry of the element's tangent, rows and columns being degrees of
    /// freedom.
    pub fn add_stiffness(&self, structure: &Structure, displacement: &[f64], add: &mut dyn FnMut(usize, usize, f64)) {
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
        add: &mut dyn FnMut(usize, usize, f64),
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
