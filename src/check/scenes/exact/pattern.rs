//! Patterns that identify the families of models.

use crate::model::Model;
use crate::model::request::{Component, Contact, Element, Obstacle, Stage, Strain};

const COMPONENTS: [Component; 3] = [Component::X, Component::Y, Component::Z];

/// A single, initially unstressed bar from a supported node to a free node.
pub(super) struct SingleBar<'a> {
    pub held: &'a str,
    pub free: &'a str,
    pub axial_stiffness: f64,
    pub strain: Strain,
}

/// The bar of a model with two nodes and one bar between the nodes.
pub(super) fn one_bar(model: &Model) -> Option<SingleBar<'_>> {
    let [Element::Bar { nodes, axial_stiffness, rest_length: None, prestress, strain, .. }] = &model.elements[..]
    else {
        return None;
    };
    if model.nodes.len() != 2 || *prestress != 0.0 {
        return None;
    }
    let (held, free) = if is_held(model, &nodes[0]) { (&nodes[0], &nodes[1]) } else { (&nodes[1], &nodes[0]) };
    let fits = is_held(model, held) && is_free(model, free);
    fits.then_some(SingleBar { held, free, axial_stiffness: *axial_stiffness, strain: *strain })
}

/// The only node of a model, and the stiffness matrix of the only spring, which connects the node to the ground.
pub(super) fn one_spring(model: &Model) -> Option<(&str, &[Vec<f64>])> {
    let [Element::Spring { nodes, stiffness, .. }] = &model.elements[..] else { return None };
    let ([node], 1) = (&nodes[..], model.nodes.len()) else { return None };
    is_free(model, node).then_some((node, stiffness))
}

pub(super) fn is_held(model: &Model, node: &str) -> bool {
    let held = model.supports.get(node);
    held.is_some_and(|held| COMPONENTS.iter().take(model.dimension).all(|component| held.contains(component)))
}

pub(super) fn is_free(model: &Model, node: &str) -> bool {
    model.supports.get(node).is_none_or(Vec::is_empty)
}

/// The only contact of a model, between the given node and the only obstacle.
pub(super) fn one_contact<'a>(model: &'a Model, node: &str) -> Option<(&'a Contact, &'a Obstacle)> {
    let [contact] = &model.contacts[..] else { return None };
    let obstacle = model.obstacles.get(&contact.obstacle)?;
    (contact.node == node && model.obstacles.len() == 1).then_some((contact, obstacle))
}

/// Whether an obstacle is the plane through a point with its normal along the last axis.
pub(super) fn is_floor_at(obstacle: &Obstacle, place: &[f64]) -> bool {
    let Obstacle::Plane { point, normal } = obstacle else { return false };
    let Some(last) = place.len().checked_sub(1) else { return false };
    let upright = normal[..last].iter().all(|component| *component == 0.0) && normal[last] > 0.0;
    upright && point[last] == place[last]
}

/// The force of a stage whose only load is a force on the given node.
pub(super) fn only_force<'a>(stage: &'a Stage, node: &str) -> Option<&'a [f64]> {
    let others = stage.forces.iter().any(|(name, force)| name != node && force.iter().any(|value| *value != 0.0));
    let moves = stage.displacements.values().chain(stage.obstacle_motion.values()).flatten().any(|value| *value != 0.0);
    if others || moves { None } else { stage.forces.get(node).map(Vec::as_slice) }
}

/// The index of the first component of a node in the displacements of a model.
pub(super) fn freedom(model: &Model, node: &str) -> usize {
    model.nodes.get_index_of(node).unwrap_or_default() * model.dimension
}
