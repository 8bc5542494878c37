//! Surfaces of solids, and sets of nodes and elements.

use serde::{Deserialize, Serialize};

/// Faces of solid elements.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// The nodes of each face, in the order of VTK's file format: corners, then the middles of edges. Each is a face of one
    /// solid element, in either orientation.
    #[serde(default)]
    pub faces: Vec<Vec<String>>,
    /// Name of a group of faces of the mesh, in place of `faces`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
}

/// A set of nodes, of elements, or of both.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct NamedSet {
    /// Names of nodes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<String>,
    /// Names of elements.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub elements: Vec<String>,
}
