//! The mesh.

use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::node_lists::NodeLists;
use crate::model::mesh::data::unread::Unread;
use indexmap::IndexMap;

/// A mesh of a solid in the plane or in space, with the sets of its file.
///
/// Nodes and elements are numbered from 0 in the order of the file; sets and surfaces hold these numbers.
#[derive(Debug, Clone, Default)]
pub struct MeshData {
    /// Labels of the nodes in the file.
    pub node_labels: Vec<u64>,
    /// Coordinates of the nodes (length); zero where the file gives none.
    pub coordinates: Vec<[f64; 3]>,
    /// Elements of the largest dimension in the file.
    pub elements: MeshElements,
    /// Sets of nodes by name, ascending, each node once.
    pub node_sets: IndexMap<String, Vec<u32>>,
    /// Sets of elements by name, ascending, each element once.
    pub element_sets: IndexMap<String, Vec<u32>>,
    /// Surfaces by name: the nodes of each face, corners first, in the order in which the face's normal points out of
    /// its element.
    pub surfaces: IndexMap<String, NodeLists>,
    /// Materials by name.
    pub materials: IndexMap<String, DeckMaterial>,
    /// What elements are made of; see [`MeshElements::sections`].
    pub sections: Vec<MeshSection>,
    /// What the file holds beside.
    pub unread: Unread,
    /// What was changed on reading, a sentence each.
    pub remarks: Vec<String>,
}

impl MeshData {
    /// The largest dimension of an element: 3 for solids in space, 2 for solids in the plane; 0 without elements.
    pub fn dimension(&self) -> usize {
        self.elements.shapes.iter().map(|shape| shape.dimension()).max().unwrap_or(0)
    }
}

/// Elements; all lists but `nodes` have one entry for each.
#[derive(Debug, Clone, Default)]
pub struct MeshElements {
    /// Kinds.
    pub shapes: Vec<ElementShape>,
    /// Labels in the file.
    pub labels: Vec<u64>,
    /// Nodes of each, in VTK's order.
    pub nodes: NodeLists,
    /// What the file says of the third direction of plane elements.
    pub plane_states: Vec<Option<PlaneState>>,
    /// Places in [`MeshData::sections`].
    pub sections: Vec<Option<u32>>,
}

impl MeshElements {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.shapes.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Appends an element without a section.
    pub fn push(
        &mut self,
        shape: ElementShape,
        label: u64,
        nodes: impl IntoIterator<Item = u32>,
        plane_state: Option<PlaneState>,
    ) {
        self.shapes.push(shape);
        self.labels.push(label);
        self.nodes.push(nodes);
        self.plane_states.push(plane_state);
        self.sections.push(None);
    }
}

/// What holds in the third direction of a plane element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PlaneState {
    /// No strain.
    Strain,
    /// No stress.
    Stress,
    /// A body of revolution about the axis y.
    Axisymmetric,
}

/// A section of a deck: the material of elements, and the thickness (length) of plane ones.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSection {
    /// Its material's name.
    pub material: String,
    /// Thickness, where it is given.
    pub thickness: Option<f64>,
}

/// A material of a deck, in the terms of a model.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct DeckMaterial {
    /// The law, if one was read.
    #[serde(flatten)]
    pub law: Option<DeckLaw>,
    /// Mass by volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
}

/// The law of a material.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum DeckLaw {
    /// Hooke's law in small strains: Young's modulus (stress) and Poisson's ratio.
    LinearElastic {
        /// Young's modulus.
        young: f64,
        /// Poisson's ratio.
        poisson: f64,
    },
    /// Compressible neo-Hookean, by the moduli of small strains.
    NeoHookean {
        /// Young's modulus.
        young: f64,
        /// Poisson's ratio.
        poisson: f64,
    },
    /// `W = c10 (I1 - 3) + c01 (I2 - 3) + U(J)` with the invariants of the isochoric part (Mooney 1940, Rivlin 1948).
    MooneyRivlin {
        /// Coefficient of the first invariant (stress).
        c10: f64,
        /// Coefficient of the second invariant (stress).
        c01: f64,
        /// Bulk modulus at zero strain (stress).
        bulk_modulus: f64,
    },
}
