//! From a mesh to a model in JSON.
//!
//! [`ConvertedModel::new`] decides what goes into the model; `document` is its form, and `line_format` its lines.

mod document;
mod line_format;
mod material_names;
mod summary;

use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::data::mesh_data::{MeshData, PlaneState};
use material_names::MaterialNames;

pub use document::SetEntry;

/// Distances from the plane of a plane mesh up to this share of its size are rounding.
const FLATNESS: f64 = 1e-9;

/// A mesh as a model.
///
/// Names of nodes and elements are the file's labels. A node without an element has no stiffness and is left out.
#[derive(Debug)]
pub struct ConvertedModel<'a> {
    mesh: &'a MeshData,
    /// 2 or 3.
    dimension: usize,
    /// Whether a node has an element.
    is_used: Vec<bool>,
    /// For plane elements of which the file says nothing.
    plane_state: Option<PlaneState>,
    material_names: MaterialNames,
}

impl<'a> ConvertedModel<'a> {
    /// The model of a mesh; `plane_state` holds for plane elements of which the file does not tell it.
    ///
    /// # Errors
    /// The mesh has no solids, or plane elements that do not lie in a plane of constant z.
    pub fn new(mesh: &'a MeshData, plane_state: Option<PlaneState>) -> Result<Self, MeshError> {
        let dimension = mesh.dimension();
        if dimension < 2 {
            let detail = "expected triangles, quadrilaterals, tetrahedra or hexahedra, found none";
            return Err(MeshError::new(MeshPlace::File, detail));
        }
        let mut is_used = vec![false; mesh.node_labels.len()];
        for node in mesh.elements.nodes.iter().flatten() {
            if let Some(is_used) = is_used.get_mut(*node as usize) {
                *is_used = true;
            }
        }
        if dimension == 2 {
            check_flat(mesh, &is_used)?;
        }
        Ok(Self { mesh, dimension, is_used, plane_state, material_names: MaterialNames::new(mesh) })
    }

    /// The model as JSON text, in a request `{"model": ...}`: a line for each node, element, surface and set.
    ///
    /// # Errors
    /// What serialisation reports.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        line_format::to_string(&document::Request::new(self))
    }

    /// What is in the model, what was changed, what was not read, and what has to be added, a line each.
    pub fn summary(&self) -> Vec<String> {
        summary::lines(self)
    }

    /// Members of a set of nodes that are in the model.
    fn used<'s>(&'s self, nodes: &'s [u32]) -> impl Iterator<Item = u32> + Clone + 's {
        nodes.iter().copied().filter(|node| self.is_used.get(*node as usize).copied().unwrap_or(false))
    }

    fn node_label(&self, node: u32) -> u64 {
        self.mesh.node_labels.get(node as usize).copied().unwrap_or_default()
    }
}

/// Checks that the nodes of plane elements have the same z.
pub fn check_flat(mesh: &MeshData, is_used: &[bool]) -> Result<(), MeshError> {
    let used = || mesh.coordinates.iter().zip(&mesh.node_labels).zip(is_used).filter(|(_, is_used)| **is_used);
    let mut first = None;
    let mut size = 0.0_f64;
    for ((point, _), _) in used() {
        let [x0, y0, _] = *first.get_or_insert(*point);
        let [x, y, _] = point;
        size = size.max((x - x0).abs()).max((y - y0).abs());
    }
    let Some([_, _, z0]) = first else { return Ok(()) };
    for (([_, _, z], label), _) in used() {
        if (z - z0).abs() > FLATNESS * size {
            let detail = format!("plane elements have to lie in one plane of constant z; node {label} has z = {z}");
            return Err(MeshError::new(MeshPlace::File, format!("{detail}, another one {z0}")));
        }
    }
    Ok(())
}
