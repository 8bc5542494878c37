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
    /// First component of the rotation vector (radians); in space, at nodes with beams.
    Rx,
    /// Second component of the rotation vector (radians); in space, at nodes with beams.
    Ry,
    /// In the plane, rotation about the third axis, counter-clockwise (radians); in space, third component of the
    /// rotation vector. At nodes with beams.
    Rz,
}

impl Component {
    /// 0, 1 or 2 along the axes; 3, 4 or 5 for the rotations about them.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
            Self::Rx => 3,
            Self::Ry => 4,
            Self::Rz => 5,
        }
    }

    /// The place among the degrees of freedom of a node: the rotations follow the directions of the space.
    pub fn place(self, dimension: usize) -> usize {
        match self {
            Self::Rz if dimension == 2 => dimension,
            _ => self.index(),
        }
    }

    /// Whether it is a rotation.
    pub fn is_rotation(self) -> bool {
        self.index() >= 3
    }

    /// Whether a space of this dimension has it.
    pub fn is_in(self, dimension: usize) -> bool {
        if dimension == 2 { matches!(self, Self::X | Self::Y | Self::Rz) } else { true }
    }
}
