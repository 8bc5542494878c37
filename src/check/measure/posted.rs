//! The posted model with numbers instead of names, so that judging an increment needs no look-ups.

use crate::check::measure::elements::Element;
use crate::check::measure::obstacles::{Frame, Obstacle};
use crate::check::measure::vector::{Vector, padded};
use crate::model::request::JobRequest;
use indexmap::{IndexMap, IndexSet};

#[derive(Debug, Clone)]
pub(super) struct Posted {
    pub dimension: usize,
    pub nodes: Vec<Node>,
    pub elements: Vec<Element>,
    pub obstacles: Vec<Obstacle>,
    pub contacts: Vec<Contact>,
    /// Obstacles that move in some stage.
    pub moving: usize,
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
    /// The index of its obstacle among the moving ones.
    pub motion: Option<usize>,
    pub friction: f64,
}

#[derive(Debug, Clone)]
pub(super) struct Stage {
    pub name: String,
    forces: Pattern,
    displacements: Pattern,
    motions: Pattern,
    /// Load factor of a dimensionless load of 1.
    pub load_scale: f64,
}

/// Nodes or moving obstacles, with the vectors that the load factor multiplies.
type Pattern = Vec<(usize, Vector)>;

/// Loads on the structure: forces on the nodes, displacements of the nodes, and displacements of the moving obstacles.
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
        let moved = model.stages.iter().flat_map(|stage| stage.obstacle_motion.keys());
        let moving: IndexSet<&str> = moved.map(String::as_str).collect();
        let contact = |contact: &crate::model::request::Contact| {
            let node = model.nodes.get_index_of(&contact.node)?;
            let obstacle = model.obstacles.get_index_of(&contact.obstacle)?;
            let motion = moving.get_index_of(contact.obstacle.as_str());
            Some(Contact { node, obstacle, motion, friction: contact.friction })
        };
        let scales = load_scales.iter().copied().chain(std::iter::repeat(1.0));
        let stage = |(stage, load_scale): (&crate::model::request::Stage, f64)| Stage {
            name: stage.name.clone(),
            forces: pattern(&stage.forces, &|name| model.nodes.get_index_of(name)),
            displacements: pattern(&stage.displacements, &|name| model.nodes.get_index_of(name)),
            motions: pattern(&stage.obstacle_motion, &|name| moving.get_index_of(name)),
            load_scale,
        };
        Self {
            dimension: model.dimension,
            nodes: model.nodes.iter().map(node).collect(),
            elements: model.elements.iter().filter_map(|element| Element::new(model, element)).collect(),
            obstacles: model.obstacles.values().map(Obstacle::new).collect(),
            contacts: model.contacts.iter().filter_map(contact).collect(),
            moving: moving.len(),
            stages: model.stages.iter().zip(scales).map(stage).collect(),
        }
    }
}

impl Posted {
    /// The gap and the frame of a contact.
    pub fn frame(&self, contact: &Contact, loading: &Loading, displacements: &[Vector]) -> Frame {
        let place = &self.nodes[contact.node].place;
        let obstacle = &self.obstacles[contact.obstacle];
        obstacle.frame(self.dimension, &loading.shift(contact), place, &displacements[contact.node])
    }
}

fn pattern(posted: &IndexMap<String, Vec<f64>>, number: &dyn Fn(&str) -> Option<usize>) -> Pattern {
    posted.iter().filter_map(|(name, values)| Some((number(name)?, padded(values)))).collect()
}

impl Stage {
    /// Motion of the obstacle of a contact per unit load factor (length).
    pub fn motion(&self, contact: &Contact) -> Vector {
        let of_this = |(place, _): &&(usize, Vector)| Some(*place) == contact.motion;
        self.motions.iter().find(of_this).map_or_else(Vector::zeros, |(_, motion)| *motion)
    }
}

impl Loading {
    pub fn none(posted: &Posted) -> Self {
        let nodes = posted.nodes.len();
        Self {
            forces: vec![Vector::zeros(); nodes],
            displacements: vec![Vector::zeros(); nodes],
            shifts: vec![Vector::zeros(); posted.moving],
        }
    }

    /// The displacement of the obstacle of a contact.
    pub fn shift(&self, contact: &Contact) -> Vector {
        contact.motion.map_or_else(Vector::zeros, |place| self.shifts[place])
    }

    /// Sets the sum of the held loads and those of a stage at a load factor.
    pub fn set(&mut self, held: &Self, stage: &Stage, load: f64) {
        let all = [
            (&mut self.forces, &held.forces, &stage.forces),
            (&mut self.displacements, &held.displacements, &stage.displacements),
            (&mut self.shifts, &held.shifts, &stage.motions),
        ];
        for (sums, held, pattern) in all {
            sums.copy_from_slice(held);
            for (place, values) in pattern {
                sums[*place] += values * load;
            }
        }
    }
}
