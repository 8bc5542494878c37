//! The kinds of elements, and what each must be able to do.

pub mod bar;
pub mod spring;

use crate::mechanics::structure::elements::bar::Bar;
use crate::mechanics::structure::elements::spring::Spring;

/// One element.
#[derive(Debug, Clone)]
pub enum Element {
    Bar(Bar),
    Spring(Spring),
}

impl Element {
    /// Adds the element's nodal forces (gradient of its energy) and returns the size of the force it carries.
    pub fn add_force(&self, dimension: usize, displacement: &[f64], force: &mut [f64]) -> f64 {
        match self {
            Self::Bar(bar) => bar.add_force(dimension, displacement, force),
            Self::Spring(spring) => spring.add_force(dimension, displacement, force),
        }
    }

    /// Calls `add(freedom, size)` with the size of the numbers that the element's nodal forces are made of: stiffness times
    /// displacements as they are (`least` at least), not their differences, and the force carried.
    pub fn each_size(&self, dimension: usize, displacement: &[f64], least: f64, add: &mut impl FnMut(usize, f64)) {
        match self {
            Self::Bar(bar) => bar.each_size(dimension, displacement, least, add),
            Self::Spring(spring) => spring.each_size(dimension, displacement, least, add),
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
    pub fn add_stiffness(&self, dimension: usize, displacement: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        match self {
            Self::Bar(bar) => bar.add_stiffness(dimension, displacement, add),
            Self::Spring(spring) => spring.add_stiffness(dimension, add),
        }
    }

    /// The element's tangent without what [`Self::stretching`] lists.
    pub fn add_stiffness_across(
        &self,
        dimension: usize,
        displacement: &[f64],
        add: &mut impl FnMut(usize, usize, f64),
    ) {
        match self {
            Self::Bar(bar) => bar.add_stiffness_across(dimension, displacement, add),
            Self::Spring(spring) if spring.other.is_some() => {}
            Self::Spring(spring) => spring.add_stiffness(dimension, add),
        }
    }

    /// The summands `k c cᵀ` of the tangent by which the element resists being stretched; none for springs to the ground.
    pub fn stretching(&self, dimension: usize, displacement: &[f64]) -> Vec<Stretching> {
        match self {
            Self::Bar(bar) => bar.stretching(dimension, displacement).into_iter().collect(),
            Self::Spring(spring) => spring.stretching(dimension),
        }
    }

    /// Strain energy.
    pub fn energy(&self, dimension: usize, displacement: &[f64]) -> f64 {
        match self {
            Self::Bar(bar) => bar.energy(dimension, displacement),
            Self::Spring(spring) => spring.energy(dimension, displacement),
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

/// A summand `k c cᵀ` of the tangent: the stiffness `k` against motions along `c`.
#[derive(Debug, Clone)]
pub struct Stretching {
    /// Not zero.
    pub stiffness: f64,
    /// Entries of `c`, one a degree of freedom.
    pub along: Vec<(usize, f64)>,
}
