//! From what a reader found to a mesh.

use crate::model::mesh::data::face_orientation::{orient_faces, turn_clockwise_elements};
use crate::model::mesh::data::mesh_data::{MeshData, MeshElements};
use crate::model::mesh::data::node_lists::NodeLists;
use indexmap::IndexMap;

/// A mesh whose elements still are of all dimensions.
#[derive(Debug, Default)]
pub struct MeshDraft {
    /// The mesh; `elements` may hold points, lines and faces beside solids, and `element_sets` is empty.
    pub mesh: MeshData,
    /// Sets of these elements by name, ascending.
    pub cell_sets: IndexMap<String, Vec<u32>>,
}

impl MeshDraft {
    /// The mesh: elements of the largest dimension remain. Those of one dimension less become the faces of a surface
    /// for every set that they are in, and all normals of faces point outwards.
    pub fn finish(self) -> MeshData {
        let Self { mut mesh, cell_sets } = self;
        let dimension = mesh.dimension();
        let is_element: Vec<bool> = mesh.elements.shapes.iter().map(|shape| shape.dimension() == dimension).collect();
        if is_element.iter().all(|is_element| *is_element) {
            mesh.element_sets = cell_sets;
        } else {
            let (elements, places) = kept(&mesh.elements, &is_element);
            for (name, members) in cell_sets {
                split(&mut mesh, dimension, &places, name, &members);
            }
            mesh.elements = elements;
        }
        mesh.element_sets.retain(|_, members| !members.is_empty());
        orient(&mut mesh, dimension);
        mesh
    }
}

/// The elements to be kept, and for every old one its new place.
fn kept(all: &MeshElements, keep: &[bool]) -> (MeshElements, Vec<Option<u32>>) {
    let mut elements = MeshElements::default();
    let mut places = Vec::with_capacity(keep.len());
    let lists = all.nodes.iter().zip(all.plane_states.iter().zip(&all.sections));
    for (keep, ((shape, label), (nodes, (plane_state, section)))) in
        keep.iter().zip(all.shapes.iter().zip(&all.labels).zip(lists))
    {
        if *keep {
            places.push(u32::try_from(elements.len()).ok());
            elements.push(*shape, *label, nodes.iter().copied(), *plane_state);
            if let Some(last) = elements.sections.last_mut() {
                *last = *section;
            }
        } else {
            places.push(None);
        }
    }
    (elements, places)
}

/// Puts the members of a set into a set of elements and a surface of its name. `mesh.elements` still has all
/// dimensions.
fn split(mesh: &mut MeshData, dimension: usize, places: &[Option<u32>], name: String, members: &[u32]) {
    let mut set = Vec::new();
    let mut faces = NodeLists::default();
    for member in members.iter().filter_map(|member| usize::try_from(*member).ok()) {
        if let Some(place) = places.get(member).copied().flatten() {
            set.push(place);
        } else if let Some(shape) = mesh.elements.shapes.get(member)
            && shape.dimension() > 0
            && shape.dimension() + 1 == dimension
        {
            faces.push(mesh.elements.nodes.get(member).iter().copied());
        }
    }
    if !faces.is_empty() {
        let surface = mesh.surfaces.entry(name.clone()).or_default();
        faces.iter().for_each(|face| surface.push(face.iter().copied()));
    }
    mesh.element_sets.insert(name, set);
}

/// Gives plane elements and faces their sense.
fn orient(mesh: &mut MeshData, dimension: usize) {
    if dimension == 2 {
        let turned = turn_clockwise_elements(&mut mesh.elements, &mesh.coordinates);
        if turned > 0 {
            mesh.remarks.push(format!("{turned} clockwise elements are turned over"));
        }
    }
    let unusual = orient_faces(&mut mesh.surfaces, &mesh.elements, mesh.node_labels.len(), dimension);
    if unusual.inner > 0 {
        let what = "faces of surfaces lie between two elements: they look out of the first one";
        mesh.remarks.push(format!("{} {what}", unusual.inner));
    }
    if unusual.loose > 0 {
        let what = "faces of surfaces belong to no element: they keep the sense of the file";
        mesh.remarks.push(format!("{} {what}", unusual.loose));
    }
}
