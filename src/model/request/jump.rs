//! What happens where a path cannot go on.

#![warn(missing_docs)]

use crate::result::increment::JumpMotionKind;
use serde::{Deserialize, Serialize};

/// What happens where no quasi-static continuation exists (`no_direction`), or none that an element resists (`mechanism`). `stop`: the path ends; `jump`: the structure
/// moves under its constant load to the next state at rest, and the path goes on from there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum OnPathEnd {
    /// The path ends.
    #[default]
    Stop,
    /// The structure jumps to the next state at rest.
    Jump,
}

/// The motion by which a structure jumps: at constant load, with unilateral contact and Coulomb friction, in implicit time
/// steps (backward Euler; J. J. Moreau, in: Nonsmooth Mechanics and Applications, Springer 1988), without rebound.
///
/// Damping and mass are equal at each translation, and in the plane at each rotation times the square of
/// `displacement_scale`; rotations in space follow at once. What comes after a jump does not depend on their size in an
/// overdamped motion. With friction it depends on the kind of motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct JumpMotion {
    #[allow(missing_docs)]
    #[serde(default)]
    pub kind: JumpMotionKind,
    /// With `inertial` only: damping over `2 √(k m)`, where `m` is the mass and `k` the plan's `force_scale` over
    /// `displacement_scale`; above 0. Absent: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
    pub damping_ratio: Option<f64>,
    /// Largest error of a time step over the length of the way so far; at least 1e-8, below 1.
    #[serde(default = "default_tolerance")]
    #[cfg_attr(feature = "server", schema(minimum = 1e-8, exclusive_maximum = 1.0))]
    pub tolerance: f64,
    /// Time steps of a jump before it is given up; 1 or more.
    #[serde(default = "default_max_steps")]
    #[cfg_attr(feature = "server", schema(minimum = 1, maximum = 10_000_000))]
    pub max_steps: u64,
    /// Whether each time step is an increment of kind `motion` of its own. It is no state at rest: its residual is the force
    /// of damping and inertia.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub keep_steps: bool,
    /// Whether the other kind of motion is followed, too, from the state in which a jump begins: the row of the jump says
    /// where it leads. The path goes on from where this one leads.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub compare: bool,
}

fn default_tolerance() -> f64 {
    0.01
}

fn default_max_steps() -> u64 {
    10_000
}

impl Default for JumpMotion {
    fn default() -> Self {
        Self::of(JumpMotionKind::Overdamped)
    }
}

impl JumpMotion {
    /// The motion of a kind, its other settings by default.
    pub fn of(kind: JumpMotionKind) -> Self {
        Self {
            kind,
            damping_ratio: None,
            tolerance: default_tolerance(),
            max_steps: default_max_steps(),
            keep_steps: false,
            compare: false,
        }
    }
}
