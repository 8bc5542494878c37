//! Structures of solid elements, solved by Newton's method with a band of equations.

use super::meshes::{Mesh, element};
use crate::mechanics::structure::elements::FiniteElement;
use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, LockingMend};
use std::sync::Arc;

pub struct Solids {
    pub elements: Vec<Box<dyn FiniteElement>>,
    pub dimension: usize,
    pub freedoms: usize,
    band: usize,
}

/// External forces and their derivatives by the displacements, as row, column and value.
#[derive(Default)]
pub struct External {
    pub forces: Vec<f64>,
    pub slopes: Vec<(usize, usize, f64)>,
}

/// A matrix whose entries lie near the diagonal.
struct Band {
    width: usize,
    rows: Vec<Vec<f64>>,
}

impl Band {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row][column + self.width - row] += value;
    }

    /// The solution by elimination without exchanges.
    fn solve(mut self, mut right: Vec<f64>) -> Vec<f64> {
        let (size, width) = (right.len(), self.width);
        for pivot in 0..size {
            let (above, below) = self.rows.split_at_mut(pivot + 1);
            let own = &above[pivot];
            let length = width.min(size - 1 - pivot);
            for (offset, row) in below.iter_mut().take(length).enumerate() {
                let start = width - 1 - offset;
                let factor = row[start] / own[width];
                if factor != 0.0 {
                    let entries = row[start..=start + length].iter_mut().zip(&own[width..=width + length]);
                    entries.for_each(|(entry, value)| *entry -= factor * value);
                    right[pivot + 1 + offset] -= factor * right[pivot];
                }
            }
        }
        for pivot in (0..size).rev() {
            let row = &self.rows[pivot];
            let known: f64 = (1..=width.min(size - 1 - pivot)).map(|k| row[width + k] * right[pivot + k]).sum();
            right[pivot] = (right[pivot] - known) / row[width];
        }
        right
    }
}

impl Solids {
    pub fn new(
        mesh: &Mesh,
        idealisation: Idealisation,
        material: &Arc<dyn ElasticMaterial>,
        mend: Option<LockingMend>,
    ) -> Self {
        let dimension = mesh.kind.dimension();
        let of = |nodes: &Vec<usize>| element(mesh.kind, nodes, &mesh.positions, idealisation, material, mend).unwrap();
        let spread = |nodes: &Vec<usize>| nodes.iter().max().unwrap() - nodes.iter().min().unwrap();
        let band = (mesh.elements.iter().map(spread).max().unwrap() + 1) * dimension;
        let elements = mesh.elements.iter().map(of).collect();
        Self { elements, dimension, freedoms: mesh.positions.len() * dimension, band }
    }

    /// The degrees of freedom of an element.
    pub fn freedoms_of<'a>(&'a self, element: &'a dyn FiniteElement) -> impl Iterator<Item = usize> + 'a {
        element.nodes().iter().flat_map(move |node| (0..self.dimension).map(move |axis| node * self.dimension + axis))
    }

    pub fn own(&self, element: &dyn FiniteElement, values: &[f64]) -> Vec<f64> {
        self.freedoms_of(element).map(|freedom| values[freedom]).collect()
    }

    pub fn forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.freedoms];
        for element in &self.elements {
            let own = self.own(element.as_ref(), displacement);
            let mut of_element = vec![0.0; own.len()];
            element.write_force(&own, &mut of_element);
            self.freedoms_of(element.as_ref()).zip(of_element).for_each(|(freedom, value)| forces[freedom] += value);
        }
        forces
    }

    fn stiffness(&self, displacement: &[f64]) -> Band {
        let mut matrix = Band { width: self.band, rows: vec![vec![0.0; 2 * self.band + 1]; self.freedoms] };
        for element in &self.elements {
            let own = self.own(element.as_ref(), displacement);
            let mut of_element = vec![0.0; own.len() * own.len()];
            element.write_stiffness(&own, &mut of_element);
            for (row, values) in self.freedoms_of(element.as_ref()).zip(of_element.chunks(own.len())) {
                self.freedoms_of(element.as_ref())
                    .zip(values)
                    .for_each(|(column, value)| matrix.add(row, column, *value));
            }
        }
        matrix
    }

    /// The tangent over some degrees of freedom, row by row.
    pub fn dense_stiffness(&self, displacement: &[f64], free: &[usize]) -> Vec<f64> {
        let matrix = self.stiffness(displacement);
        let entry = |row: usize, column: usize| {
            let is_near = row.abs_diff(column) <= self.band;
            if is_near { matrix.rows[row][column + self.band - row] } else { 0.0 }
        };
        let row_of = |row: &usize| -> Vec<f64> { free.iter().map(|column| entry(*row, *column)).collect() };
        free.iter().flat_map(row_of).collect()
    }

    /// Equilibrium under external forces that grow in steps; `held`: degrees of freedom and their displacements.
    pub fn solve(&self, held: &[(usize, f64)], external: &dyn Fn(&[f64]) -> External, steps: usize) -> Vec<f64> {
        let mut displacement = vec![0.0; self.freedoms];
        for step in 1..=steps {
            let factor = step as f64 / steps as f64;
            let mut is_converged = false;
            for _ in 0..30 {
                let mut matrix = self.stiffness(&displacement);
                let applied = external(&displacement);
                let internal = self.forces(&displacement);
                let mut right: Vec<f64> = applied.forces.iter().zip(&internal).map(|(a, b)| factor * a - b).collect();
                for (row, column, value) in applied.slopes {
                    matrix.add(row, column, -factor * value);
                }
                for (freedom, value) in held {
                    matrix.rows[*freedom].fill(0.0);
                    matrix.rows[*freedom][self.band] = 1.0;
                    right[*freedom] = factor * value - displacement[*freedom];
                }
                let change = matrix.solve(right);
                displacement.iter_mut().zip(&change).for_each(|(value, change)| *value += change);
                let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| value.abs().max(most));
                is_converged = largest(&change) <= 1e-10 * largest(&displacement);
                if is_converged {
                    break;
                }
            }
            assert!(is_converged, "Newton's method at the load factor {factor}");
        }
        displacement
    }
}

/// External forces that do not depend on the displacements.
pub fn dead(forces: Vec<f64>) -> impl Fn(&[f64]) -> External {
    move |_| External { forces: forces.clone(), slopes: Vec::new() }
}
