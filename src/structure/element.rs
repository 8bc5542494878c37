//! The kinds of elements, and what each must be able to do.

use super::{Structure, bar::Bar, spring::Spring};

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

    /// Calls `add(row, column, value)` for every entry of the element's tangent, rows and columns being degrees of
    /// freedom.
    pub fn add_stiffness(&self, structure: &Structure, displacement: &[f64], add: &mut dyn FnMut(usize, usize, f64)) {
        match self {
            Self::Bar(bar) => bar.add_stiffness(structure, displacement, add),
            Self::Spring(spring) => spring.add_stiffness(structure, add),
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
