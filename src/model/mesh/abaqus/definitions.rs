//! What a deck defines, before names and labels are resolved.

use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::error::MeshPlace;
use crate::model::mesh::data::mesh_data::{DeckMaterial, PlaneState};
use crate::model::mesh::data::unread::Unread;
use indexmap::IndexMap;
use std::collections::HashSet;

/// Where a name is defined: a part and its assembly may use the same one for two sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NameScope {
    /// In the part, its instance, or a deck without parts.
    Part,
    /// In the assembly.
    Assembly,
}

/// What a line of a set names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SetItem {
    /// Labels one by one.
    Labels(Vec<u64>),
    /// Labels from the first to the second in steps of the third; those that are not there are left out.
    Range(u64, u64, u64),
    /// A set that is defined before.
    Name(String),
    /// Places in the list of nodes or elements: the first one and their number.
    Places(u32, u32),
}

/// A set of nodes or elements, or an addition to one.
#[derive(Debug, Clone)]
pub struct SetDefinition {
    /// Where it is defined.
    pub scope: NameScope,
    /// Its name as written.
    pub name: String,
    /// Whether it is one that the program's author made for its own use.
    pub is_internal: bool,
    /// Its keyword's line.
    pub place: MeshPlace,
    /// Its members.
    pub items: Vec<SetItem>,
}

/// A line of a surface.
#[derive(Debug, Clone)]
pub struct SurfaceRow {
    /// Elements or nodes: a label or a set.
    pub members: SetItem,
    /// The number of the face, from 1 on; none for nodes.
    pub face: Option<usize>,
    /// Its line.
    pub place: MeshPlace,
}

/// A surface.
#[derive(Debug, Clone)]
pub struct SurfaceDefinition {
    /// Where it is defined.
    pub scope: NameScope,
    /// Its name as written.
    pub name: String,
    /// Whether it consists of nodes instead of faces.
    pub of_nodes: bool,
    /// Its lines.
    pub rows: Vec<SurfaceRow>,
}

/// A section: which elements are of which material.
#[derive(Debug, Clone)]
pub struct SectionDefinition {
    /// Where it is defined.
    pub scope: NameScope,
    /// The set of its elements.
    pub element_set: String,
    /// Its material.
    pub material: String,
    /// Thickness (length), where it is given.
    pub thickness: Option<f64>,
    /// Its keyword's line.
    pub place: MeshPlace,
}

/// Elements of one keyword.
#[derive(Debug, Clone)]
pub struct DeckElementBlock {
    /// Their kind.
    pub shape: ElementShape,
    /// What holds in the third direction.
    pub plane_state: Option<PlaneState>,
    /// Their keyword's line.
    pub place: MeshPlace,
    /// Their labels.
    pub labels: Vec<u64>,
    /// Labels of their nodes, one element after the other.
    pub nodes: Vec<u64>,
}

/// Everything that a deck defines.
#[derive(Debug, Default)]
pub struct Definitions {
    /// Labels of nodes.
    pub node_labels: Vec<u64>,
    /// Coordinates of nodes.
    pub coordinates: Vec<[f64; 3]>,
    /// For each `*NODE` its line and the number of nodes before it.
    pub node_blocks: Vec<(MeshPlace, usize)>,
    /// Elements.
    pub element_blocks: Vec<DeckElementBlock>,
    /// Number of elements.
    pub elements: usize,
    /// Labels of elements of types that are not read.
    pub other_elements: HashSet<u64>,
    /// Sets of nodes.
    pub node_sets: Vec<SetDefinition>,
    /// Sets of elements.
    pub element_sets: Vec<SetDefinition>,
    /// Surfaces.
    pub surfaces: Vec<SurfaceDefinition>,
    /// Materials by name as written.
    pub materials: IndexMap<String, DeckMaterial>,
    /// Their names in upper case, in which a deck does not tell letters apart.
    pub material_names: HashSet<String>,
    /// Sections.
    pub sections: Vec<SectionDefinition>,
    /// What is not read.
    pub unread: Unread,
}
