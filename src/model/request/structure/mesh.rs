//! A mesh within a request, and the solids made of its elements.

use crate::mechanics::structure::elements::solid::shapes::kind::LockingMend;
use crate::model::mesh::MeshFormat;
use crate::model::request::structure::solid::PlaneCondition;
use serde::{Deserialize, Serialize};

/// A mesh file within a request: its nodes, sets and surfaces become those of the model, its elements where `elements` name
/// their groups.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Absent: as the first letter of the file tells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<MeshFormat>,
    /// The text of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
    /// How `content` is written, `text` when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub encoding: Option<ContentEncoding>,
    /// Path of the file relative to the request, in place of `content`; on the command line alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

/// How the bytes of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ContentEncoding {
    /// As they are.
    Text,
    /// In base 64, for binary files (RFC 4648, section 4).
    Base64,
}

/// Elements of the mesh as solids; an element of a group has the name `e` and its number in the file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct MeshGroup {
    /// Name of a physical group, or of a set of elements; absent: all elements of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// A name among `materials`; absent: what the file says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// In the plane: what holds in the third direction; absent: what the file says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneCondition>,
    /// In the plane, not axisymmetric: the length in the third direction; absent: what the file says, or 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub thickness: Option<f64>,
    /// The mend against locking; absent: the usual one of the kind, which the manual names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub locking: Option<LockingMend>,
}
