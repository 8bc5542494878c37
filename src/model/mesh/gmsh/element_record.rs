//! One element: its nodes by label, put into VTK's order.

use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::gmsh::cursor::Cursor;
use crate::model::mesh::gmsh::element_types::element_type;
use crate::model::mesh::gmsh::found::GmshContents;

/// A kind of element that is being read.
#[derive(Debug, Clone, Copy)]
pub struct ReadKind {
    /// Its shape.
    pub shape: ElementShape,
    order: Option<&'static [usize]>,
}

impl ReadKind {
    /// The kind of gmsh's number.
    ///
    /// # Errors
    /// It is not read.
    pub fn new(number: i64, place: MeshPlace) -> Result<Self, MeshError> {
        let (shape, order) = element_type(number).map_err(|detail| MeshError::new(place, detail))?;
        Ok(Self { shape, order })
    }
}

/// Which type of number the nodes of an element are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TagType {
    /// `int`, in version 2.2.
    Int,
    /// `size_t`, in version 4.1.
    Size,
}

/// Reads the nodes of an element and appends it.
///
/// # Errors
/// A number is missing, or a node is not there or stands twice.
pub fn read_element(
    cursor: &mut Cursor,
    found: &mut GmshContents,
    kind: ReadKind,
    label: u64,
    tag_type: TagType,
) -> Result<(), MeshError> {
    let mut nodes = [0_u32; ElementShape::MOST_NODES];
    let count = kind.shape.nodes();
    for place in 0..count {
        let tag = match tag_type {
            TagType::Int => cursor.natural_int("the tag of a node")?,
            TagType::Size => cursor.size("the tag of a node")?,
        };
        let Some(node) = found.node_index.as_ref().and_then(|index| index.get(tag)) else {
            let detail = format!("element {label} has node {tag}, which is not in `$Nodes`");
            return Err(MeshError::new(cursor.place(), detail));
        };
        if nodes.iter().take(place).any(|other| *other == node) {
            let detail = format!("element {label} has node {tag} twice; collapsed elements are not read");
            return Err(MeshError::new(cursor.place(), detail));
        }
        if let Some(entry) = nodes.get_mut(place) {
            *entry = node;
        }
    }
    let in_order = |place: usize| {
        let from = kind.order.and_then(|order| order.get(place)).copied().unwrap_or(place);
        nodes.get(from).copied().unwrap_or_default()
    };
    found.elements.push(kind.shape, label, (0..count).map(in_order), None);
    Ok(())
}
