//! A request made ready for tracing: checked, numbered and dimensionless.
//!
//! Lengths are divided by `displacement_scale` `ℓ`, forces by `force_scale` `φ`, each stage's load factor by its
//! `load_scale` `σ`; a pattern `f` becomes `f σ/φ`. By default `ℓ` is the longest bar and `φ` the smallest axial
//! stiffness; without bars, `φ` is the largest force of any stage at the load factor at which the stage is to end (1 where
//! it names none), or the largest spring stiffness (Frobenius norm) times the largest prescribed motion if that is more,
//! and `ℓ` that force over that stiffness.
//! `σ` is the smaller of `φ / max |f|` and `ℓ / max |motion|`. All follow the units of the input, so that a change of units changes nothing but round-off.

use super::corner::Corner;
use super::loading::LoadPattern;
use super::newton::Place;
use super::plan::{LeftOut, Plan};
use super::state::State;
use crate::contact::obstacle::Obstacle;
use crate::contact::vector::{Vector, size};
use crate::contact::{Contact, Sliding};
use crate::linear_algebra::sparse::Bordered;
use crate::linear_algebra::{Factorisation, Sink, null_space};
use crate::model::limits::PENETRATION_TOLERANCE;
use crate::model::request::{self, Analysis, JobRequest, Model, Side};
use crate::model::{InputError, InputErrors};
use crate::structure::Structure;
use crate::structure::bar::Bar;
use crate::structure::element::Element;
use crate::structure::spring::Spring;
use indexmap::IndexMap;
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Everything a path needs to know; shared by all who trace it.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(super) structure: Structure,
    /// Contacts that are solved for; coincident ones of a node are one of them.
    pub(super) contacts: Vec<Contact>,
    /// Names of their nodes and obstacles.
    pub(super) contact_names: Vec<(Arc<str>, Arc<str>)>,
    /// The contacts of the request, in its order.
    pub(super) reported: Vec<Reported>,
    /// Nodes with several contacts.
    pub(super) corners: Vec<Corner>,
    pub(super) node_names: Vec<Arc<str>>,
    pub(super) stages: Vec<StageLoad>,
    pub(super) analysis: Analysis,
    /// Which of the request's contacts have a row in every increment, in reach or not; `None`: all.
    pub(super) asked_rows: Option<Vec<usize>>,
    /// Straight stretches are one increment.
    pub(super) jumps: bool,
    plan: Plan,
}

/// A contact of the request and its part of the one that is solved for.
#[derive(Debug, Clone)]
pub(super) struct Reported {
    pub node: Arc<str>,
    pub obstacle: Arc<str>,
    /// Which of the scene's contacts.
    pub contact: usize,
    /// Shares of the reaction's parts; 1 but for coincident contacts.
    pub normal_share: f64,
    pub tangential_share: f64,
    /// Others of the request share that contact.
    pub shared: bool,
}

/// A stage's load pattern over all degrees of freedom and its ends, dimensionless.
#[derive(Debug, Clone)]
pub(super) struct StageLoad {
    pub name: Arc<str>,
    pub pattern: LoadPattern,
    pub load_scale: f64,
    pub ends: Vec<End>,
    /// The loads at which the stage may end, in the user's units, in the order of those `ends`.
    given_loads: Vec<f64>,
}

impl StageLoad {
    /// A load in the user's units. At the bound of a stage it is the number that was given: dividing it by a scale and
    /// multiplying again may not give it back.
    pub fn load_factor(&self, load: f64) -> f64 {
        let bounds =
            self.ends.iter().filter_map(|end| if let End::Load { bound, .. } = end { Some(*bound) } else { None });
        let given = bounds.zip(&self.given_loads).find(|(bound, _)| *bound == load);
        given.map_or(load * self.load_scale, |(_, given)| *given)
    }
}

/// One way in which a stage ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// `sign (s - bound) >= 0`
    Load {
        bound: f64,
        sign: f64,
    },
    /// `sign (u - bound) >= 0`
    Displacement {
        freedom: usize,
        bound: f64,
        sign: f64,
    },
    LimitPoints(u64),
    ContactChanges(u64),
    Increments(u64),
}

impl End {
    /// Whether it is a bound of the load or of a displacement, not a count.
    pub fn is_bound(self) -> bool {
        matches!(self, Self::Load { .. } | Self::Displacement { .. })
    }

    /// The equation of a bound; `None` of a count.
    pub fn place(self) -> Option<Place<'static>> {
        match self {
            Self::Load { bound, .. } => Some(Place::Load(bound)),
            Self::Displacement { freedom, bound, .. } => Some(Place::Displacement { freedom, value: bound }),
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => None,
        }
    }

    /// Whether a state meets a bound without even round-off.
    pub fn is_met_exactly(self, state: &State) -> bool {
        match self {
            Self::Load { bound, .. } => state.load == bound,
            Self::Displacement { freedom, bound, .. } => state.displacement[freedom] == bound,
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => false,
        }
    }

    /// Puts a state that meets a bound to round-off exactly there.
    pub fn make_exact(self, state: &mut State) {
        match self {
            Self::Load { bound, .. } => state.load = bound,
            Self::Displacement { freedom, bound, .. } => state.displacement[freedom] = bound,
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => {}
        }
    }
}

/// Contacts closer than this (dimensionless) count as closed when the supports are judged.
const CLOSED: f64 = 1e-10;
/// Forces at the start below this fraction of the largest are round-off.
const BALANCED: f64 = 1e-11;

impl Scene {
    /// Checks the request as a whole and makes it dimensionless.
    pub fn new(request: &JobRequest) -> Result<Self, InputErrors> {
        crate::model::check::check(request)?;
        let model = &request.model;
        let (length, force) = scales(model, &request.analysis);
        let numbers: HashMap<&str, usize> =
            model.nodes.keys().enumerate().map(|(number, name)| (name.as_str(), number)).collect();
        let structure = build_structure(model, &numbers, length, force);
        let mut left_out = Vec::new();
        let Contacts { contacts, contact_names, reported, corners } =
            build_contacts(model, &numbers, length, &structure, &mut left_out);
        // A contact that is solved for is numbered when the first of the request's for it is read.
        let mut first_contacts: Vec<usize> = Vec::with_capacity(contacts.len());
        for (index, one) in reported.iter().enumerate() {
            if one.contact == first_contacts.len() {
                first_contacts.push(index);
            }
        }
        let scaled = Scaled {
            model,
            analysis: &request.analysis,
            numbers: &numbers,
            structure: &structure,
            first_contacts: &first_contacts,
            length,
            force,
        };
        let stages: Vec<StageLoad> = model.stages.iter().map(|stage| build_stage(stage, &scaled)).collect();
        let plan = Plan {
            unknowns: structure.unknowns() as u64,
            contacts: reported.len() as u64,
            stages: stages.len() as u64,
            displacement_scale: length,
            force_scale: force,
            load_scales: stages.iter().map(|stage| stage.load_scale).collect(),
            left_out,
        };
        let node_names = model.nodes.keys().map(|name| Arc::from(name.as_str())).collect();
        let analysis = request.analysis.clone();
        let asked_rows = super::near::asked_rows(request);
        let jumps = super::straight::jumps(&analysis, &structure);
        let mut scene = Self {
            structure,
            contacts,
            contact_names,
            reported,
            corners,
            node_names,
            stages,
            analysis,
            asked_rows,
            jumps,
            plan,
        };
        scene.plan.left_out.extend(super::plan::left_out(&scene));
        scene.refuse_mechanism()?;
        scene.refuse_imbalance()?;
        scene.refuse_dragged_supports(model)?;
        Ok(scene)
    }

    /// Refuses friction between a supported component and an obstacle that are driven against each other: the support
    /// would bear a traction that is no unknown of the path.
    fn refuse_dragged_supports(&self, model: &Model) -> Result<(), InputErrors> {
        let structure = &self.structure;
        let dimension = structure.dimension;
        for (index, one) in self.reported.iter().enumerate() {
            let contact = &self.contacts[one.contact];
            let driven = |component: usize| {
                let freedom = contact.node * dimension + component;
                let moves = |stage: &StageLoad| {
                    let support = stage.pattern.supports.get(freedom).copied().unwrap_or(0.0);
                    support != stage.pattern.shifts[one.contact][component]
                };
                let normal = contact.frame(&[0.0; 3]).normal;
                structure.unknown_of[freedom].is_none()
                    && normal[component].abs() < 1.0
                    && self.stages.iter().any(moves)
            };
            if model.contacts[index].friction > 0.0 && (0..dimension).any(driven) {
                return Err(InputErrors(vec![InputError::new(
                    format!("/model/contacts/{index}/friction"),
                    format!(
                        "\"{}\" is supported in a component in which it and \"{}\" are driven against each other; friction \
                         on such a support is not available: leave the component free and hold it by a spring, or give \
                         friction 0",
                        one.node, one.obstacle
                    ),
                )]));
            }
        }
        Ok(())
    }

    /// Refuses prestress and rest lengths that do not balance in the undeformed structure: a path starts at rest.
    fn refuse_imbalance(&self) -> Result<(), InputErrors> {
        let structure = &self.structure;
        let mut force = vec![0.0; structure.freedoms()];
        let largest = structure.internal_force(&vec![0.0; structure.freedoms()], &mut force);
        let unbalanced = structure.freedom_of.iter().map(|freedom| (*freedom, force[*freedom].abs()));
        let Some((freedom, worst)) = unbalanced.max_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(()) };
        if worst <= BALANCED * largest {
            return Ok(());
        }
        let name = &self.node_names[freedom / structure.dimension];
        Err(InputErrors(vec![InputError::new(
            pointer_to_node(name),
            format!(
                "prestress and rest lengths leave a force of {:e} on \"{name}\" at the start; a path starts from a state \
                 at rest: give prestress that balances at every free node, or bring it on as a stage's forces",
                worst * self.plan.force_scale
            ),
        )]))
    }

    /// What the scene needs and what is left out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Motions at rest, all closed contacts holding, that hardly any force resists; `None` where there are none.
    fn unresisted_motions(&self, still: &[f64]) -> Option<Vec<DVector<f64>>> {
        let structure = &self.structure;
        let unknowns = structure.unknowns();
        if let Some(layout) = structure.layout() {
            let mut matrix = Bordered::new(layout.pattern.clone(), 0);
            let (mut places, mut stiffness) = (layout.places(), 0.0_f64);
            structure.each_stiffness(still, &mut |_, _, value| {
                if let Some(place) = places.next().flatten() {
                    matrix.add_at(place, value);
                    stiffness = stiffness.max(value.abs());
                }
            });
            self.hold_closed_contacts(stiffness, &mut matrix);
            return matrix.null_vectors(1e-9).filter(|motions| !motions.is_empty());
        }
        let mut matrix = DMatrix::zeros(unknowns, unknowns);
        structure.add_tangent(still, &mut matrix);
        let stiffness = matrix.amax();
        self.hold_closed_contacts(stiffness, &mut matrix);
        if unknowns == 0 || Factorisation::new(matrix.clone()).is_some() {
            return None;
        }
        null_space(&matrix, 1e-12).map(|basis| basis.column_iter().map(|column| column.into_owned()).collect())
    }

    /// Adds a stiffness in every direction in which a closed contact holds its node.
    fn hold_closed_contacts(&self, stiffness: f64, matrix: &mut impl Sink) {
        let structure = &self.structure;
        let dimension = structure.dimension;
        for contact in &self.contacts {
            let frame = contact.frame(&[0.0; 3]);
            if frame.gap > CLOSED {
                continue;
            }
            let held = 1 + contact.tangents();
            for vector in [frame.normal, frame.tangents[0], frame.tangents[1]].iter().take(held) {
                for row in 0..dimension {
                    for column in 0..dimension {
                        let place = |component| structure.unknown_of[contact.node * dimension + component];
                        if let (Some(row_unknown), Some(column_unknown)) = (place(row), place(column)) {
                            matrix.add(row_unknown, column_unknown, stiffness * vector[row] * vector[column]);
                        }
                    }
                }
            }
        }
    }

    /// Refuses a structure that can move with no element resisting although every closed contact holds.
    fn refuse_mechanism(&self) -> Result<(), InputErrors> {
        let structure = &self.structure;
        let dimension = structure.dimension;
        let still = vec![0.0; structure.freedoms()];
        let Some(motions) = self.unresisted_motions(&still) else { return Ok(()) };
        for motion in &motions {
            let mut rate = still.clone();
            for (unknown, value) in motion.iter().enumerate() {
                rate[structure.freedom_of[unknown]] = *value;
            }
            if structure.resistance(&still, &rate) < 1e-10 {
                let unknown = motion.iamax();
                let freedom = structure.freedom_of[unknown];
                let name = &self.node_names[freedom / dimension];
                let component = ["x", "y", "z"][freedom % dimension];
                return Err(InputErrors(vec![InputError::new(
                    pointer_to_node(name),
                    format!(
                        "the structure is a mechanism: \"{name}\" can move along {component} with no element, support or \
                         closed contact resisting; support it, or connect it by bars or springs that resist the motion"
                    ),
                )]));
            }
        }
        Ok(())
    }
}

fn pointer_to_node(name: &str) -> String {
    format!("/model/nodes/{}", name.replace('~', "~0").replace('/', "~1"))
}

/// Euclidean norm: the scales must not depend on the axes.
fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// The load factor at which a stage is to end, if it says so; else 1.
fn expected_load_factor(stage: &request::Stage) -> f64 {
    let bounds = stage.until.iter().flat_map(|until| [until.load_above, until.load_below]);
    bounds.flatten().map(f64::abs).reduce(f64::max).unwrap_or(1.0)
}

/// `ℓ` and `φ`.
fn scales(model: &Model, analysis: &Analysis) -> (f64, f64) {
    let (mut longest, mut softest, mut spring) = (0.0_f64, f64::INFINITY, 0.0_f64);
    for element in &model.elements {
        match element {
            request::Element::Bar { nodes, axial_stiffness, .. } => {
                let ends = (&model.nodes[&nodes[0]], &model.nodes[&nodes[1]]);
                let difference: Vec<f64> = ends.0.iter().zip(ends.1).map(|(a, b)| a - b).collect();
                longest = longest.max(norm(&difference));
                softest = softest.min(*axial_stiffness);
            }
            request::Element::Spring { stiffness, .. } => {
                spring = spring.max(norm(&stiffness.concat()));
            }
        }
    }
    let (mut largest_load, mut largest_motion) = (0.0_f64, 0.0_f64);
    for stage in &model.stages {
        let factor = expected_load_factor(stage);
        for force in stage.forces.values() {
            largest_load = largest_load.max(factor * norm(force));
        }
        for motion in stage.displacements.values().chain(stage.obstacle_motion.values()) {
            largest_motion = largest_motion.max(factor * norm(motion));
        }
    }
    let (mut length, mut force) = if longest > 0.0 {
        (longest, softest)
    } else if spring > 0.0 && largest_load.max(spring * largest_motion) > 0.0 {
        let force = largest_load.max(spring * largest_motion);
        (force / spring, force)
    } else {
        (1.0, 1.0)
    };
    if let Some(given) = analysis.arc_length.displacement_scale {
        if longest == 0.0 && spring > 0.0 {
            force = spring * given;
        }
        length = given;
    }
    (length, force)
}

fn build_structure(model: &Model, numbers: &HashMap<&str, usize>, length: f64, force: f64) -> Structure {
    let dimension = model.dimension;
    let mut supported = vec![false; model.nodes.len() * dimension];
    for (name, components) in &model.supports {
        for component in components {
            supported[numbers[name.as_str()] * dimension + component.index()] = true;
        }
    }
    let elements = model
        .elements
        .iter()
        .map(|element| match element {
            request::Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain } => {
                let nodes = [numbers[nodes[0].as_str()], numbers[nodes[1].as_str()]];
                let mut vector = [0.0; 3];
                // A difference of places as given: a place far from the origin costs no digits.
                (0..dimension).for_each(|k| vector[k] = (model.nodes[nodes[1]][k] - model.nodes[nodes[0]][k]) / length);
                let squared: f64 = vector.iter().map(|value| value * value).sum();
                let rest = rest_length.map_or(squared.sqrt(), |rest| rest / length);
                Element::Bar(Bar {
                    nodes,
                    reference: vector,
                    axial_stiffness: axial_stiffness / force,
                    rest_length: rest,
                    initial_elongation: squared.sqrt() - rest,
                    prestress: prestress / force,
                    strain: *strain,
                })
            }
            request::Element::Spring { nodes, stiffness } => {
                let mut matrix = [[0.0; 3]; 3];
                for (row, values) in stiffness.iter().enumerate() {
                    for (column, value) in values.iter().enumerate() {
                        matrix[row][column] = value / force * length;
                    }
                }
                Element::Spring(Spring {
                    node: numbers[nodes[0].as_str()],
                    other: nodes.get(1).map(|name| numbers[name.as_str()]),
                    stiffness: matrix,
                })
            }
        })
        .collect();
    Structure::new(dimension, &supported, elements)
}

/// The contacts that are solved for, and those of the request.
struct Contacts {
    contacts: Vec<Contact>,
    contact_names: Vec<(Arc<str>, Arc<str>)>,
    reported: Vec<Reported>,
    corners: Vec<Corner>,
}

/// Planes whose normals and gaps (dimensionless) differ by less than this are one.
const COINCIDENT: f64 = 1e-13;

fn build_contacts(
    model: &Model,
    numbers: &HashMap<&str, usize>,
    length: f64,
    structure: &Structure,
    left_out: &mut Vec<LeftOut>,
) -> Contacts {
    let mut contacts: Vec<Contact> = Vec::new();
    let mut contact_names: Vec<(Arc<str>, Arc<str>)> = Vec::new();
    let mut reported: Vec<Reported> = Vec::new();
    // Which contacts of the request each one stands for.
    let mut members: Vec<Vec<usize>> = Vec::new();
    let mut of_node: HashMap<usize, Vec<usize>> = HashMap::new();
    // By node and gap, so that only those of nearly the same gap are compared.
    let mut by_gap: HashMap<usize, BTreeMap<u64, Vec<usize>>> = HashMap::new();
    for (index, contact) in model.contacts.iter().enumerate() {
        let built = build_contact(model, contact, numbers[contact.node.as_str()], length, structure);
        if built.friction == 0.0 && contact.friction > 0.0 {
            left_out.push(LeftOut {
                what: format!("friction of {} on {}", contact.node, contact.obstacle),
                why: "the node's supports leave it no motion along the obstacle".to_owned(),
            });
        }
        let (node, obstacle) = (Arc::from(contact.node.as_str()), Arc::from(contact.obstacle.as_str()));
        let moves_with = |other: &request::Contact| {
            let motion = |stage: &request::Stage, name: &str| stage.obstacle_motion.get(name).cloned();
            model.stages.iter().all(|stage| motion(stage, &contact.obstacle) == motion(stage, &other.obstacle))
        };
        let neighbours = of_node.entry(built.node).or_default();
        let alike = by_gap.entry(built.node).or_default();
        let (gap, near) = (built.initial_gap, COINCIDENT * (1.0 + built.initial_gap.abs()));
        let twin = alike
            .range(ordered(gap - near)..=ordered(gap + near))
            .flat_map(|(_, others)| others.iter().copied())
            .filter(|other| coincide(&contacts[*other], &built) && moves_with(&model.contacts[members[*other][0]]))
            .min();
        let place = twin.unwrap_or(contacts.len());
        if twin.is_none() {
            neighbours.push(place);
            alike.entry(ordered(gap)).or_default().push(place);
            contacts.push(built);
            contact_names.push((Arc::clone(&node), Arc::clone(&obstacle)));
            members.push(Vec::new());
        }
        members[place].push(index);
        reported.push(Reported {
            node,
            obstacle,
            contact: place,
            normal_share: 1.0,
            tangential_share: 1.0,
            shared: false,
        });
    }
    for (contact, members) in contacts.iter_mut().zip(&members).filter(|(_, members)| members.len() > 1) {
        // Pressed equally, which is least; each carries of the traction what its friction bears.
        let number = members.len() as f64;
        let total: f64 = members.iter().map(|member| model.contacts[*member].friction).sum();
        for member in members {
            let part = if total > 0.0 { model.contacts[*member].friction / total } else { 1.0 / number };
            let one = &mut reported[*member];
            (one.normal_share, one.tangential_share, one.shared) = (1.0 / number, part, true);
        }
        if contact.sliding.directions() > 0 {
            contact.friction = total / number;
        }
    }
    // In the order of the contacts, so that the numbering does not depend on a hash.
    let corners = contacts
        .iter()
        .enumerate()
        .filter_map(|(index, contact)| of_node.get(&contact.node).filter(|all| all.len() > 1 && all[0] == index))
        .map(|contacts| Corner { contacts: contacts.clone() })
        .collect();
    Contacts { contacts, contact_names, reported, corners }
}

/// Numbers in the order of these.
fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    if value.is_sign_negative() { !bits } else { bits | (1 << 63) }
}

/// Whether two contacts are one: the same node before the same surface.
fn coincide(first: &Contact, second: &Contact) -> bool {
    let near = |a: &Vector, b: &Vector| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= COINCIDENT);
    let surfaces = match (&first.obstacle, &second.obstacle) {
        (Obstacle::Plane { normal: a }, Obstacle::Plane { normal: b }) => near(a, b),
        (Obstacle::Ball { offset: a, side: x }, Obstacle::Ball { offset: b, side: y }) => near(a, b) && x == y,
        (Obstacle::Plane { .. }, Obstacle::Ball { .. }) | (Obstacle::Ball { .. }, Obstacle::Plane { .. }) => false,
    };
    first.node == second.node && surfaces && (first.initial_gap - second.initial_gap).abs() <= COINCIDENT
}

fn build_contact(
    model: &Model,
    contact: &request::Contact,
    node: usize,
    length: f64,
    structure: &Structure,
) -> Contact {
    let dimension = model.dimension;
    let place = &model.nodes[&contact.node];
    // What is within the round-off of the coordinates is contact.
    let snapped = |gap: f64, reach: f64| {
        let closed = gap.abs() <= PENETRATION_TOLERANCE * length + 4.0 * f64::EPSILON * reach;
        if closed { 0.0 } else { gap / length }
    };
    let reach = |values: &[f64]| place.iter().chain(values).fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let (obstacle, initial_gap) = match &model.obstacles[&contact.obstacle] {
        request::Obstacle::Ball { center, radius, side } => {
            let mut offset = [0.0; 3];
            (0..dimension).for_each(|k| offset[k] = (place[k] - center[k]) / length);
            let side = match side {
                Side::Outside => 1.0,
                Side::Inside => -1.0,
            };
            let gap = side * (size(&offset) * length - radius);
            (Obstacle::Ball { offset, side }, snapped(gap, reach(center).max(*radius)))
        }
        request::Obstacle::Plane { point, normal } => {
            let largest = normal.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            let size = norm(&normal.iter().map(|value| value / largest).collect::<Vec<f64>>()) * largest;
            let mut unit = [0.0; 3];
            normal.iter().enumerate().for_each(|(k, value)| unit[k] = value / size);
            let gap: f64 = (0..dimension).map(|k| (place[k] - point[k]) * unit[k]).sum();
            (Obstacle::Plane { normal: unit }, snapped(gap, reach(point)))
        }
    };
    let sliding = sliding(structure, node);
    let friction = if sliding.directions() == 0 { 0.0 } else { contact.friction };
    Contact { node, obstacle, initial_gap, friction, sliding }
}

/// In which directions a node can slide, by its supports.
fn sliding(structure: &Structure, node: usize) -> Sliding {
    let dimension = structure.dimension;
    let held: Vec<usize> = (0..dimension).filter(|k| structure.unknown_of[node * dimension + k].is_none()).collect();
    match (dimension, held.as_slice()) {
        (2, []) => Sliding::Line { across: [0.0, 0.0, 1.0] },
        (3, []) => Sliding::Plane,
        (3, [component]) => {
            let mut across = [0.0; 3];
            across[*component] = 1.0;
            Sliding::Line { across }
        }
        _ => Sliding::None,
    }
}

/// The model made dimensionless, as far as its stages need it.
struct Scaled<'a> {
    model: &'a Model,
    analysis: &'a Analysis,
    numbers: &'a HashMap<&'a str, usize>,
    structure: &'a Structure,
    /// The request's contact of each contact that is solved for.
    first_contacts: &'a [usize],
    length: f64,
    force: f64,
}

fn build_stage(stage: &request::Stage, scaled: &Scaled<'_>) -> StageLoad {
    let &Scaled { model, analysis, numbers, structure, first_contacts, length, force } = scaled;
    let dimension = structure.dimension;
    let largest = |vectors: &IndexMap<String, Vec<f64>>| vectors.values().map(|v| norm(v)).fold(0.0_f64, f64::max);
    let by_force = force / largest(&stage.forces);
    let by_motion = length / largest(&stage.displacements).max(largest(&stage.obstacle_motion));
    let natural = by_force.min(by_motion);
    let natural = if natural.is_finite() { natural } else { 1.0 };
    let load_scale = analysis.arc_length.load_scale.unwrap_or(natural);
    let over_freedoms = |vectors: &IndexMap<String, Vec<f64>>, unit: f64| {
        let mut values = vec![0.0; structure.freedoms()];
        for (name, vector) in vectors {
            for (component, value) in vector.iter().enumerate() {
                values[numbers[name.as_str()] * dimension + component] = value * load_scale / unit;
            }
        }
        values
    };
    let shift = |contact: &request::Contact| {
        let mut shift: Vector = [0.0; 3];
        if let Some(motion) = stage.obstacle_motion.get(&contact.obstacle) {
            motion.iter().enumerate().for_each(|(k, value)| shift[k] = value * load_scale / length);
        }
        shift
    };
    let supports_move = model.stages.iter().any(|stage| largest(&stage.displacements) > 0.0);
    let pattern = LoadPattern {
        forces: over_freedoms(&stage.forces, force),
        supports: if supports_move { over_freedoms(&stage.displacements, length) } else { Vec::new() },
        shifts: first_contacts.iter().map(|contact| shift(&model.contacts[*contact])).collect(),
    };
    let mut ends = Vec::new();
    if let Some(until) = &stage.until {
        let load = |bound: f64, sign: f64| End::Load { bound: bound / load_scale, sign };
        ends.extend(until.load_above.map(|bound| load(bound, 1.0)));
        ends.extend(until.load_below.map(|bound| load(bound, -1.0)));
        if let Some(given) = &until.displacement {
            let freedom = numbers[given.node.as_str()] * dimension + given.component.index();
            let end = |bound: f64, sign: f64| End::Displacement { freedom, bound: bound / length, sign };
            ends.extend(given.above.map(|bound| end(bound, 1.0)));
            ends.extend(given.below.map(|bound| end(bound, -1.0)));
        }
        ends.extend(until.limit_points.map(End::LimitPoints));
        ends.extend(until.contact_change.map(End::ContactChanges));
        ends.extend(until.increments.map(End::Increments));
    }
    let loads = stage.until.as_ref().map(|until| [until.load_above, until.load_below]);
    let given_loads = loads.into_iter().flatten().flatten().collect();
    StageLoad { name: Arc::from(stage.name.as_str()), pattern, load_scale, ends, given_loads }
}
