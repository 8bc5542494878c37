//! Types of elements in decks.

use crate::model::mesh::data::element_shape::ElementShape;
use crate::model::mesh::data::mesh_data::PlaneState;

/// What is done with a type of element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DeckElementType {
    /// It is read.
    Solid {
        /// Its shape; the order of nodes is VTK's.
        shape: ElementShape,
        /// What holds in the third direction.
        plane_state: Option<PlaneState>,
        /// Letters at the end of its name, such as R for reduced integration, which say nothing of its nodes.
        variant: String,
    },
    /// A solid that is not read; a mesh without it would have a hole.
    Refused,
    /// No solid, and not read.
    Other,
}

/// Letters of variants with the same nodes: reduced integration, hybrid, incompatible modes, modified, and so on.
const VARIANTS: &str = "RHIMST";

/// What is done with a type of element, by its name.
pub fn deck_element_type(name: &str) -> DeckElementType {
    let name = name.to_ascii_uppercase();
    let families = [
        ("C3D", None),
        ("CPS", Some(PlaneState::Stress)),
        ("CPE", Some(PlaneState::Strain)),
        ("CAX", Some(PlaneState::Axisymmetric)),
    ];
    let Some((rest, plane_state)) =
        families.iter().find_map(|(family, plane_state)| Some((name.strip_prefix(family)?, *plane_state)))
    else {
        return DeckElementType::Other;
    };
    let variant = rest.trim_start_matches(|letter: char| letter.is_ascii_digit());
    let nodes = rest.strip_suffix(variant).unwrap_or(rest);
    let shape = match (plane_state, nodes) {
        (None, "4") => ElementShape::Tetrahedron4,
        (None, "10") => ElementShape::Tetrahedron10,
        (None, "8") => ElementShape::Hexahedron8,
        (None, "20") => ElementShape::Hexahedron20,
        (Some(_), "3") => ElementShape::Triangle3,
        (Some(_), "6") => ElementShape::Triangle6,
        (Some(_), "4") => ElementShape::Quadrilateral4,
        (Some(_), "8") => ElementShape::Quadrilateral8,
        _ => return DeckElementType::Refused,
    };
    if variant.chars().all(|letter| VARIANTS.contains(letter)) {
        DeckElementType::Solid { shape, plane_state, variant: variant.to_owned() }
    } else {
        DeckElementType::Refused
    }
}
