//! Contact: its kinematics, its obstacle, its state and its modes.
//!
//! ```text
//! 0 <= g(u) ⊥ r_n >= 0,      |r_t| <= μ r_n,      Δu_t = -α r_t,  α >= 0
//! ```
//!
//! All quantities are dimensionless. Tractions and slips are vectors in space, so that they keep their meaning wherever
//! the node is on a curved obstacle; in 2D the third component is 0. The module knows nothing of structures and paths.

pub mod bodies;
pub mod coulomb;
pub(crate) mod frame;
pub mod kinematics;
pub mod least_norm_projection;
pub mod obstacle;
pub(crate) mod tolerances;
pub mod turning_obstacle;
pub mod vector;

use coulomb::CoulombFriction;
pub use frame::{Curvature, Frame, Sliding, tangents_in_space};
use kinematics::Kinematics;
use obstacle::RigidSurface;
use serde::{Deserialize, Serialize};
use vector::{Vector, size};

/// A contact: one node, or a point that several nodes move, against one obstacle.
#[derive(Debug, Clone)]
pub struct ContactPair {
    pub kinematics: Kinematics,
    pub obstacle: RigidSurface,
    /// Gap of the undeformed structure; stored separately, so that a position far from the origin costs no digits.
    pub initial_gap: f64,
    pub friction: CoulombFriction,
    pub sliding: Sliding,
}

/// The mode of a contact along a section of the path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Mode {
    /// Open: no reaction.
    Free,
    /// Sticking: no motion relative to the obstacle.
    Stick,
    /// Slipping along `direction` (unit tangent at the present position, or zero without friction) with
    /// `r_t = -μ r_n direction`.
    Slip { direction: Vector },
}

impl Mode {
    pub fn is_active(self) -> bool {
        self != Self::Free
    }

    /// Whether two modes can belong to the same section of the path: they are equal, or both slip in directions that
    /// differ by less than a right angle, since in a plane the direction turns as the node moves.
    pub fn continues(self, other: Self) -> bool {
        match (self, other) {
            (Self::Slip { direction: a }, Self::Slip { direction: b }) => a == b || vector::dot(&a, &b) > 0.0,
            (a, b) => a == b,
        }
    }
}

/// Whether every mode of one list continues the corresponding mode of the other.
pub fn all_continue(first: &[Mode], second: &[Mode]) -> bool {
    first.len() == second.len() && first.iter().zip(second).all(|(a, b)| a.continues(*b))
}

/// The force of the obstacle on the node, or its rate.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Reaction {
    pub normal: f64,
    /// A vector in space.
    pub tangential: Vector,
}

impl Reaction {
    /// The normal and tangential parts of a force.
    pub fn of(force: &Vector, normal: &Vector) -> Self {
        let along = vector::dot(force, normal);
        Self { normal: along, tangential: vector::add(force, -along, normal) }
    }

    /// The normal part of a force alone: without friction the tangential part is round-off.
    pub fn along(force: &Vector, normal: &Vector) -> Self {
        Self { normal: vector::dot(force, normal), tangential: [0.0; 3] }
    }

    /// `|r_t|`
    #[inline(always)]
    pub fn tangential_size(&self) -> f64 {
        size(&self.tangential)
    }

    #[inline(always)]
    pub fn size(&self) -> f64 {
        self.normal.abs().max(self.tangential_size())
    }

    /// Adds a multiple of another reaction.
    #[inline(always)]
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.normal += factor * other.normal;
        self.tangential = vector::add(&self.tangential, factor, &other.tangential);
    }

    /// The largest absolute difference of the normal parts and of the tangential components.
    pub fn difference(&self, other: &Self) -> f64 {
        let tangential = vector::add(&self.tangential, -1.0, &other.tangential);
        tangential.iter().fold((self.normal - other.normal).abs(), |largest, value| largest.max(value.abs()))
    }
}

impl ContactPair {
    /// Signed distance from the obstacle, positive on the free side; `relative` is the displacement of the contact less
    /// that of its obstacle, in the obstacle's axes.
    #[inline(always)]
    pub fn gap(&self, relative: &Vector) -> f64 {
        self.initial_gap + self.obstacle.distance(relative).0
    }

    /// The frame: gap, normal and tangents.
    #[inline(always)]
    pub fn frame(&self, relative: &Vector) -> Frame {
        let (change, normal, curvature) = self.obstacle.distance(relative);
        Frame::new(self.initial_gap + change, normal, curvature, self.sliding)
    }

    /// Whether the forces of a constant reaction change with the positions of the nodes.
    pub fn is_curved(&self) -> bool {
        self.obstacle.is_curved() || self.kinematics.node().is_none()
    }

    /// Number of tangential reactions: 0 without friction.
    #[inline(always)]
    pub fn tangents(&self) -> usize {
        if self.friction.is_rough() { self.sliding.directions() } else { 0 }
    }

    /// Round-off of the gap, and of motions along the surface, that displacements and forces do not determine.
    pub fn rounding(&self) -> f64 {
        self.obstacle.rounding().max(self.kinematics.rounding())
    }
}
