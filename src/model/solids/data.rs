//! What a model's solids are made of, and the faces that loads act on, in the terms of mechanics.

use crate::mechanics::structure::elements::materials::linear_elastic::LinearElastic;
use crate::mechanics::structure::elements::materials::mooney_rivlin::MooneyRivlin;
use crate::mechanics::structure::elements::materials::neo_hookean::NeoHookean;
use crate::mechanics::structure::elements::materials::saint_venant_kirchhoff::SaintVenantKirchhoff;
use crate::mechanics::structure::elements::materials::{self, ElasticModuli, MaterialError};
use crate::mechanics::structure::elements::solid::any::{AnySolid, SolidData};
use crate::mechanics::structure::elements::solid::shapes::faces::FaceKind;
use crate::mechanics::structure::elements::solid::shapes::kind::Idealisation;
use crate::model::request::{ElasticConstants, Element, Material, Model, PlaneCondition, Solid};
use crate::model::solids::faces::FaceMatch;
use std::sync::Arc;

/// The material with stresses over `unit`.
///
/// # Errors
///
/// Where the constants make none; the message has them over `unit`.
pub(crate) fn material(given: &Material, unit: f64) -> Result<Arc<dyn materials::ElasticMaterial>, MaterialError> {
    let moduli = |constants: &ElasticConstants| ElasticModuli::from_young(constants.young / unit, constants.poisson);
    Ok(match given {
        Material::LinearElastic(constants) => Arc::new(LinearElastic { moduli: moduli(constants)? }),
        Material::SaintVenantKirchhoff(constants) => Arc::new(SaintVenantKirchhoff { moduli: moduli(constants)? }),
        Material::NeoHookean(constants) => Arc::new(NeoHookean { moduli: moduli(constants)? }),
        Material::MooneyRivlin { c10, c01, bulk_modulus, .. } => {
            Arc::new(MooneyRivlin::new(c10 / unit, c01 / unit, bulk_modulus / unit)?)
        }
    })
}

/// What holds in the third direction, with lengths over `unit`; in the plane strain is the condition that is not given.
pub(crate) fn idealisation(solid: &Solid, dimension: usize, unit: f64) -> Idealisation {
    let thickness = solid.thickness.unwrap_or(1.0) / unit;
    match solid.plane {
        _ if dimension == 3 => Idealisation::Space,
        Some(PlaneCondition::Stress) => Idealisation::PlaneStress { thickness },
        Some(PlaneCondition::Axisymmetric) => Idealisation::Axisymmetric,
        Some(PlaneCondition::Strain) | None => Idealisation::PlaneStrain { thickness },
    }
}

/// Whether the solids are bodies of revolution; a model has no others beside them.
pub(crate) fn is_revolved(model: &Model) -> bool {
    let mut solids = model.elements.iter().filter_map(Element::solid);
    solids.any(|(_, solid)| solid.plane == Some(PlaneCondition::Axisymmetric))
}

/// A solid of the nodes with these numbers, with lengths and forces over the units; `None` where the element makes none.
pub(crate) fn solid(
    model: &Model,
    element: &Element,
    nodes: &[usize],
    (length, force): (f64, f64),
) -> Option<AnySolid> {
    let (kind, solid) = element.solid()?;
    let material = material(model.materials.get(&solid.material)?, force / length / length).ok()?;
    let idealisation = idealisation(solid, model.dimension, length);
    let places: Option<Vec<&[f64]>> = solid.nodes.iter().map(|node| model.nodes.get(node).map(Vec::as_slice)).collect();
    let data = SolidData { kind, idealisation, material, mend: solid.locking };
    AnySolid::new(&data, nodes, &positions(&places?, idealisation, length)).ok()
}

/// Places of nodes over `unit`, from the first one; of a body of revolution the radius stays what it is. Differences of the
/// places as given: a place far from the origin causes no loss of digits.
pub(crate) fn positions(given: &[&[f64]], idealisation: Idealisation, unit: f64) -> Vec<[f64; 3]> {
    let first = given.first().copied().unwrap_or_default();
    let is_radius = |axis: usize| axis == 0 && matches!(idealisation, Idealisation::Axisymmetric);
    let component = |place: &[f64], axis: usize| {
        let from = if is_radius(axis) { 0.0 } else { first.get(axis).copied().unwrap_or(0.0) };
        (place.get(axis).copied().unwrap_or(0.0) - from) / unit
    };
    given.iter().map(|place| std::array::from_fn(|axis| component(place, axis))).collect()
}

/// A face that tractions and pressures load, its normal out of the body.
pub(crate) struct LoadedFace {
    pub kind: FaceKind,
    pub idealisation: Idealisation,
    pub nodes: Vec<usize>,
    /// See [`positions`].
    pub positions: Vec<[f64; 3]>,
}

/// A face of a surface with lengths over `unit`; `None` where it is no face of a body. A side of a bar or a beam is a face
/// of unit thickness, so that loads on it are forces per length.
pub(crate) fn loaded_face(model: &Model, face: &FaceMatch, unit: f64) -> Option<LoadedFace> {
    let (kind, idealisation, nodes) = match face {
        FaceMatch::Face(face) => {
            let (_, solid) = model.elements.get(face.element).and_then(Element::solid)?;
            (face.kind, idealisation(solid, model.dimension, unit), face.nodes.clone())
        }
        FaceMatch::Side([first, last]) => {
            // The free side is to the left of the order, outside of a solid to the right.
            (FaceKind::Segment2, Idealisation::PlaneStrain { thickness: 1.0 / unit }, vec![*last, *first])
        }
        FaceMatch::None | FaceMatch::Inside => return None,
    };
    let places: Vec<&[f64]> = nodes.iter().map(|node| model.nodes[*node].as_slice()).collect();
    let positions = positions(&places, idealisation, unit);
    Some(LoadedFace { kind, idealisation, nodes, positions })
}
