//! The loads of a stage on solids: consistent nodal forces of body forces and dead tractions.

use crate::continuation::scene::build::{ScaledModel, norm};
use crate::continuation::scene::elements::ElementBuilder;
use crate::mechanics::structure::elements::solid::any::each_traction_force;
use crate::model::request::{Element, Stage};
use crate::model::solids::data;
use crate::model::solids::faces::{FaceMatch, SolidFace, surface_faces};
use indexmap::IndexMap;

/// Calls `each` with the name of a load, node and force, in the user's units, of the body forces and tractions of a stage.
fn each_nodal_force<'a>(stage: &'a Stage, scaled: &ScaledModel<'_>, each: &mut dyn FnMut(&'a str, usize, [f64; 3])) {
    let &ScaledModel { model, numbers, .. } = scaled;
    if !stage.body_forces.is_empty() {
        let builder = ElementBuilder::new(model, numbers, 1.0, 1.0);
        for element in &model.elements {
            let Some((_, solid)) = element.solid() else { continue };
            let Some((name, density)) = stage.body_forces.get_key_value(&solid.material) else { continue };
            let Some(built) = builder.solid(element) else { continue };
            built.each_body_force(padded(density), &mut |place, force| {
                each(name, numbers[solid.nodes[place].as_str()], force);
            });
        }
    }
    if stage.tractions.is_empty() {
        return;
    }
    for (name, faces) in model.surfaces.keys().zip(surface_faces(model)) {
        let Some((name, traction)) = stage.tractions.get_key_value(name) else { continue };
        for face in faces {
            if let FaceMatch::Face(face) = face {
                traction_forces(&face, padded(traction), scaled, &mut |node, force| each(name, node, force));
            }
        }
    }
}

fn traction_forces(
    face: &SolidFace,
    traction: [f64; 3],
    scaled: &ScaledModel<'_>,
    each: &mut dyn FnMut(usize, [f64; 3]),
) {
    let model = scaled.model;
    let Some((_, solid)) = model.elements.get(face.element).and_then(Element::solid) else { return };
    let idealisation = data::idealisation(solid, model.dimension, 1.0);
    let places: Vec<&[f64]> = face.nodes.iter().map(|node| model.nodes[*node].as_slice()).collect();
    let positions = data::positions(&places, idealisation, 1.0);
    each_traction_force(face.kind, &positions, idealisation, traction, &mut |place, force| {
        each(face.nodes[place], force);
    });
}

/// The nodal forces of a stage's loads on solids, by degree of freedom, in the user's units.
pub(super) fn nodal_forces(stage: &Stage, scaled: &ScaledModel<'_>) -> Vec<(usize, f64)> {
    let mut forces = Vec::new();
    each_nodal_force(stage, scaled, &mut |_, node, force| {
        let freedoms = scaled.structure.translations_of(node);
        forces.extend(freedoms.zip(force).filter(|(_, value)| *value != 0.0));
    });
    forces
}

/// The largest resultant of a stage's body forces and tractions, by material and by surface, in the user's units; it depends
/// neither on the mesh nor on the axes.
pub(super) fn largest_resultant(stage: &Stage, scaled: &ScaledModel<'_>) -> f64 {
    let mut sums: IndexMap<&str, [f64; 3]> = IndexMap::new();
    each_nodal_force(stage, scaled, &mut |load, _, force| {
        sums.entry(load).or_default().iter_mut().zip(force).for_each(|(sum, value)| *sum += value);
    });
    sums.values().map(|sum| norm(sum)).fold(0.0, f64::max)
}

fn padded(vector: &[f64]) -> [f64; 3] {
    std::array::from_fn(|axis| vector.get(axis).copied().unwrap_or(0.0))
}
