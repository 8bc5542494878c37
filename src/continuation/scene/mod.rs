//! The scene: a request checked, numbered and made dimensionless for tracing.
//!
//! Lengths are divided by `displacement_scale` `ℓ`, forces by `force_scale` `φ`, each stage's load factor by its
//! `load_scale` `σ`; a pattern `f` becomes `f σ/φ`. By default `ℓ` is the longest bar and `φ` the smallest axial
//! stiffness of the bars that resist the load. Without bars, `φ` is the largest force of any stage at the load factor
//! at which the stage is to end (1 where it specifies none), or the stiffness of the springs that resist the load (the
//! largest Frobenius norm) times the largest prescribed motion if this is larger, and `ℓ` is this force divided by this
//! stiffness. The resisting stiffness is found by `characteristic_stiffness`, unless the bars' stiffnesses differ by no
//! more than a factor of two. With beams, `ℓ` is the diagonal of the box around the nodes and `φ` the smallest bending
//! stiffness over `ℓ²`. `σ` is the smaller of `φ / max |f|`, with the `φ` of the stiffness that resists the
//! stage's own load, and `ℓ / max |motion|`. All scales follow the units of the input, so that a change of units
//! changes nothing but round-off.

pub(crate) mod admissibility;
pub(crate) mod build;
pub(crate) mod characteristic_stiffness;
mod elements;
pub(crate) mod omitted_features;
pub(crate) mod recorded_contacts;
pub(crate) mod reported;
mod rigid_surfaces;
pub(crate) mod scales;
mod solid_loads;
mod solid_scales;
pub(crate) mod stage_load;
pub(crate) mod tolerances;
mod turning_obstacles;
mod warnings;

use crate::mechanics::contact::ContactPair;
use crate::mechanics::problem::node_contact_forces::Corner;
use crate::mechanics::problem::state::State;
use crate::mechanics::structure::Structure;
use crate::mechanics::structure::basis_transformation::BasisTransformation;
use crate::mechanics::structure::element_list::ElementList;
use crate::model::request::{Analysis, JobRequest, Model};
use crate::model::{InputError, InputErrors};
use crate::resources::budget::{self, Breach, Budget};
use crate::result::nodal_values::NodalValues;
use crate::result::plan::Plan;
use build::{Contacts, ScaledModel, build_contacts, build_stage, build_structure, first_contacts};
use indexmap::IndexSet;
use reported::RecordedForces;
pub(crate) use reported::Reported;
use scales::{RequestScales, scales};
use solid_loads::LoadedSolids;
pub(crate) use stage_load::StageLoad;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;
use turning_obstacles::TurningObstacles;

/// The data of a path; shared by all paths of the scene.
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) structure: Structure,
    /// From the unknowns to the displacements of the nodes.
    pub(crate) basis: BasisTransformation,
    /// Contacts that are solved for; coincident contacts of a node are merged into one.
    pub(crate) contacts: Vec<ContactPair>,
    /// Names of the nodes and obstacles of these contacts.
    pub(crate) contact_names: Vec<(Arc<str>, Arc<str>)>,
    /// The contacts of the request, in its order.
    pub(crate) reported: Vec<Reported>,
    /// Nodes with several contacts.
    pub(crate) corners: Vec<Corner>,
    /// Displacements without values, whose names those of each increment share.
    pub(crate) no_displacements: NodalValues,
    /// The elements and supports whose forces an increment has.
    pub(crate) recorded_forces: RecordedForces,
    pub(crate) stages: Vec<StageLoad>,
    pub(crate) analysis: Analysis,
    /// Indices of the request's contacts that have a row in every increment, in reach or not; `None`: all.
    pub(crate) asked_rows: Option<Vec<usize>>,
    /// Whether straight stretches are traced as one increment each.
    pub(crate) jumps: bool,
    plan: Plan,
}

/// Elements and contacts that a request cannot express, dimensionless by the scales of the request itself.
#[derive(Debug, Default)]
pub(crate) struct AdditionalParts {
    pub elements: ElementList,
    /// Contacts, each with the names of its node and its obstacle.
    pub contacts: Vec<(&'static str, &'static str, ContactPair)>,
}

/// Adds what contacts of several nodes couple to the layout of the tangent: the own nodes of each with all that move it,
/// and the nodes of the surface that it touches with each other, once for each surface.
fn couple(structure: &mut Structure, contacts: &[ContactPair]) {
    let coupled: Vec<&ContactPair> = contacts.iter().filter(|contact| contact.kinematics.node().is_none()).collect();
    if coupled.is_empty() {
        return;
    }
    let touched: IndexSet<&[usize]> = coupled.iter().map(|contact| contact.kinematics.touched_nodes()).collect();
    let own = coupled.iter().map(|contact| {
        let kinematics = &contact.kinematics;
        [kinematics.own_nodes().to_vec(), kinematics.nodes().to_vec()]
    });
    let couplings = own.chain(touched.into_iter().map(|nodes| [nodes.to_vec(), nodes.to_vec()])).collect();
    structure.couple(couplings);
}

/// Zero displacements of all nodes, with the rotations of those that have one.
fn still(model: &Model) -> NodalValues {
    let components = |rotates: bool| vec![0.0; model.dimension + if rotates { model.rotations() } else { 0 }];
    let nodes = model.nodes.keys().zip(model.rotating_nodes());
    nodes.map(|(name, rotates)| (Arc::from(name.as_str()), components(rotates))).collect()
}

/// The parts of all stages between the turns of their loads, and the load scale of each stage.
fn build_stages(scaled: &ScaledModel<'_>, resistances: &[f64], contacts: usize) -> (Vec<StageLoad>, Vec<f64>) {
    let (mut parts, mut load_scales) = (Vec::new(), Vec::new());
    for (stage, force) in scaled.model.stages.iter().zip(resistances) {
        let mut built = build_stage(stage, *force, scaled);
        Arc::make_mut(&mut built.pattern).shifts.resize(contacts, [0.0; 3]);
        built.of_stage = Arc::clone(&built.pattern);
        load_scales.push(built.load_scale);
        parts.extend(built.between_turns(stage));
    }
    (parts, load_scales)
}

impl Scene {
    /// Checks the request as a whole and makes it dimensionless, within the budget of the present solve.
    ///
    /// # Errors
    /// Errors of the request, and a structure whose matrices are too large for this budget.
    pub fn new(request: &JobRequest) -> Result<Self, InputErrors> {
        Self::like(None, request)
    }

    /// As [`new`](Self::new), given the scene of a request that may differ in numbers alone: data that do not depend on
    /// these numbers are taken from that scene.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn like(other: Option<&Self>, request: &JobRequest) -> Result<Self, InputErrors> {
        Self::with_parts(other, request, AdditionalParts::default())
    }

    /// As [`like`](Self::like), with elements and contacts in addition to those of the request.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub(crate) fn with_parts(
        other: Option<&Self>,
        request: &JobRequest,
        parts: AdditionalParts,
    ) -> Result<Self, InputErrors> {
        let other = other.map(|other| &other.structure);
        Budget::under_way(budget::cancel_flag()).during(|| Self::built(request, other, parts)).unwrap_or_else(
            |breach| {
                let what = match breach {
                    Breach::Cancelled => budget::end(breach),
                    Breach::Memory { .. } => "the model is too large",
                    Breach::FactorEntries { .. } | Breach::FactorWork { .. } => {
                        "the elements join too many nodes to too many others"
                    }
                };
                Err(InputErrors(vec![InputError::new("/model/elements", format!("{what}: {breach}"))]))
            },
        )
    }

    fn built(request: &JobRequest, like: Option<&Structure>, parts: AdditionalParts) -> Result<Self, InputErrors> {
        crate::model::check::check(request)?;
        let model = &request.model;
        let numbers: HashMap<&str, usize> =
            model.nodes.keys().enumerate().map(|(number, name)| (name.as_str(), number)).collect();
        let loaded_solids = LoadedSolids::new(model, &numbers);
        let scales = scales(model, &request.analysis, &numbers, &loaded_solids, like);
        let RequestScales { length, force, resistances, stretched, structure } = scales;
        let mut structure =
            build_structure(model, &numbers, (length, force), &loaded_solids, structure.as_ref().or(like));
        if !parts.elements.is_empty() {
            structure = structure.with_elements(&parts.elements);
        }
        let mut left_out = Vec::new();
        let turning = TurningObstacles::of(model);
        let Contacts { mut contacts, mut contact_names, mut reported, corners } =
            build_contacts(model, &numbers, length, (&structure, &turning, &loaded_solids.basis), &mut left_out);
        let first_contacts = first_contacts(&reported, contacts.len());
        for (node, obstacle, contact) in parts.contacts {
            let (node, obstacle) = (Arc::<str>::from(node), Arc::<str>::from(obstacle));
            contact_names.push((Arc::clone(&node), Arc::clone(&obstacle)));
            reported.push(Reported {
                node,
                obstacle,
                contact: contacts.len(),
                normal_share: 1.0,
                tangential_share: 1.0,
                shared: false,
            });
            contacts.push(contact);
        }
        couple(&mut structure, &contacts);
        let scaled = ScaledModel {
            model,
            analysis: &request.analysis,
            numbers: &numbers,
            structure: &structure,
            loaded_solids: &loaded_solids,
            turning: &turning,
            first_contacts: &first_contacts,
            length,
            force,
            stretched,
        };
        let (stages, load_scales) = build_stages(&scaled, &resistances, contacts.len());
        let plan = Plan {
            unknowns: structure.unknowns() as u64,
            contacts: reported.len() as u64,
            stages: model.stages.len() as u64,
            displacement_scale: length,
            force_scale: force,
            load_scales,
            left_out,
            warnings: warnings::warnings(request),
        };
        let no_displacements = still(model);
        let analysis = request.analysis.clone();
        let asked_rows = crate::continuation::scene::recorded_contacts::asked_rows(request);
        let jumps = crate::continuation::scene::omitted_features::jumps(&analysis, &structure);
        let mut scene = Self {
            structure,
            basis: loaded_solids.basis,
            contacts,
            contact_names,
            reported,
            corners,
            no_displacements,
            recorded_forces: RecordedForces::of(request),
            stages,
            analysis,
            asked_rows,
            jumps,
            plan,
        };
        scene.plan.left_out.extend(crate::continuation::scene::omitted_features::left_out(&scene));
        admissibility::refuse_mechanism(&scene, model)?;
        admissibility::refuse_imbalance(&scene)?;
        admissibility::refuse_dragged_supports(&scene, model)?;
        Ok(scene)
    }

    fn node_name(&self, node: usize) -> &str {
        self.no_displacements.get_index(node).map_or("", |(name, _)| name)
    }

    /// What increments report of the nodes' motion by a vector over all degrees of freedom: translations times `unit`, and the rotation of a
    /// node that has one.
    pub(crate) fn nodal_motion(&self, values: &[f64], unit: f64) -> NodalValues {
        let (structure, mut components) = (&self.structure, Vec::with_capacity(values.len()));
        let mut values = Cow::Borrowed(values);
        if !self.basis.is_identity() {
            self.basis.displacements(&structure.numbering, values.to_mut());
        }
        for (node, reported) in self.no_displacements.values().enumerate() {
            for (place, freedom) in structure.freedoms_of(node).enumerate().take(reported.len()) {
                components.push(if place < structure.dimension { values[freedom] * unit } else { values[freedom] });
            }
        }
        self.no_displacements.with_components(components)
    }

    /// The arc length between two states as increments report it, by the displacements of the nodes, given that by the
    /// unknowns.
    pub(crate) fn arc_length(&self, from: &State, to: &State, by_unknowns: f64) -> f64 {
        let (from, to) = (&from.displacement, &to.displacement);
        self.basis.norm_of_displacements(&self.structure.numbering, from, to, by_unknowns)
    }

    /// The plan: features that the scene needs and those omitted.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}
