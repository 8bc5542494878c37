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

    /// The relative displacement `Δu`; the components of other dimensions are 0.
    #[inline(always)]
    fn relative(&self, displacement: &[f64]) -> [f64; 3] {
        let mut relative = [0.0; 3];
        let (own, other) = displacement.split_at(displacement.len() / self.nodes.len());
        relative.iter_mut().zip(own).for_each(|(relative, own)| *relative = *own);
        relative.iter_mut().zip(other).for_each(|(relative, other)| *relative -= other);
        relative
    }

    /// The forces `K Δu`; those of other dimensions are 0, as there is no stiffness there.
    #[inline(always)]
    fn forces(&self, relative: &[f64; 3]) -> [f64; 3] {
        self.stiffness.map(|row| row[0] * relative[0] + row[1] * relative[1] + row[2] * relative[2])
    }

    /// Writes the tangent in a space of `D` dimensions.
    #[inline(always)]
    fn write_stiffness_in<const D: usize>(&self, stiffness: &mut [f64]) {
        if !self.has_two_nodes() {
            let rows = stiffness.chunks_exact_mut(D).zip(&self.stiffness);
            return rows.for_each(|(values, row)| values.copy_from_slice(&row[..D]));
        }
        let (upper, lower) = stiffness.split_at_mut(2 * D * D);
        let rows = upper.chunks_exact_mut(2 * D).zip(lower.chunks_exact_mut(2 * D)).zip(&self.stiffness);
        for ((upper, lower), row) in rows {
            for column in 0..D {
                (upper[column], upper[D + column]) = (row[column], -row[column]);
                (lower[column], lower[D + column]) = (-row[column], row[column]);
            }
        }
    }

    /// Writes the sizes of forces in a space of `D` dimensions.
    #[inline(always)]
    fn write_force_sizes_in<const D: usize>(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        let (own, other) = displacement.split_at(D);
        let motions: [f64; D] = std::array::from_fn(|component| {
            let other = other.get(component).map_or(least, |value| value.abs());
            own[component].abs().max(other).max(least)
        });
        for sizes in sizes.chunks_exact_mut(D) {
            for (size, stiffness) in sizes.iter_mut().zip(&self.stiffness) {
                *size = (0..D).map(|column| stiffness[column].abs() * motions[column]).sum();
            }
        }
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
        let (own, other) = force.split_at_mut(force.len() / self.nodes.len());
        own.iter_mut().zip(&forces).for_each(|(force, value)| *force = *value);
        other.iter_mut().zip(&forces).for_each(|(force, value)| *force = -value);
        forces.iter().fold(0.0, |largest, value| largest.max(value.abs()))
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        Some(Resultants::Force(self.forces(&self.relative(displacement))))
    }

    #[inline(always)]
    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        // The number of dimensions is known to the compiler.
        match displacement.len() / self.nodes.len() {
            2 => self.write_stiffness_in::<2>(stiffness),
            _ => self.write_stiffness_in::<3>(stiffness),
        }
    }

    /// The force due to displacements of this size.
    #[inline(always)]
    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        match displacement.len() / self.nodes.len() {
            2 => self.write_force_sizes_in::<2>(displacement, least, sizes),
            _ => self.write_force_sizes_in::<3>(displacement, least, sizes),
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
