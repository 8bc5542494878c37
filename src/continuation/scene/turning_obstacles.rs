//! Obstacles that turn: the auxiliary nodes that stand for their motion, and what stages prescribe of these.

use crate::continuation::scene::solid_loads::pressed_surfaces;
use crate::mechanics::contact::kinematics::Kinematics;
use crate::mechanics::contact::turning_obstacle::NodeAtTurningObstacle;
use crate::mechanics::structure::Structure;
use crate::model::request::{Contact, Model, ObstaclePivot, Stage};
use indexmap::IndexMap;
use std::sync::Arc;

/// The obstacles that turn, each with the auxiliary nodes that stand for its translation and for its angle.
pub(super) struct TurningObstacles<'a>(IndexMap<&'a str, (ObstaclePivot, [usize; 2])>);

impl<'a> TurningObstacles<'a> {
    /// Their auxiliary nodes follow those of pressures.
    pub fn of(model: &'a Model) -> Self {
        let first = model.nodes.len() + pressed_surfaces(model).len();
        let with_nodes = |(place, (name, pivot))| (name, (pivot, [first + 2 * place, first + 2 * place + 1]));
        Self(model.turning_obstacles().into_iter().enumerate().map(with_nodes).collect())
    }

    pub fn auxiliary_nodes(&self) -> usize {
        2 * self.0.len()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn has(&self, obstacle: &str) -> bool {
        self.0.contains_key(obstacle)
    }

    /// The kinematics of a contact, by the number of its node, if its obstacle turns.
    pub fn kinematics(&self, model: &Model, contact: &Contact, node: usize, length: f64) -> Option<Kinematics> {
        let (pivot, auxiliary) = self.0.get(contact.obstacle.as_str())?;
        let mut arm = [0.0; 3];
        for ((arm, position), pivot) in arm.iter_mut().zip(&model.nodes[&contact.node]).zip(pivot.place) {
            *arm = (position - pivot) / length;
        }
        let turned = NodeAtTurningObstacle::new(node, *auxiliary, model.dimension, arm, pivot.axis);
        Some(Kinematics::Coupled(Arc::new(turned)))
    }

    /// Calls `each(freedom, value, is_length)` with what a stage prescribes per load factor: lengths and angles.
    pub fn each_support(&self, stage: &Stage, structure: &Structure, mut each: impl FnMut(usize, f64, bool)) {
        for (obstacle, (_, auxiliary)) in &self.0 {
            let [translation, angle] = auxiliary.map(|node| structure.translations_of(node));
            if let Some(motion) = stage.obstacle_motion.get(*obstacle) {
                translation.zip(motion).for_each(|(freedom, value)| each(freedom, *value, true));
            }
            if let Some(rotation) = stage.obstacle_rotation.get(*obstacle) {
                each(angle.start, rotation.angle, false);
            }
        }
    }
}
