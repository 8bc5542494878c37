//! A constant stiffness against the rotation of a node, or against the difference of the rotations of two nodes, in the
//! plane: `M = k Δθ`, `W = ½ k Δθ²`.

use crate::mechanics::structure::elements::{FiniteElement, Resultants};
use smallvec::SmallVec;

/// Degrees of freedom of a node: two translations and a rotation.
const OF_NODE: usize = 3;

#[derive(Debug, Clone)]
pub struct RotationalSpring {
    /// One node, connected to the ground, or two.
    nodes: SmallVec<[usize; 2]>,
    /// Moment per angle.
    stiffness: f64,
}

impl RotationalSpring {
    /// A spring between a node and the ground, or between two nodes.
    pub fn new(nodes: &[usize], stiffness: f64) -> Self {
        Self { nodes: SmallVec::from_slice(nodes), stiffness }
    }

    /// The moment `k Δθ`.
    fn moment(&self, displacement: &[f64]) -> f64 {
        self.stiffness * (displacement[2] - displacement.get(OF_NODE + 2).copied().unwrap_or(0.0))
    }
}

impl FiniteElement for RotationalSpring {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn rotations(&self) -> usize {
        1
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        let turn = displacement[2] - displacement.get(OF_NODE + 2).copied().unwrap_or(0.0);
        0.5 * self.stiffness * turn * turn
    }

    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let moment = self.moment(displacement);
        for (moments, moment) in force.iter_mut().skip(2).step_by(OF_NODE).zip([moment, -moment]) {
            *moments = moment;
        }
        moment.abs()
    }

    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        stiffness.fill(0.0);
        let size = displacement.len();
        for row in 0..self.nodes.len() {
            for column in 0..self.nodes.len() {
                let value = if row == column { self.stiffness } else { -self.stiffness };
                stiffness[(OF_NODE * row + 2) * size + OF_NODE * column + 2] = value;
            }
        }
    }

    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        sizes.fill(0.0);
        let turns = displacement.iter().skip(2).step_by(OF_NODE);
        let turned = turns.fold(least, |most, turn| most.max(turn.abs()));
        sizes.iter_mut().skip(2).step_by(OF_NODE).for_each(|size| *size = self.stiffness * turned);
    }

    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        self.stiffness
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        Some(Resultants::Moment(self.moment(displacement)))
    }
}
