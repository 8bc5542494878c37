//! Scales of a structure with solids.
//!
//! Large strains: the length scale is the size of the structure, the load scale of a stage the load at which the tangent of
//! the undeformed structure moves by this length. Small strains alone, where only the load has a size: the length scale is
//! the largest displacement that the tangent of the undeformed structure has under the loads at which the stages end; so it is
//! where the loads move a structure of large strains by next to nothing. Both depend on the mesh no more than the tangent's
//! response does.

use crate::continuation::scene::build::{ScaledModel, build_contacts, build_stage, build_structure, first_contacts};
use crate::continuation::scene::characteristic_stiffness::load_at_unit_displacement;
use crate::continuation::scene::elements::ElementBuilder;
use crate::continuation::scene::scales::{MOST_STAGES, RequestScales, expected_load_factor};
use crate::continuation::scene::solid_loads::LoadedSolids;
use crate::continuation::scene::turning_obstacles::TurningObstacles;
use crate::mechanics::structure::Structure;
use crate::model::check::scope::size;
use crate::model::request::{Analysis, Material, Model};
use crate::model::solids::data;
use std::collections::HashMap;

/// Part of the size of a structure below which the displacement that loads are expected to cause gives the scale in large
/// strains, too: steps of the size of the structure would be over before they are long enough to be told from none.
const SMALL_MOTION: f64 = 1e-6;

/// Young's modulus of each solid times its volume, over the size of the structure: a force; 0 without solids.
fn stretching_force(model: &Model, numbers: &HashMap<&str, usize>) -> f64 {
    let builder = ElementBuilder::new(model, numbers, 1.0, 1.0);
    let mut sum = 0.0;
    for element in &model.elements {
        let Some((_, solid)) = element.solid() else { continue };
        let young = |material: &Material| Some(data::material(material, 1.0).ok()?.moduli().young());
        let young = model.materials.get(&solid.material).and_then(young).unwrap_or(0.0);
        sum += young * builder.solid(element).map_or(0.0, |built| built.volume());
    }
    sum / size(model)
}

/// The scales of a request with solids; `None` without any. `like`: a structure that may be identical except for its numbers.
pub(super) fn solid_scales(
    model: &Model,
    analysis: &Analysis,
    numbers: &HashMap<&str, usize>,
    loaded_solids: &LoadedSolids<'_>,
    like: Option<&Structure>,
) -> Option<RequestScales> {
    if !model.elements.iter().any(|element| element.solid().is_some()) {
        return None;
    }
    let (own, force) = (size(model), stretching_force(model, numbers));
    let structure = build_structure(model, numbers, (own, force), loaded_solids, like);
    let turning = TurningObstacles::of(model);
    let contacts = build_contacts(model, numbers, own, (&structure, &turning, &loaded_solids.basis), &mut Vec::new());
    let first_contacts = &first_contacts(&contacts.reported, contacts.contacts.len())[..];
    let scaled = ScaledModel {
        model,
        analysis,
        numbers,
        structure: &structure,
        loaded_solids,
        turning: &turning,
        first_contacts,
        length: own,
        force,
        stretched: 1.0,
    };
    // For each stage the load factor at which the structure would move by its size, and its dimensionless load.
    let responses: Vec<Option<(f64, f64)>> = model
        .stages
        .iter()
        .take(MOST_STAGES)
        .map(|stage| {
            let built = build_stage(stage, force, &scaled);
            let load = load_at_unit_displacement(&structure, &contacts.contacts, &built.pattern)?;
            Some((load * built.load_scale, load))
        })
        .collect();
    // A pressure that follows its surface is no less a load in small strains.
    let is_linear = structure.resists_linearly();
    let displaced = |(stage, response): (_, &Option<(f64, f64)>)| {
        response.map(|(load_factor, _)| expected_load_factor(stage) / load_factor)
    };
    let largest = model.stages.iter().zip(&responses).filter_map(displaced).fold(0.0_f64, f64::max);
    let is_small = largest > 0.0 && (is_linear || largest < SMALL_MOTION);
    let natural = if is_small { largest * own } else { own };
    let length = analysis.arc_length.displacement_scale.unwrap_or(natural);
    let of_stage = |place: usize| responses.get(place).copied().flatten().map_or(force, |(_, load)| load * force);
    let resistances: Vec<f64> = (0..model.stages.len()).map(|place| of_stage(place) * (length / own)).collect();
    let force = if is_linear || is_small { force * (length / own) } else { force };
    Some(RequestScales { length, force, resistances, stretched: length / natural, structure: Some(structure) })
}
