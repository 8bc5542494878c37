//! The strains of solids, from the displacements of their nodes.
//!
//! ```text
//! E = (H + Hᵀ + HᵀH)/2,  where strains count as small (H + Hᵀ)/2;      H = ∂u/∂X
//! ```
//!
//! The mean is that over the volume of the stress.

use crate::mechanics::structure::elements::materials::ElasticMaterial;
use crate::mechanics::structure::elements::solid::any::{AnySolid, SolidData};
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, LockingMend};
use crate::model::JobRequest;
use crate::model::request::recorded_forces::recorded_elements;
use crate::model::request::{Element, SolidKind};
use crate::model::solids::data;
use crate::result::nodal_values::NodalValues;
use std::collections::HashMap;
use std::sync::Arc;

/// The solids whose stresses increments have.
#[derive(Debug, Clone)]
pub(super) struct StrainedSolids {
    solids: Vec<StrainedSolid>,
    /// Undeformed positions of all nodes.
    places: Vec<Vec<f64>>,
    dimension: usize,
}

/// What the strain of a solid follows from.
#[derive(Debug, Clone)]
struct StrainedSolid {
    element: usize,
    nodes: Vec<usize>,
    kind: SolidKind,
    idealisation: Idealisation,
    material: Arc<dyn ElasticMaterial>,
}

impl StrainedSolids {
    pub fn of(request: &JobRequest) -> Self {
        let model = &request.model;
        let materials: HashMap<&str, Arc<dyn ElasticMaterial>> = (model.materials.iter())
            .filter_map(|(name, given)| Some((name.as_str(), data::material(given, 1.0).ok()?)))
            .collect();
        let solid = |element: usize| {
            let (kind, solid) = model.elements.get(element).and_then(Element::solid)?;
            let nodes: Option<Vec<usize>> = solid.nodes.iter().map(|node| model.nodes.get_index_of(node)).collect();
            let idealisation = data::idealisation(solid, model.dimension, 1.0);
            let material = Arc::clone(materials.get(solid.material.as_str())?);
            Some(StrainedSolid { element, nodes: nodes?, kind, idealisation, material })
        };
        let solids = recorded_elements(request).into_iter().filter_map(solid).collect();
        Self { solids, places: model.nodes.values().cloned().collect(), dimension: model.dimension }
    }

    /// The mean strain of each of `cells` elements, of Green and Lagrange or linear where strains count as small, in the
    /// order of a symmetric tensor of VTK; not-a-number where the displacements of its nodes are not recorded.
    pub fn strains(&self, cells: usize, place_of_node: &HashMap<String, usize>, moved: &NodalValues) -> Vec<f64> {
        let mut displacements: Vec<Option<&[f64]>> = vec![None; self.places.len()];
        for (node, values) in moved.iter() {
            if let Some(own) = place_of_node.get(&**node).and_then(|place| displacements.get_mut(*place)) {
                *own = values.get(..self.dimension);
            }
        }
        let mut strains = vec![f64::NAN; 6 * cells];
        for StrainedSolid { element, nodes, kind, idealisation, material } in &self.solids {
            let own: Option<Vec<&[f64]>> = nodes.iter().map(|node| displacements[*node]).collect();
            let Some(own) = own.map(|own| own.concat()) else { continue };
            let places: Vec<&[f64]> = nodes.iter().map(|node| self.places[*node].as_slice()).collect();
            let positions = data::positions(&places, *idealisation, 1.0);
            // The strain of the displacements: what a mend makes of it does not matter here.
            let (material, mend) = (Arc::clone(material), Some(LockingMend::None));
            let solid = SolidData { kind: *kind, idealisation: *idealisation, material, mend };
            let (Ok(solid), Some(cell)) =
                (AnySolid::new(&solid, nodes, &positions), strains.get_mut(6 * element..6 * element + 6))
            else {
                continue;
            };
            let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = solid.mean_strain(&own);
            cell.copy_from_slice(&[xx, yy, zz, xy, yz, xz]);
        }
        strains
    }
}
