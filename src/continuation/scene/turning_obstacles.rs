//! Obstacles that turn: the auxiliary nodes that stand for their motion, and what stages prescribe of these.

use crate::continuation::scene::solid_loads::pressed_surfaces;
use crate::mechanics::contact::kinematics::Kinematics;
use crate::mechanics::contact::turning_obstacle::NodeAtTurningObstacle;
use crate::mechanics::structure::Structure;
use crate::model::request::{Contact, Model, ObstaclePivot, Stage};
use indexmap::{IndexMap, IndexSet};
use std::collections::HashMap;
use std::sync::Arc;

/// The obstacles that turn, each with the auxiliary nodes that stand for its translation and for its angle. Obstacles that
/// move alike share these.
pub(super) struct TurningObstacles<'a> {
    obstacles: IndexMap<&'a str, (ObstaclePivot, [usize; 2])>,
    /// How many of them move differently.
    motions: usize,
}

impl<'a> TurningObstacles<'a> {
    /// Their auxiliary nodes follow those of pressures.
    pub fn of(model: &'a Model) -> Self {
        let first = model.nodes.len() + pressed_surfaces(model).len();
        let turning = model.turning_obstacles();
        let mut motions: IndexSet<Vec<u64>> = IndexSet::new();
        let mut all = every_motion(model, &turning);
        let with_nodes = |(name, pivot): (&'a str, ObstaclePivot)| {
            let (place, _) = motions.insert_full(all.remove(name).unwrap_or_default());
            (name, (pivot, [first + 2 * place, first + 2 * place + 1]))
        };
        let obstacles = turning.into_iter().map(with_nodes).collect();
        Self { obstacles, motions: motions.len() }
    }

    pub fn auxiliary_nodes(&self) -> usize {
        2 * self.motions
    }

    pub fn is_empty(&self) -> bool {
        self.obstacles.is_empty()
    }

    pub fn has(&self, obstacle: &str) -> bool {
        self.obstacles.contains_key(obstacle)
    }

    /// The kinematics of a contact, by the number of its node and its place, if its obstacle turns.
    pub fn kinematics(&self, contact: &Contact, node: usize, place: &[f64], length: f64) -> Option<Kinematics> {
        let (pivot, auxiliary) = self.obstacles.get(contact.obstacle.as_str())?;
        let mut arm = [0.0; 3];
        for ((arm, position), pivot) in arm.iter_mut().zip(place).zip(pivot.place) {
            *arm = (position - pivot) / length;
        }
        let turned = NodeAtTurningObstacle::new(node, *auxiliary, place.len(), arm, pivot.axis);
        Some(Kinematics::Coupled(Arc::new(turned)))
    }

    /// Calls `each(freedom, value, is_length)` with what a stage prescribes per load factor: lengths and angles.
    pub fn each_support(&self, stage: &Stage, structure: &Structure, mut each: impl FnMut(usize, f64, bool)) {
        for (obstacle, (_, auxiliary)) in &self.obstacles {
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

/// The bits of the numbers that say how each obstacle moves: its pivot, and its angle and translation in each stage that has
/// one.
fn every_motion<'a>(model: &'a Model, turning: &IndexMap<&'a str, ObstaclePivot>) -> HashMap<&'a str, Vec<u64>> {
    let of_pivot = |pivot: &ObstaclePivot| pivot.place.iter().chain(&pivot.axis).map(|part| part.to_bits()).collect();
    let mut all: HashMap<&str, Vec<u64>> = turning.iter().map(|(name, pivot)| (*name, of_pivot(pivot))).collect();
    for (index, stage) in model.stages.iter().enumerate() {
        let angles = stage.obstacle_rotation.iter().map(|(name, rotation)| (name, 0, vec![rotation.angle]));
        let translations = stage.obstacle_motion.iter().map(|(name, translation)| (name, 1, translation.clone()));
        for (name, kind, values) in angles.chain(translations) {
            if let Some(motion) = all.get_mut(name.as_str()) {
                // Adding zero makes both zeros one.
                motion
                    .extend([index as u64, kind].into_iter().chain(values.iter().map(|value| (value + 0.0).to_bits())));
            }
        }
    }
    all
}
