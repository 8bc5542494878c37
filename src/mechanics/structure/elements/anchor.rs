//! A spring between a node and a fixed place, the same along each degree of freedom that it holds: `f = k (q - a)`,
//! `W = ½ k |q - a|²`.
//!
//! Damping and inertia in an implicit time step act as such a spring, whose place and stiffness belong to the step.

use crate::mechanics::structure::elements::FiniteElement;
use smallvec::SmallVec;

#[derive(Debug, Clone)]
pub struct Anchor {
    node: [usize; 1],
    /// Number of the node's rotations that are held, too.
    rotations: usize,
    /// Stiffness and place, one pair for each degree of freedom; no stiffness along one that is not held.
    held: SmallVec<[(f64, f64); 3]>,
}

impl Anchor {
    /// A spring on a node's translations and its first rotations: stiffness and place of each degree of freedom.
    pub fn new(node: usize, rotations: usize, held: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self { node: [node], rotations, held: held.into_iter().collect() }
    }
}

impl FiniteElement for Anchor {
    fn nodes(&self) -> &[usize] {
        &self.node
    }

    fn rotations(&self) -> usize {
        self.rotations
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        let held = self.held.iter().zip(displacement);
        held.map(|((stiffness, place), value)| 0.5 * stiffness * (value - place) * (value - place)).sum()
    }

    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        let mut largest = 0.0_f64;
        for (force, ((stiffness, place), value)) in force.iter_mut().zip(self.held.iter().zip(displacement)) {
            *force = stiffness * (value - place);
            largest = largest.max(force.abs());
        }
        largest
    }

    fn write_stiffness(&self, _displacement: &[f64], stiffness: &mut [f64]) {
        stiffness.fill(0.0);
        let size = self.held.len();
        self.held.iter().enumerate().for_each(|(row, (value, _))| stiffness[row * size + row] = *value);
    }

    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        for (size, ((stiffness, place), value)) in sizes.iter_mut().zip(self.held.iter().zip(displacement)) {
            *size = stiffness * value.abs().max(place.abs()).max(least);
        }
    }

    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        self.held.iter().fold(0.0, |most, (stiffness, _)| stiffness.max(most))
    }

    fn is_linear(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_the_derivative_of_the_energy_and_vanishes_at_the_place() {
        let anchor = Anchor::new(0, 1, [(2.0, 0.5), (0.0, 7.0), (3.0, -1.0)]);
        let at = [1.0, 4.0, 0.25];
        let mut force = [0.0; 3];
        assert_eq!(anchor.write_force(&at, &mut force), 3.75);
        assert_eq!(force, [1.0, 0.0, 3.75]);
        for (k, force) in force.iter().enumerate() {
            let moved = |by: f64| {
                let mut place = at;
                place[k] += by;
                anchor.energy(&place)
            };
            assert!(((moved(1e-4) - moved(-1e-4)) / 2e-4 - force).abs() < 1e-10);
        }
        assert_eq!(anchor.write_force(&[0.5, 0.0, -1.0], &mut [0.0; 3]), 0.0);
    }
}
