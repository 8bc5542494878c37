//! A constant symmetric stiffness matrix between a node and the ground, or between two nodes: `f = K Δu`,
//! `W = ½ Δuᵀ K Δu`. The spring does not follow rotations.

use crate::mechanics::structure::elements::{FiniteElement, Resultants, Stretching};
use nalgebra::DMatrix;
use smallvec::SmallVec;

#[derive(Debug, Clone)]
pub struct Spring {
    /// One node, connected to the ground, or two.
    nodes: SmallVec<[usize; 2]>,
    /// The leading `dimension x dimension` block is used.
    stiffness: [[f64; 3]; 3],
}

impl Spring {
    /// A spring between a node and the ground.
    pub fn to_ground(node: usize, stiffness: [[f64; 3]; 3]) -> Self {
        Self { nodes: SmallVec::from_slice(&[node]), stiffness }
    }

    /// A spring between two nodes.
    pub fn between(nodes: [usize; 2], stiffness: [[f64; 3]; 3]) -> Self {
        Self { nodes: SmallVec::from_slice(&nodes), stiffness }
    }

    fn has_two_nodes(&self) -> bool {
        self.nodes.len() > 1
    }

    /// The relative displacement `Δu`, with as many components as the space has dimensions.
    fn relative(&self, displacement: &[f64]) -> SmallVec<[f64; 3]> {
        let (own, other) = displacement.split_at(displacement.len() / self.nodes.len());
        match self.has_two_nodes() {
            true => own.iter().zip(other).map(|(own, other)| own - other).collect(),
            false => SmallVec::from_slice(own),
        }
    }

    fn forces(&self, relative: &[f64]) -> SmallVec<[f64; 3]> {
        let force = |row: &[f64; 3]| row.iter().zip(relative).map(|(stiffness, motion)| stiffness * motion).sum();
        self.stiffness.iter().take(relative.len()).map(force).collect()
    }
}

impl FiniteElement for Spring {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        let relative = self.relative(displacement);
        let forces = self.forces(&relative);
        0.5 * relative.iter().zip(&forces).map(|(motion, force)| motion * force).sum::<f64>()
    }

    #[inline(always)]
    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        let forces = self.forces(&self.relative(displacement));
        let (own, other) = force.split_at_mut(forces.len());
        own.copy_from_slice(&forces);
        other.iter_mut().zip(&forces).for_each(|(force, value)| *force = -value);
        forces.iter().fold(0.0, |largest, value| largest.max(value.abs()))
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        let mut force = [0.0; 3];
        force.iter_mut().zip(self.forces(&self.relative(displacement))).for_each(|(own, value)| *own = value);
        Some(Resultants::Force(force))
    }

    #[inline(always)]
    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        let size = displacement.len();
        let dimension = size / self.nodes.len();
        for (row, values) in stiffness.chunks_exact_mut(size).enumerate() {
            for (column, value) in values.iter_mut().enumerate() {
                let sign = if row / dimension == column / dimension { 1.0 } else { -1.0 };
                *value = sign * self.stiffness[row % dimension][column % dimension];
            }
        }
    }

    /// The force due to displacements of this size.
    #[inline(always)]
    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        let dimension = displacement.len() / self.nodes.len();
        let (own, other) = displacement.split_at(dimension);
        let size = |component: usize| {
            let other = other.get(component).map_or(least, |value| value.abs());
            own[component].abs().max(other).max(least)
        };
        for (row, force) in sizes.iter_mut().enumerate() {
            let stiffness = &self.stiffness[row % dimension];
            *force = (0..dimension).map(|column| stiffness[column].abs() * size(column)).sum();
        }
    }

    /// The stiffness against the motion.
    fn axial_stiffness(&self, motion: &[f64]) -> f64 {
        let moved = self.relative(motion);
        let size = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        let moved_by = size(&moved);
        if moved_by > 0.0 { size(&self.forces(&moved)) / moved_by } else { 0.0 }
    }

    fn is_linear(&self) -> bool {
        true
    }

    /// Between two nodes `K = Σ k v vᵀ` over its eigenvectors, each with a summand of its own.
    fn stretching(&self, displacement: &[f64]) -> Vec<Stretching> {
        if !self.has_two_nodes() {
            return Vec::new();
        }
        let dimension = displacement.len() / 2;
        let matrix = DMatrix::from_fn(dimension, dimension, |row, column| self.stiffness[row][column]);
        let eigen = matrix.symmetric_eigen();
        let along = |vector: usize| {
            let entry = |freedom: usize| {
                let sign = if freedom < dimension { 1.0 } else { -1.0 };
                (freedom, sign * eigen.eigenvectors[(freedom % dimension, vector)])
            };
            (0..2 * dimension).map(entry).collect()
        };
        let resists = |vector: &usize| eigen.eigenvalues[*vector] != 0.0;
        (0..dimension)
            .filter(resists)
            .map(|vector| Stretching { stiffness: eigen.eigenvalues[vector], along: along(vector) })
            .collect()
    }

    #[inline(always)]
    fn write_stiffness_across(&self, displacement: &[f64], stiffness: &mut [f64]) {
        if self.has_two_nodes() {
            stiffness.fill(0.0);
        } else {
            self.write_stiffness(displacement, stiffness);
        }
    }
}
