//! Coordinate directions and rotations.

use serde::{Deserialize, Serialize};

/// A coordinate direction, or a rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Component {
    /// Along the first axis.
    X,
    /// Along the second axis.
    Y,
    /// Along the third axis; in space only.
    Z,
    /// Rotation about the third axis, counter-clockwise (radians); in the plane, at nodes with beams.
    Rz,
}

impl Component {
    /// 0, 1 or 2 along the axes; 3 for the rotation.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
            Self::Rz => 3,
        }
    }

    /// The place among the degrees of freedom of a node: the rotation follows the directions of the space.
    pub fn place(self, dimension: usize) -> usize {
        match self {
            Self::Rz => dimension,
            Self::X | Self::Y | Self::Z => self.index(),
        }
    }
}
