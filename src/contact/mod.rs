//! Contact: a node against an obstacle, its kinematics, its state and its modes.
//!
//! ```text
//! 0 <= g(u) ⊥ r_n >= 0,      |r_t| <= μ r_n,      Δu_t = -α r_t,  α >= 0
//! ```
//!
//! Dimensionless. In 2D there is one tangent; vectors along the tangents are of fixed length two so that the 3D cone
//! fits the same types. Knows the structure's numbering and nothing of paths.

pub mod obstacle;

use obstacle::Obstacle;
use serde::{Deserialize, Serialize};

/// Components along the obstacle's tangents; the second is 0 in 2D.
pub type Tangential = [f64; 2];

/// One node against one obstacle.
#[derive(Debug, Clone)]
pub struct Contact {
    pub node: usize,
    pub obstacle: Obstacle,
    /// Gap of the undeformed structure; kept apart so that a place far from the origin costs no digits.
    pub initial_gap: f64,
    /// Coulomb's coefficient; 0 where friction can do nothing.
    pub friction: f64,
}

/// What a contact does along a stretch of the path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Mode {
    /// Apart: no reaction.
    Free,
    /// Held: no motion against the obstacle.
    Stick,
    /// Sliding along `direction` (unit, or zero without friction) with `r_t = -μ r_n direction`.
    Slip { direction: Tangential },
}

impl Mode {
    pub fn is_active(self) -> bool {
        self != Self::Free
    }
}

/// The force of the obstacle on the node.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Reaction {
    pub normal: f64,
    pub tangential: Tangential,
}

impl Reaction {
    /// `|r_t|`
    pub fn tangential_size(&self) -> f64 {
        self.tangential[0].hypot(self.tangential[1])
    }

    pub fn size(&self) -> f64 {
        self.normal.abs().max(self.tangential_size())
    }
}

impl Contact {
    /// Signed distance of the node from the obstacle, positive on the free side.
    pub fn gap(&self, dimension: usize, displacement: &[f64]) -> f64 {
        let first = self.node * dimension;
        let normal = self.obstacle.normal();
        let moved: f64 = displacement[first..first + dimension].iter().zip(&normal).map(|(u, n)| u * n).sum();
        self.initial_gap + moved
    }
}
