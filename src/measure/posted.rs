//! The posted model with its names replaced by numbers, so that judging an increment looks nothing up.

use super::elements::Element;
use super::obstacles::Obstacle;
use super::vector::{Vector, ZERO, add, padded};
use crate::model::request::JobRequest;
use indexmap::IndexMap;

#[derive(Debug, Clone)]
pub(super) struct Posted {
    pub dimension: usize,
    pub nodes: Vec<Node>,
    pub elements: Vec<Element>,
    pub obstacles: Vec<Obstacle>,
    pub contacts: Vec<Contact>,
    pub stages: Vec<Stage>,
}

#[derive(Debug, Clone)]
pub(super) struct Node {
    pub name: String,
    pub place: Vector,
    /// Components that a support holds.
    pub held: [bool; 3],
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub node: usize,
    pub obstacle: usize,
    pub friction: f64,
}

#[derive(Debug, Clone)]
pub(super) struct Stage {
    pub name: String,
    forces: Pattern,
    displacements: Pattern,
    motions: Pattern,
    /// Load factor of one dimensionless load.
    pub load_scale: f64,
}

/// Nodes or obstacles and what the load factor multiplies there.
type Pattern = Vec<(usize, Vector)>;

/// What acts on the structure: one vector a node, one a node, one an obstacle.
#[derive(Debug, Clone)]
pub(super) struct Loading {
    pub forces: Vec<Vector>,
    pub displacements: Vec<Vector>,
    pub shifts: Vec<Vector>,
}

impl Posted {
    pub fn new(request: &JobRequest, load_scales: &[f64]) -> Self {
        let model = &request.model;
        let node = |(name, place): (&String, &Vec<f64>)| {
            let mut held = [false; 3];
            for component in model.supports.get(name).into_iter().flatten() {
                held[component.index()] = true;
            }
            Node { name: name.clone(), place: padded(place), held }
        };
        let contact = |contact: &crate::model::request::Contact| {
            let node = model.nodes.get_index_of(&contact.node)?;
            let obstacle = model.obstacles.get_index_of(&contact.obstacle)?;
            Some(Contact { node, obstacle, friction: contact.friction })
        };
        let scales = load_scales.iter().copied().chain(std::iter::repeat(1.0));
        let stage = |(stage, load_scale): (&crate::model::request::Stage, f64)| Stage {
            name: stage.name.clone(),
            forces: pattern(&stage.forces, &|name| model.nodes.get_index_of(name)),
            displacements: pattern(&stage.displacements, &|name| model.nodes.get_index_of(name)),
            motions: pattern(&stage.obstacle_motion, &|name| model.obstacles.get_index_of(name)),
            load_scale,
        };
        Self {
            dimension: model.dimension,
            nodes: model.nodes.iter().map(node).collect(),
            elements: model.elements.iter().filter_map(|element| Element::new(model, element)).collect(),
            obstacles: model.obstacles.values().map(Obstacle::new).collect(),
            contacts: model.contacts.iter().filter_map(contact).collect(),
            stages: model.stages.iter().zip(scales).map(stage).collect(),
        }
    }
}

fn pattern(posted: &IndexMap<String, Vec<f64>>, number: &dyn Fn(&str) -> Option<usize>) -> Pattern {
    posted.iter().filter_map(|(name, values)| Some((number(name)?, padded(values)))).collect()
}

impl Loading {
    pub fn none(posted: &Posted) -> Self {
        let (nodes, obstacles) = (posted.nodes.len(), posted.obstacles.len());
        Self { forces: vec![ZERO; nodes], displacements: vec![ZERO; nodes], shifts: vec![ZERO; obstacles] }
    }

    /// Becomes what is held with a stage under a load factor on top.
    pub fn set(&mut self, held: &Self, stage: &Stage, load: f64) {
        let all = [
            (&mut self.forces, &held.forces, &stage.forces),
            (&mut self.displacements, &held.displacements, &stage.displacements),
            (&mut self.shifts, &held.shifts, &stage.motions),
        ];
        for (sums, held, pattern) in all {
            sums.copy_from_slice(held);
            for (place, values) in pattern {
                sums[*place] = add(&sums[*place], load, values);
            }
        }
    }
}
