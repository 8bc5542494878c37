//! The posted model with indices instead of names, so that the check of an increment needs no look-ups.

use crate::check::measure::bodies::MeasuredBody;
use crate::check::measure::bodies::surface::TouchedSurfaces;
use crate::check::measure::elements::MeasuredElement;
use crate::check::measure::middles::{ContactPoint, following, middles};
use crate::check::measure::numbers::{MeasuredVector, largest, padded};
use crate::check::measure::obstacles::{MeasuredFrame, MeasuredObstacle};
use crate::check::measure::solids::{MeasuredFace, SolidShares, pressed_surfaces};
use crate::check::measure::turning::{MeasuredPivot, ObstaclePlacement};
use crate::model::request::{Contact, JobRequest, Model};
use crate::model::solids::data::is_revolved;
use indexmap::{IndexMap, IndexSet};
use std::collections::HashMap;
use std::f64::consts::SQRT_2;

#[derive(Debug, Clone)]
pub(super) struct Posted {
    pub dimension: usize,
    pub nodes: Vec<PostedNode>,
    /// The nodes with supports, in the order of the model's supports.
    pub supports: Vec<usize>,
    /// Centre of the box around the nodes, half its diagonal, and the largest coordinate.
    pub centre: MeasuredVector,
    pub extent: f64,
    pub reach: f64,
    pub elements: Vec<MeasuredElement>,
    pub obstacles: Vec<MeasuredObstacle>,
    pub contacts: Vec<PostedContact>,
    /// For each obstacle that moves or turns in some stage, where it turns.
    pub moving: Vec<Option<MeasuredPivot>>,
    /// The faces of each surface that some stage presses.
    pub pressed: Vec<Vec<MeasuredFace>>,
    pub stages: Vec<PostedStage>,
    /// The middles that follow the ends of their edges.
    pub following: Vec<[usize; 3]>,
    /// Whether solids are bodies of revolution, whose radial forces balance around the axis and not in the plane.
    pub is_revolved: bool,
}

#[derive(Debug, Clone)]
pub(super) struct PostedNode {
    pub name: String,
    pub place: MeasuredVector,
    /// Components that a support fixes.
    pub held: [bool; 3],
    pub has_rotation: bool,
    /// Components of the rotation vector that a support fixes; in the plane the first two do not move.
    pub rotation_held: [bool; 3],
}

impl PostedNode {
    /// Whether a support fixes a component of the rotation.
    pub fn is_turn_held(&self) -> bool {
        self.rotation_held.iter().any(|held| *held)
    }
}

#[derive(Debug, Clone)]
pub(super) struct PostedContact {
    /// Where the contact with an obstacle is measured.
    pub point: ContactPoint,
    pub counterpart: Counterpart,
    /// The index of the obstacle among the moving obstacles, if the obstacle moves.
    pub motion: Option<usize>,
    pub friction: f64,
}

/// What a node touches: an obstacle by its index, or another body.
#[derive(Debug, Clone)]
pub(super) enum Counterpart {
    Obstacle(usize),
    Body(Box<MeasuredBody>),
}

#[derive(Debug, Clone)]
pub(super) struct PostedStage {
    pub name: String,
    forces: PostedLoadPattern,
    moments: PostedLoadPattern,
    displacements: PostedLoadPattern,
    rotations: PostedLoadPattern,
    motions: PostedLoadPattern,
    /// Indices of turning obstacles with the angles that the load factor multiplies.
    turns: Vec<(usize, f64)>,
    /// Places of pressed surfaces with the pressures that the load factor multiplies.
    pressures: Vec<(usize, f64)>,
    /// Load factor of a dimensionless load of 1.
    pub load_scale: f64,
}

/// Indices of nodes or of moving obstacles, with the vectors that the load factor multiplies.
type PostedLoadPattern = Vec<(usize, MeasuredVector)>;

/// Loads on the structure: forces on the nodes, displacements of the nodes, and displacements of the moving obstacles.
#[derive(Debug, Clone)]
pub(super) struct PostedLoading {
    pub forces: Vec<MeasuredVector>,
    pub displacements: Vec<MeasuredVector>,
    /// Moments on the nodes, and prescribed rotations.
    pub moments: Vec<MeasuredVector>,
    pub rotations: Vec<MeasuredVector>,
    /// Translation and angle of each moving obstacle.
    pub shifts: Vec<MeasuredVector>,
    pub turns: Vec<f64>,
    /// Pressure on each pressed surface.
    pub pressures: Vec<f64>,
}

impl Posted {
    pub fn new(request: &JobRequest, load_scales: &[f64]) -> Self {
        let model = &request.model;
        let node = |((name, place), has_rotation): ((&String, &Vec<f64>), bool)| {
            let (mut held, mut rotation_held) = ([false; 3], [false; 3]);
            for component in model.supports.get(name).into_iter().flatten() {
                match held.get_mut(component.index()) {
                    Some(held) => *held = true,
                    None => rotation_held[component.index() - 3] = true,
                }
            }
            PostedNode { name: name.clone(), place: padded(place), held, has_rotation, rotation_held }
        };
        let moved =
            model.stages.iter().flat_map(|stage| stage.obstacle_motion.keys().chain(stage.obstacle_rotation.keys()));
        let moving: IndexSet<&str> = moved.map(String::as_str).collect();
        let touched = TouchedSurfaces::new(model);
        let middles = middles(model);
        let measured = |obstacle| MeasuredObstacle::new(obstacle, model.dimension);
        let obstacles: Vec<MeasuredObstacle> = model.obstacles.values().map(measured).collect();
        let contact = |contact| posted_contact(model, contact, (&touched, &middles), (&obstacles, &moving));
        let shares = SolidShares::new(model);
        let pressed: IndexMap<&str, Vec<MeasuredFace>> = pressed_surfaces(model).into_iter().collect();
        let scales = load_scales.iter().copied().chain(std::iter::repeat(1.0));
        let stage = |(stage, load_scale): (&crate::model::request::Stage, f64)| PostedStage {
            name: stage.name.clone(),
            forces: pattern(&stage.forces, &|name| model.nodes.get_index_of(name))
                .into_iter()
                .chain(shares.loads(stage))
                .collect(),
            moments: numbered(model, stage.moments.iter().map(|(name, moment)| (name, MeasuredVector::z() * *moment))),
            displacements: pattern(&stage.displacements, &|name| model.nodes.get_index_of(name))
                .into_iter()
                .map(|(node, values)| (node, in_dimension(&values, model.dimension)))
                .collect(),
            rotations: numbered(
                model,
                stage.displacements.iter().map(|(name, values)| (name, rotation(values, model.dimension))),
            ),
            motions: pattern(&stage.obstacle_motion, &|name| moving.get_index_of(name)),
            turns: angles(stage, &moving),
            pressures: stage
                .pressures
                .iter()
                .filter_map(|(name, value)| Some((pressed.get_index_of(name.as_str())?, *value)))
                .collect(),
            load_scale,
        };
        let nodes: Vec<PostedNode> = model.nodes.iter().zip(model.rotating_nodes()).map(node).collect();
        let first = nodes.first().map_or_else(MeasuredVector::zeros, |node| node.place);
        let (least, most) =
            nodes.iter().fold((first, first), |(least, most), node| (least.inf(&node.place), most.sup(&node.place)));
        Self {
            dimension: model.dimension,
            supports: model.supports.keys().filter_map(|name| model.nodes.get_index_of(name)).collect(),
            centre: (least + most) * 0.5,
            extent: (most - least).norm() * 0.5,
            reach: largest(&least).max(largest(&most)),
            nodes,
            elements: model.elements.iter().filter_map(|element| MeasuredElement::new(model, element)).collect(),
            contacts: model.contacts.iter().filter_map(contact).collect(),
            obstacles,
            moving: moving.iter().map(|name| MeasuredPivot::of(model, name)).collect(),
            following: following(model),
            is_revolved: is_revolved(model),
            stages: model.stages.iter().zip(scales).map(stage).collect(),
            pressed: pressed.into_values().collect(),
        }
    }
}

impl Posted {
    /// Whether anything turns: a node, or a released end.
    pub fn has_rotations(&self) -> bool {
        self.rotations() > self.nodes.len() || self.nodes.iter().any(|node| node.has_rotation)
    }

    /// Number of components that an increment has of a node.
    pub fn components_of(&self, node: &PostedNode) -> usize {
        match (node.has_rotation, self.dimension) {
            (false, dimension) => dimension,
            (true, 2) => 3,
            (true, _) => 6,
        }
    }

    /// The rotation vector among the components of a node.
    pub fn rotation(&self, values: &[f64]) -> MeasuredVector {
        rotation(values, self.dimension)
    }

    /// Number of nodes and of released ends.
    pub fn rotations(&self) -> usize {
        let releases = |element: &MeasuredElement| match element {
            MeasuredElement::Beam(beam) => beam.releases(),
            _ => 0,
        };
        self.nodes.len() + self.elements.iter().map(releases).sum::<usize>()
    }

    /// Where the obstacle of a contact is.
    pub fn placement(&self, contact: &PostedContact, loading: &PostedLoading) -> ObstaclePlacement<'_> {
        self.placed_at(contact, &loading.shifts, &loading.turns)
    }

    /// As [`Self::placement`], by the translations and angles of all moving obstacles.
    pub fn placed_at(
        &self,
        contact: &PostedContact,
        shifts: &[MeasuredVector],
        turns: &[f64],
    ) -> ObstaclePlacement<'_> {
        let Some(place) = contact.motion else {
            return ObstaclePlacement { shift: MeasuredVector::zeros(), turned: None };
        };
        ObstaclePlacement {
            shift: shifts[place],
            turned: self.moving[place].as_ref().map(|pivot| (pivot, turns[place])),
        }
    }

    /// The gap and the frame of the obstacle of a contact at its point, in the axes of the obstacle.
    pub fn frame(
        &self,
        contact: &PostedContact,
        loading: &PostedLoading,
        displacements: &[MeasuredVector],
    ) -> MeasuredFrame {
        match &contact.counterpart {
            Counterpart::Obstacle(obstacle) => {
                let ContactPoint { place, offset, .. } = &contact.point;
                let moved = contact.point.displacement(displacements);
                let (relative, reach) = self.placement(contact, loading).relative(place, &moved);
                let frame = self.obstacles[*obstacle].frame(self.dimension, place, &relative, reach);
                MeasuredFrame { gap: frame.gap + offset, ..frame }
            }
            // In the axes of the surface that is touched.
            Counterpart::Body(body) => MeasuredFrame {
                gap: body.gap(displacements),
                rounding: body.rounding(displacements),
                normal: if self.dimension == 2 { MeasuredVector::y() } else { MeasuredVector::z() },
                tangents: [
                    MeasuredVector::x(),
                    if self.dimension == 2 { MeasuredVector::zeros() } else { MeasuredVector::y() },
                ],
            },
        }
    }

    /// A distance that has to be covered before the contact can close, and the part of it that bodies and obstacle cover
    /// per unit motion of the nodes.
    pub fn clearance(&self, contact: &PostedContact, loading: &PostedLoading, displacements: &[MeasuredVector]) -> f64 {
        match &contact.counterpart {
            Counterpart::Obstacle(_) => self.frame(contact, loading, displacements).gap,
            // Both bodies move.
            Counterpart::Body(body) => body.distance(displacements) / SQRT_2,
        }
    }
}

/// A contact of a model, with the surfaces of bodies and the middles of edges that touch, its obstacles and the names of those
/// that move.
fn posted_contact(
    model: &Model,
    contact: &Contact,
    (touched, middles): (&TouchedSurfaces, &HashMap<&str, [usize; 3]>),
    (obstacles, moving): (&[MeasuredObstacle], &IndexSet<&str>),
) -> Option<PostedContact> {
    let node = model.nodes.get_index_of(&contact.node)?;
    let friction = contact.friction;
    let at_node = || ContactPoint::at_node(node, padded(&model.nodes[node]));
    if let Some(body) = MeasuredBody::new(model, contact, touched) {
        let counterpart = Counterpart::Body(Box::new(body));
        return Some(PostedContact { point: at_node(), counterpart, motion: None, friction });
    }
    let obstacle = model.obstacles.get_index_of(&contact.obstacle)?;
    let at_rest = MeasuredVector::zeros();
    let gap_at = |place: &MeasuredVector| obstacles[obstacle].frame(model.dimension, place, &at_rest, 0.0).gap;
    let point = match middles.get(contact.node.as_str()) {
        Some(nodes) => ContactPoint::past_middle(*nodes, model, gap_at),
        None => at_node(),
    };
    let motion = moving.get_index_of(contact.obstacle.as_str());
    Some(PostedContact { point, counterpart: Counterpart::Obstacle(obstacle), motion, friction })
}

/// Numbers of the nodes with their values, as far as there are any.
fn numbered<'a>(model: &Model, values: impl Iterator<Item = (&'a String, MeasuredVector)>) -> PostedLoadPattern {
    values.filter_map(|(name, value)| Some((model.nodes.get_index_of(name)?, value))).collect()
}

/// The rotation vector after the translations; zero where there is none.
pub(super) fn rotation(values: &[f64], dimension: usize) -> MeasuredVector {
    match values.get(dimension..) {
        Some([turn]) => MeasuredVector::z() * *turn,
        Some([x, y, z]) => MeasuredVector::new(*x, *y, *z),
        _ => MeasuredVector::zeros(),
    }
}

/// The vector without what follows the components of the space.
fn in_dimension(values: &MeasuredVector, dimension: usize) -> MeasuredVector {
    padded(&values.as_slice()[..dimension.min(3)])
}

fn angles(stage: &crate::model::request::Stage, moving: &IndexSet<&str>) -> Vec<(usize, f64)> {
    let rotations = stage.obstacle_rotation.iter();
    rotations.filter_map(|(name, rotation)| Some((moving.get_index_of(name.as_str())?, rotation.angle))).collect()
}

fn pattern(posted: &IndexMap<String, Vec<f64>>, number: &dyn Fn(&str) -> Option<usize>) -> PostedLoadPattern {
    posted.iter().filter_map(|(name, values)| Some((number(name)?, padded(values)))).collect()
}

impl PostedStage {
    /// Motion of the obstacle of a contact per unit load factor (length).
    pub fn motion(&self, contact: &PostedContact) -> MeasuredVector {
        let of_this = |(place, _): &&(usize, MeasuredVector)| Some(*place) == contact.motion;
        self.motions.iter().find(of_this).map_or_else(MeasuredVector::zeros, |(_, motion)| *motion)
    }
}

impl PostedLoading {
    pub fn none(posted: &Posted) -> Self {
        let nodes = posted.nodes.len();
        Self {
            forces: vec![MeasuredVector::zeros(); nodes],
            displacements: vec![MeasuredVector::zeros(); nodes],
            moments: vec![MeasuredVector::zeros(); nodes],
            rotations: vec![MeasuredVector::zeros(); nodes],
            shifts: vec![MeasuredVector::zeros(); posted.moving.len()],
            turns: vec![0.0; posted.moving.len()],
            pressures: vec![0.0; posted.pressed.len()],
        }
    }

    /// Sets the sum of the loads kept from the previous stages and of the loads of a stage at a load factor.
    pub fn set(&mut self, held: &Self, stage: &PostedStage, load: f64) {
        let all = [
            (&mut self.forces, &held.forces, &stage.forces),
            (&mut self.displacements, &held.displacements, &stage.displacements),
            (&mut self.shifts, &held.shifts, &stage.motions),
            (&mut self.moments, &held.moments, &stage.moments),
            (&mut self.rotations, &held.rotations, &stage.rotations),
        ];
        for (sums, held, pattern) in all {
            sums.copy_from_slice(held);
            for (place, values) in pattern {
                sums[*place] += values * load;
            }
        }
        let numbers =
            [(&mut self.pressures, &held.pressures, &stage.pressures), (&mut self.turns, &held.turns, &stage.turns)];
        for (sums, held, pattern) in numbers {
            sums.copy_from_slice(held);
            for (place, value) in pattern {
                sums[*place] += value * load;
            }
        }
    }
}
