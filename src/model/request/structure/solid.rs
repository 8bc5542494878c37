//! Solid elements.

use crate::mechanics::structure::elements::solid::shapes::kind::LockingMend;
use serde::{Deserialize, Serialize};

/// A solid element; the nodes stand in the order of VTK's file format.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Solid {
    /// Node names, as many as the kind says.
    pub nodes: Vec<String>,
    /// A name among `materials`.
    pub material: String,
    /// In the plane: what holds in the third direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneCondition>,
    /// In the plane, not axisymmetric: the length in the third direction, 1 when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub thickness: Option<f64>,
    /// The mend against locking; absent: the usual one of the kind, which the manual names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub locking: Option<LockingMend>,
    /// By which results and `analysis.record` refer to the element; one element has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

impl Solid {
    /// A solid of a material through nodes in the order of VTK's file format.
    pub fn new<const NODES: usize>(nodes: [impl Into<String>; NODES], material: impl Into<String>) -> Self {
        let (nodes, material) = (nodes.map(Into::into).into(), material.into());
        Self { nodes, material, plane: None, thickness: None, locking: None, name: None }
    }

    /// The solid with a condition in the third direction of the plane.
    #[must_use]
    pub fn with_plane(self, plane: PlaneCondition) -> Self {
        Self { plane: Some(plane), ..self }
    }

    /// The solid with a length in the third direction of the plane.
    #[must_use]
    pub fn with_thickness(self, thickness: f64) -> Self {
        Self { thickness: Some(thickness), ..self }
    }
}

/// What holds in the third direction of a plane solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum PlaneCondition {
    /// No strain.
    Strain,
    /// No stress.
    Stress,
    /// A body of revolution about the y axis.
    Axisymmetric,
}
