//! The loads of stages on solids and on the sides of bars and beams: consistent nodal forces of body forces and dead
//! tractions.
//!
//! ```text
//! f_a = V_a b,   V_a = ∫ N_a dV over the solids of a material;      f_a = A_a t,   A_a = ∫ N_a dA over a surface
//! ```
//!
//! The volumes and areas of the nodes are computed once for all stages. A pressure that follows its surface is an element
//! of the structure (`pressure_face`); its stages prescribe the degree of freedom that stands for it.

use crate::continuation::scene::build::norm;
use crate::continuation::scene::elements::ElementBuilder;
use crate::mechanics::structure::basis_transformation::BasisTransformation;
use crate::mechanics::structure::element_list::ElementList;
use crate::mechanics::structure::elements::solid::any::each_traction_force;
use crate::mechanics::structure::elements::solid::pressure_face::push_pressure_face;
use crate::model::request::{Model, Stage};
use crate::model::solids::data::{self, LoadedFace};
use crate::model::solids::faces::surface_faces;
use crate::model::solids::middle_nodes::basis_transformation;
use indexmap::IndexSet;
use std::collections::{BTreeMap, HashMap, HashSet};

/// What each node stands for: a volume or an area, in the user's units.
type NodalShares = BTreeMap<usize, f64>;

/// The volumes of nodes by material and their areas by surface, of those that some stage loads.
#[derive(Debug, Default)]
pub(super) struct LoadedSolids<'a> {
    volumes: HashMap<&'a str, NodalShares>,
    areas: HashMap<&'a str, NodalShares>,
    /// See [`pressed_surfaces`].
    pressed: IndexSet<&'a str>,
    /// Of the unknowns of solids.
    pub basis: BasisTransformation,
}

/// A component of unit size: its nodal forces are the shares of the nodes.
const UNIT: [f64; 3] = [1.0, 0.0, 0.0];

impl<'a> LoadedSolids<'a> {
    pub fn new(model: &'a Model, numbers: &'a HashMap<&'a str, usize>) -> Self {
        let (pressed, basis) = (pressed_surfaces(model), basis_transformation(model));
        let mut loaded = Self { pressed, basis, ..Self::default() };
        for stage in &model.stages {
            loaded.volumes.extend(stage.body_forces.keys().map(|name| (name.as_str(), NodalShares::new())));
            let surfaces = stage.tractions.keys().chain(stage.pressures.keys());
            loaded.areas.extend(surfaces.map(|name| (name.as_str(), NodalShares::new())));
        }
        if !loaded.volumes.is_empty() {
            let builder = ElementBuilder::new(model, numbers, 1.0, 1.0);
            for element in &model.elements {
                let Some((_, solid)) = element.solid() else { continue };
                let Some(shares) = loaded.volumes.get_mut(solid.material.as_str()) else { continue };
                let Some(built) = builder.solid(element) else { continue };
                built.each_body_force(UNIT, &mut |place, [volume, ..]| {
                    *shares.entry(numbers[solid.nodes[place].as_str()]).or_default() += volume;
                });
            }
        }
        if !loaded.areas.is_empty() {
            for (name, faces) in model.surfaces.keys().zip(surface_faces(model)) {
                let Some(shares) = loaded.areas.get_mut(name.as_str()) else { continue };
                faces.iter().filter_map(|face| data::loaded_face(model, face, 1.0)).for_each(|face| {
                    add_areas(&face, shares);
                });
            }
        }
        loaded
    }

    /// The loads of a stage: each with the shares of the nodes and the force per volume or area.
    fn loads(&self, stage: &Stage) -> impl Iterator<Item = (&NodalShares, [f64; 3])> {
        let bodies = stage
            .body_forces
            .iter()
            .filter_map(|(name, force)| Some((self.volumes.get(name.as_str())?, padded(force))));
        let tractions =
            stage.tractions.iter().filter_map(|(name, force)| Some((self.areas.get(name.as_str())?, padded(force))));
        bodies.chain(tractions)
    }

    /// Calls `each` with node and force of a stage's loads, in the user's units.
    pub fn each_force(&self, stage: &Stage, mut each: impl FnMut(usize, [f64; 3])) {
        for (shares, density) in self.loads(stage) {
            shares.iter().for_each(|(node, share)| each(*node, density.map(|value| share * value)));
        }
    }

    /// The pressures of a stage, in the user's units, each with the place of its surface among the pressed ones.
    pub fn pressures(&self, stage: &Stage) -> impl Iterator<Item = (usize, f64)> {
        stage.pressures.iter().filter_map(|(name, value)| Some((self.pressed.get_index_of(name.as_str())?, *value)))
    }

    /// The largest resultant of a load of a stage, in the user's units; it depends neither on the mesh nor on the axes.
    pub fn largest_resultant(&self, stage: &Stage) -> f64 {
        let resultant = |(shares, density): (&NodalShares, [f64; 3])| norm(&density) * shares.values().sum::<f64>();
        let pressed = |(name, pressure): (&String, &f64)| {
            let shares = self.areas.get(name.as_str()).into_iter().flat_map(NodalShares::values);
            pressure.abs() * shares.sum::<f64>()
        };
        let dead = self.loads(stage).map(resultant).fold(0.0, f64::max);
        stage.pressures.iter().map(pressed).fold(dead, f64::max)
    }
}

/// The surfaces that some stage presses, in the order of the model's surfaces. The auxiliary node of the first has the
/// number after the last node of the model, and so on.
pub(super) fn pressed_surfaces(model: &Model) -> IndexSet<&str> {
    let named: HashSet<&str> =
        model.stages.iter().flat_map(|stage| stage.pressures.keys()).map(String::as_str).collect();
    model.surfaces.keys().map(String::as_str).filter(|name| named.contains(name)).collect()
}

/// Adds the faces of the pressed surfaces to the elements.
pub(super) fn add_pressure_faces(
    model: &Model,
    LoadedSolids { pressed, basis, .. }: &LoadedSolids<'_>,
    length: f64,
    elements: &mut ElementList,
) {
    if pressed.is_empty() {
        return;
    }
    for (name, faces) in model.surfaces.keys().zip(surface_faces(model)) {
        let Some(place) = pressed.get_index_of(name.as_str()) else { continue };
        let auxiliary = model.nodes.len() + place;
        for LoadedFace { kind, idealisation, nodes, positions } in
            faces.iter().filter_map(|face| data::loaded_face(model, face, length))
        {
            push_pressure_face(elements, (kind, idealisation), &nodes, &positions, auxiliary, basis);
        }
    }
}

/// Adds the areas of the nodes of a face.
fn add_areas(face: &LoadedFace, shares: &mut NodalShares) {
    each_traction_force(face.kind, &face.positions, face.idealisation, UNIT, &mut |place, [area, ..]| {
        *shares.entry(face.nodes[place]).or_default() += area;
    });
}

fn padded(vector: &[f64]) -> [f64; 3] {
    std::array::from_fn(|axis| vector.get(axis).copied().unwrap_or(0.0))
}
