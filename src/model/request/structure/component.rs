//! Coordinate directions.

use serde::{Deserialize, Serialize};

/// A coordinate direction.
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
}

impl Component {
    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}
