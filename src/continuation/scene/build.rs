//! Conversion of the request's names and units to dimensionless numbers.

use crate::continuation::scene::elements::ElementBuilder;
use crate::continuation::scene::reported::Reported;
use crate::continuation::scene::rigid_surfaces::RigidSurfaces;
use crate::continuation::scene::solid_loads::{LoadedSolids, add_pressure_faces, pressed_surfaces};
use crate::continuation::scene::stage_load::StageLoad;
use crate::continuation::scene::tolerances::{COINCIDENCE_TOLERANCE, MISSING_MOTION, SINGLE_MOTION};
use crate::continuation::scene::turning_obstacles::TurningObstacles;
use crate::mechanics::AUXILIARY_UNIT;
use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::kinematics::Kinematics;
use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::vector::{Vector, scaled, size};
use crate::mechanics::contact::{ContactPair, Sliding};
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::loading::LoadPattern;
use crate::mechanics::problem::node_contact_forces::Corner;
use crate::mechanics::structure::Structure;
use crate::mechanics::structure::basis_transformation::{BasisTransformation, extrapolated};
use crate::model::request::{self, Analysis, Model};
use crate::model::solids::contact_surfaces::{BodyContact, ContactSurfaces};
use crate::resources::budget;
use crate::result::plan::LeftOut;
use indexmap::IndexMap;
use nalgebra::{Matrix3, SymmetricEigen};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// The Euclidean norm, so that the scales do not depend on the axes.
pub(super) fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// Builds the structure; `like`: a structure that may be identical except for its numbers.
pub(super) fn build_structure(
    model: &Model,
    numbers: &HashMap<&str, usize>,
    (length, force): (f64, f64),
    loaded_solids: &LoadedSolids<'_>,
    like: Option<&Structure>,
) -> Structure {
    let dimension = model.dimension;
    let of_node = |(name, components): (&String, &Vec<_>)| -> Vec<(usize, usize)> {
        components
            .iter()
            .map(|component: &request::Component| (numbers[name.as_str()], component.place(dimension)))
            .collect()
    };
    let mut supports: Vec<(usize, usize)> = model.supports.iter().flat_map(of_node).collect();
    let mut elements = ElementBuilder::new(model, numbers, length, force).build(&loaded_solids.basis);
    let pressed = pressed_surfaces(model);
    add_pressure_faces(model, loaded_solids, length, &mut elements);
    let nodes = model.nodes.len() + pressed.len() + TurningObstacles::of(model).auxiliary_nodes();
    let held = (model.nodes.len()..nodes).chain(loaded_solids.basis.following());
    supports.extend(held.flat_map(|node| (0..dimension).map(move |k| (node, k))));
    Structure::like(like, dimension, nodes, &supports, elements)
}

/// The contacts that are solved for, and the contacts of the request.
pub(super) struct Contacts {
    pub contacts: Vec<ContactPair>,
    pub contact_names: Vec<(Arc<str>, Arc<str>)>,
    pub reported: Vec<Reported>,
    pub corners: Vec<Corner>,
}

pub(super) fn build_contacts(
    model: &Model,
    numbers: &HashMap<&str, usize>,
    length: f64,
    (structure, turning, basis): (&Structure, &TurningObstacles<'_>, &BasisTransformation),
    left_out: &mut Vec<LeftOut>,
) -> Contacts {
    let mut contacts: Vec<ContactPair> = Vec::new();
    let mut contact_names: Vec<(Arc<str>, Arc<str>)> = Vec::new();
    let mut reported: Vec<Reported> = Vec::new();
    // The contacts of the request that each contact stands for.
    let mut members: Vec<Vec<usize>> = Vec::new();
    let mut of_node: HashMap<usize, Vec<usize>> = HashMap::new();
    // By node and gap, so that only contacts of nearly the same gap are compared.
    let mut by_gap: HashMap<usize, BTreeMap<u64, Vec<usize>>> = HashMap::new();
    let rigid = RigidSurfaces::of(model, length);
    let surfaces = ContactSurfaces::new(model, length);
    for (index, contact) in model.contacts.iter().enumerate() {
        budget::spend(1);
        let node_number = numbers[contact.node.as_str()];
        let built = match contact.against {
            Some(_) => match surfaces.contact(contact, node_number) {
                Ok(body) => between_bodies(contact, body, structure),
                // What was checked makes a contact.
                Err(_) => continue,
            },
            None => {
                let (place, gap) = place_and_gap(model, contact, node_number, basis, &rigid);
                let kinematics = turning.kinematics(contact, node_number, &place, length);
                let built = build_contact(contact, (node_number, &place, gap), &rigid, structure);
                ContactPair { kinematics: kinematics.unwrap_or(Kinematics::Node(node_number)), ..built }
            }
        };
        if !built.friction.is_rough() && contact.friction > 0.0 {
            left_out.push(friction_left_out(contact));
        }
        let (node, obstacle) = (Arc::from(contact.node.as_str()), Arc::from(contact.counterpart()));
        let moves_with = |other: &request::Contact| {
            let motion = |stage: &request::Stage, name: &str| stage.obstacle_motion.get(name).cloned();
            model.stages.iter().all(|stage| motion(stage, &contact.obstacle) == motion(stage, &other.obstacle))
        };
        let neighbours = of_node.entry(node_number).or_default();
        let alike = by_gap.entry(node_number).or_default();
        let (gap, near) = (built.initial_gap, COINCIDENCE_TOLERANCE * (1.0 + built.initial_gap.abs()));
        let twin = alike
            .range(ordered(gap - near)..=ordered(gap + near))
            .flat_map(|(_, others)| others.iter().copied())
            .filter(|other| coincide(&contacts[*other], &built) && moves_with(&model.contacts[members[*other][0]]))
            .min();
        let place = twin.unwrap_or(contacts.len());
        if twin.is_none() {
            // What touches bodies, or obstacles that turn, is in axes of its own.
            if built.kinematics.node().is_some() {
                neighbours.push(place);
            }
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
    share_among_coincident(model, &mut contacts, &members, &mut reported);
    let corners = corners(&contacts, &of_node);
    Contacts { contacts, contact_names, reported, corners }
}

fn friction_left_out(contact: &request::Contact) -> LeftOut {
    LeftOut {
        what: format!("friction of {} on {}", contact.node, contact.counterpart()),
        why: "the node's supports leave it no motion along the obstacle".to_owned(),
    }
}

/// The nodes with several contacts, in the order of these, so that the numbering does not depend on a hash.
fn corners(contacts: &[ContactPair], of_node: &HashMap<usize, Vec<usize>>) -> Vec<Corner> {
    let of_contact = |(index, contact): (usize, &ContactPair)| {
        let all = of_node.get(&contact.kinematics.node()?)?;
        (all.len() > 1 && all[0] == index).then(|| Corner { contacts: all.clone() })
    };
    contacts.iter().enumerate().filter_map(of_contact).collect()
}

/// Divides the reaction of each contact among the coincident contacts of the request that it stands for.
fn share_among_coincident(
    model: &Model,
    contacts: &mut [ContactPair],
    members: &[Vec<usize>],
    reported: &mut [Reported],
) {
    for (contact, members) in contacts.iter_mut().zip(members).filter(|(_, members)| members.len() > 1) {
        // Equal normal shares, which have the least norm; each contact takes the share of the traction that its
        // friction can carry.
        let number = members.len() as f64;
        let total: f64 = members.iter().map(|member| model.contacts[*member].friction).sum();
        for member in members {
            let part = if total > 0.0 { model.contacts[*member].friction / total } else { 1.0 / number };
            let one = &mut reported[*member];
            (one.normal_share, one.tangential_share, one.shared) = (1.0 / number, part, true);
        }
        if contact.sliding.directions() > 0 {
            contact.friction = CoulombFriction::new(total / number);
        }
    }
}

/// For each contact that is solved for, the first of its contacts in the request, which provides its data.
pub(super) fn first_contacts(reported: &[Reported], count: usize) -> Vec<usize> {
    let mut first: Vec<usize> = Vec::with_capacity(count);
    for (index, one) in reported.iter().enumerate() {
        if one.contact == first.len() {
            first.push(index);
        }
    }
    first
}

/// An integer with the same ordering as the number.
fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    if value.is_sign_negative() { !bits } else { bits | (1 << 63) }
}

/// Whether two contacts coincide: the same node and the same surface.
fn coincide(first: &ContactPair, second: &ContactPair) -> bool {
    first.kinematics.own_nodes().len() == 1
        && first.kinematics.nodes() == second.kinematics.nodes()
        && first.obstacle.coincides(&second.obstacle, COINCIDENCE_TOLERANCE)
        && (first.initial_gap - second.initial_gap).abs() <= COINCIDENCE_TOLERANCE
}

/// The place of a node whose contact with an obstacle is solved for, and the gap there if it is not that of the place: where
/// the unknown of a middle of an edge is that of a [transformed basis](crate::mechanics::structure::basis_transformation),
/// the combination of the gaps at the edge. One below zero, where a coarse face bulges, counts as closed.
fn place_and_gap(
    model: &Model,
    contact: &request::Contact,
    node: usize,
    basis: &BasisTransformation,
    surfaces: &RigidSurfaces<'_>,
) -> (Vec<f64>, Option<f64>) {
    let place = &model.nodes[node];
    let Some(ends) = basis.extrapolated_from(node) else { return (place.clone(), None) };
    let ends = ends.map(|end| &model.nodes[end]);
    let gap = |place: &[f64]| surfaces.at(&contact.obstacle, place).1;
    let combined = extrapolated(gap(place), ends.map(|end| gap(end)));
    let coordinates = place.iter().enumerate().map(|(k, value)| extrapolated(*value, ends.map(|end| end[k])));
    (coordinates.collect(), Some(combined.max(0.0)))
}

/// `at`: the node with the place and the gap of [`place_and_gap`].
fn build_contact(
    contact: &request::Contact,
    (node, place, gap): (usize, &[f64], Option<f64>),
    surfaces: &RigidSurfaces<'_>,
    structure: &Structure,
) -> ContactPair {
    let (obstacle, gap_of_place) = surfaces.at(&contact.obstacle, place);
    let initial_gap = gap.unwrap_or(gap_of_place);
    let sliding = sliding(structure, node);
    let coefficient = if sliding.directions() == 0 { 0.0 } else { contact.friction };
    let friction = CoulombFriction::new(coefficient);
    ContactPair { kinematics: Kinematics::Node(node), obstacle, initial_gap, friction, sliding }
}

/// A contact of bodies, in the axes of the surfaces: along them, then across.
///
/// Where supports leave the two surfaces fewer relative motions at the node than there are axes, as on an axis of symmetry,
/// friction along the missing ones does no work of its own and its share of the reaction would be undetermined.
fn between_bodies(contact: &request::Contact, body: BodyContact, structure: &Structure) -> ContactPair {
    let normal = if structure.dimension == 2 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let mut built = ContactPair {
        kinematics: Kinematics::Coupled(body.kinematics),
        obstacle: RigidSurface::Plane { normal },
        initial_gap: body.gap,
        friction: CoulombFriction::new(contact.friction),
        sliding: Sliding::Line { across: [0.0, 0.0, 1.0] },
    };
    let products = products_of_free_motions(structure, &built);
    if structure.dimension == 3 {
        built.sliding = sliding_between(&products);
    } else {
        let ([along, both, _], across) = (products[0], products[1][1]);
        if along * across - both * both <= SINGLE_MOTION * (along + across).powi(2) && across > 0.0 {
            built.sliding = Sliding::None;
        }
    }
    if built.sliding == Sliding::None {
        built.friction = CoulombFriction::new(0.0);
    }
    built
}

/// Sums of the products of the columns of free components at the start, in the axes of a contact of bodies.
pub(super) fn products_of_free_motions(structure: &Structure, contact: &ContactPair) -> [[f64; 3]; 3] {
    let mut products = [[0.0; 3]; 3];
    contact_jacobian::each_column(structure, contact, &vec![0.0; structure.freedoms()], |freedom, column| {
        if structure.unknown_of[freedom].is_some() {
            for (row, left) in products.iter_mut().zip(column) {
                row.iter_mut().zip(column).for_each(|(sum, right)| *sum += left * right);
            }
        }
    });
    products
}

/// The directions along which two surfaces in space can slide, by the sums of products of the columns of free components.
fn sliding_between(products: &[[f64; 3]; 3]) -> Sliding {
    let eigen = SymmetricEigen::new(Matrix3::from_fn(|row, column| products[row][column]));
    let largest = eigen.eigenvalues.max();
    let missing = |value: f64| largest > 0.0 && value <= MISSING_MOTION * largest;
    let vectors = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    let missing: Vec<Vector> =
        vectors.filter(|(value, _)| missing(**value)).map(|(_, vector)| [vector[0], vector[1], 0.0]).collect();
    match missing.as_slice() {
        [] => Sliding::Plane,
        [across] if size(across) > 0.5 => Sliding::Line { across: scaled(across, 1.0 / size(across)) },
        [_] => Sliding::Plane,
        _ => Sliding::None,
    }
}

/// The directions in which a node can slide, given its supports.
fn sliding(structure: &Structure, node: usize) -> Sliding {
    let dimension = structure.dimension;
    let freedoms = structure.translations_of(node);
    let held: Vec<usize> = (0..dimension).filter(|k| structure.unknown_of[freedoms.start + k].is_none()).collect();
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

/// The dimensionless model, as far as its stages need it.
pub(super) struct ScaledModel<'a> {
    pub model: &'a Model,
    pub analysis: &'a Analysis,
    pub numbers: &'a HashMap<&'a str, usize>,
    pub structure: &'a Structure,
    pub loaded_solids: &'a LoadedSolids<'a>,
    pub turning: &'a TurningObstacles<'a>,
    /// For each contact that is solved for, its contact in the request.
    pub first_contacts: &'a [usize],
    pub length: f64,
    pub force: f64,
    /// `ℓ` relative to its default value.
    pub stretched: f64,
}

impl ScaledModel<'_> {
    /// The nodes whose supports a stage moves, each with the displacement of its degrees of freedom as a length: a
    /// rotation counts as the displacement of a point one length scale away.
    fn prescribed(&self, stage: &request::Stage) -> Vec<(usize, Vec<f64>)> {
        let dimension = self.structure.dimension;
        let lengths = |values: &Vec<f64>| {
            let unit = |place: usize| if place < dimension { 1.0 } else { self.length };
            values.iter().enumerate().map(|(place, value)| value * unit(place)).collect()
        };
        stage.displacements.iter().map(|(name, values)| (self.numbers[name.as_str()], lengths(values))).collect()
    }

    /// The load factor at which the largest load of a stage reaches `resistance`, or its largest motion the length scale.
    fn natural_load_scale(&self, stage: &request::Stage, resistance: f64, displacements: &[(usize, Vec<f64>)]) -> f64 {
        let largest = |vectors: &IndexMap<String, Vec<f64>>| vectors.values().map(|v| norm(v)).fold(0.0_f64, f64::max);
        let largest_moment = stage.moments.values().fold(0.0_f64, |most, moment| most.max(moment.abs()));
        let on_nodes = largest(&stage.forces).max(largest_moment / self.length);
        let by_force = resistance / on_nodes.max(self.loaded_solids.largest_resultant(stage));
        let driven = displacements.iter().map(|(_, values)| norm(values)).fold(0.0_f64, f64::max);
        let turned = stage.obstacle_rotation.values().fold(0.0_f64, |most, turn| most.max(turn.angle.abs()));
        let by_motion = self.length / driven.max(largest(&stage.obstacle_motion)).max(turned * self.length);
        let natural = by_force.min(by_motion);
        if natural.is_finite() { natural } else { 1.0 }
    }

    /// What a stage prescribes of each degree of freedom: displacements of supports, pressures and obstacles that turn by
    /// their auxiliary nodes. Empty where no stage prescribes anything.
    fn driven_supports(
        &self,
        stage: &request::Stage,
        displacements: &[(usize, Vec<f64>)],
        load_scale: f64,
    ) -> Vec<f64> {
        let &ScaledModel { model, structure, length, force, .. } = self;
        let moves = |stage: &request::Stage| stage.displacements.values().flatten().any(|value| *value != 0.0);
        let is_driven = |stage: &request::Stage| moves(stage) || !stage.pressures.is_empty();
        if self.turning.is_empty() && !model.stages.iter().any(is_driven) {
            return Vec::new();
        }
        let mut supports = vec![0.0; structure.freedoms()];
        for (node, values) in displacements {
            let freedoms = structure.freedoms_of(*node);
            freedoms.zip(values).for_each(|(freedom, value)| supports[freedom] = value * load_scale / length);
        }
        for (place, pressure) in self.loaded_solids.pressures(stage) {
            let freedom = structure.freedoms_of(model.nodes.len() + place).start;
            supports[freedom] = pressure * load_scale / force * length * length / AUXILIARY_UNIT;
        }
        let is_held = |freedom: usize| structure.unknown_of[freedom].is_none();
        self.loaded_solids.basis.prescribed(&structure.numbering, is_held, &mut supports);
        self.turning.each_support(stage, structure, |freedom, value, is_length| {
            supports[freedom] = value * load_scale / if is_length { length } else { 1.0 } / AUXILIARY_UNIT;
        });
        supports
    }

    /// The criteria that end a stage.
    fn ends(&self, stage: &request::Stage, load_scale: f64) -> Vec<End> {
        let mut ends = Vec::new();
        if let Some(until) = &stage.until {
            let load = |bound: f64, sign: f64| End::Load { bound: bound / load_scale, sign };
            ends.extend(until.load_above.map(|bound| load(bound, 1.0)));
            ends.extend(until.load_below.map(|bound| load(bound, -1.0)));
            if let Some(given) = &until.displacement {
                let place = given.component.place(self.structure.dimension);
                let freedom = self.structure.freedoms_of(self.numbers[given.node.as_str()]).start + place;
                let unit = if place < self.structure.dimension { self.length } else { 1.0 };
                let end = |bound: f64, sign: f64| End::Displacement { freedom, bound: bound / unit, sign };
                ends.extend(given.above.map(|bound| end(bound, 1.0)));
                ends.extend(given.below.map(|bound| end(bound, -1.0)));
            }
            ends.extend(until.limit_points.map(End::LimitPoints));
            ends.extend(until.contact_change.map(End::ContactChanges));
            ends.extend(until.increments.map(End::Increments));
        }
        ends
    }
}

/// Builds the load of a stage; `resistance` is the force on which its load scale is based.
pub(super) fn build_stage(stage: &request::Stage, resistance: f64, scaled: &ScaledModel<'_>) -> StageLoad {
    let &ScaledModel { model, analysis, numbers, structure, loaded_solids, turning, length, force, .. } = scaled;
    let first_contacts = scaled.first_contacts;
    // Forces and motions of supports, and shifts of obstacles.
    let held = budget::take::<f64>(2 * structure.freedoms() + 3 * first_contacts.len());
    budget::spend(structure.freedoms());
    let displacements: Vec<(usize, Vec<f64>)> = scaled.prescribed(stage);
    let natural = scaled.natural_load_scale(stage, resistance, &displacements);
    let load_scale = analysis.arc_length.load_scale.unwrap_or(natural);
    let enlarged = scaled.stretched.max(load_scale / natural).max(1.0);
    let mut forces = vec![0.0; structure.freedoms()];
    for (name, vector) in &stage.forces {
        let freedoms = structure.translations_of(numbers[name.as_str()]);
        freedoms.zip(vector).for_each(|(freedom, value)| forces[freedom] = value * load_scale / force);
    }
    loaded_solids.each_force(stage, |node, of_node| {
        let freedoms = structure.translations_of(node);
        freedoms.zip(of_node).for_each(|(freedom, value)| forces[freedom] += value * load_scale / force);
    });
    for (name, moment) in &stage.moments {
        let rotation = structure.numbering.rotations_of(numbers[name.as_str()]).start;
        forces[rotation] = moment * load_scale / force / length;
    }
    loaded_solids.basis.forces_on_unknowns(&structure.numbering, &mut forces);
    let supports = scaled.driven_supports(stage, &displacements, load_scale);
    let shift = |contact: &request::Contact| {
        let mut shift: Vector = [0.0; 3];
        // The motion of an obstacle that turns is within the kinematics of its contacts.
        let motion = stage.obstacle_motion.get(&contact.obstacle);
        if let Some(motion) = motion.filter(|_| !turning.has(&contact.obstacle)) {
            motion.iter().enumerate().for_each(|(k, value)| shift[k] = value * load_scale / length);
        }
        shift
    };
    let pattern = Arc::new(LoadPattern {
        forces,
        supports,
        shifts: first_contacts.iter().map(|contact| shift(&model.contacts[*contact])).collect(),
    });
    let ends = scaled.ends(stage, load_scale);
    let loads = stage.until.as_ref().map(|until| [until.load_above, until.load_below]);
    let given_loads = loads.into_iter().flatten().flatten().collect();
    StageLoad {
        name: Arc::from(stage.name.as_str()),
        of_stage: Arc::clone(&pattern),
        sense: 1.0,
        pattern,
        load_scale,
        offset: 0.0,
        control: stage.control,
        turns: false,
        enlarged,
        ends,
        given_loads,
        _held: Arc::new(held),
    }
}
