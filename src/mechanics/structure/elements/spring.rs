//! A constant symmetric stiffness matrix between a node and the ground, or between two nodes: `f = K Δu`,
//! `W = ½ Δuᵀ K Δu`. It does not follow rotation.

use crate::mechanics::structure::elements::Stretching;
use nalgebra::DMatrix;

#[derive(Debug, Clone)]
pub struct Spring {
    pub node: usize,
    /// The other end; the ground when absent.
    pub other: Option<usize>,
    /// The leading `dimension x dimension` block is used.
    pub stiffness: [[f64; 3]; 3],
}

impl Spring {
    fn relative(&self, dimension: usize, displacement: &[f64]) -> [f64; 3] {
        let mut relative = [0.0; 3];
        for (component, value) in relative.iter_mut().enumerate().take(dimension) {
            *value = displacement[self.node * dimension + component];
            if let Some(other) = self.other {
                *value -= displacement[other * dimension + component];
            }
        }
        relative
    }

    fn forces(&self, dimension: usize, relative: &[f64; 3]) -> [f64; 3] {
        let mut forces = [0.0; 3];
        for (force, row) in forces.iter_mut().zip(&self.stiffness).take(dimension) {
            *force = row.iter().zip(relative).take(dimension).map(|(stiffness, motion)| stiffness * motion).sum();
        }
        forces
    }

    pub fn add_force(&self, dimension: usize, displacement: &[f64], force: &mut [f64]) -> f64 {
        let forces = self.forces(dimension, &self.relative(dimension, displacement));
        let mut largest = 0.0_f64;
        for (component, value) in forces.iter().enumerate().take(dimension) {
            force[self.node * dimension + component] += value;
            if let Some(other) = self.other {
                force[other * dimension + component] -= value;
            }
            largest = largest.max(value.abs());
        }
        largest
    }

    pub fn add_stiffness(&self, dimension: usize, add: &mut impl FnMut(usize, usize, f64)) {
        let node = self.node * dimension;
        for row in 0..dimension {
            for column in 0..dimension {
                let value = self.stiffness[row][column];
                add(node + row, node + column, value);
                if let Some(other) = self.other {
                    let other = other * dimension;
                    add(other + row, other + column, value);
                    add(node + row, other + column, -value);
                    add(other + row, node + column, -value);
                }
            }
        }
    }

    /// Between two nodes `K = Σ k v vᵀ` over its eigenvectors, each a resistance of its own.
    pub fn stretching(&self, dimension: usize) -> Vec<Stretching> {
        let Some(other) = self.other else { return Vec::new() };
        let matrix = DMatrix::from_fn(dimension, dimension, |row, column| self.stiffness[row][column]);
        let eigen = matrix.symmetric_eigen();
        let along = |vector: usize| {
            let entry = |node: usize, component: usize, sign: f64| {
                (node * dimension + component, sign * eigen.eigenvectors[(component, vector)])
            };
            let ends = [(self.node, 1.0), (other, -1.0)];
            ends.into_iter()
                .flat_map(|(node, sign)| (0..dimension).map(move |component| entry(node, component, sign)))
                .collect()
        };
        let resists = |vector: &usize| eigen.eigenvalues[*vector] != 0.0;
        (0..dimension)
            .filter(resists)
            .map(|vector| Stretching { stiffness: eigen.eigenvalues[vector], along: along(vector) })
            .collect()
    }

    /// Calls `add(freedom, size)` with the force that displacements of this size make.
    pub fn each_size(&self, dimension: usize, displacement: &[f64], least: f64, add: &mut impl FnMut(usize, f64)) {
        let size = |component: usize| {
            let at = |node: usize| displacement[node * dimension + component].abs();
            at(self.node).max(self.other.map_or(least, at)).max(least)
        };
        for (row, stiffness) in self.stiffness.iter().enumerate().take(dimension) {
            let force: f64 = (0..dimension).map(|column| stiffness[column].abs() * size(column)).sum();
            for node in std::iter::once(self.node).chain(self.other) {
                add(node * dimension + row, force);
            }
        }
    }

    pub fn energy(&self, dimension: usize, displacement: &[f64]) -> f64 {
        let relative = self.relative(dimension, displacement);
        let forces = self.forces(dimension, &relative);
        0.5 * relative.iter().zip(&forces).map(|(motion, force)| motion * force).sum::<f64>()
    }
}
