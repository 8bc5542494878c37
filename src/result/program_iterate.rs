//! A point on the way to the end of an increment by its program, in the user's units.

use std::sync::Arc;

/// A point on the way to the end of an increment, in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramIterate {
    /// Which of the increment's programs, from 1: `γ1` is adapted from one to the next.
    pub program: u64,
    /// The bound `ε` on the products; `None` in a branch, where one member of each pair is zero.
    pub relaxation: Option<f64>,
    /// The arc length of the iterate over that of the increment.
    pub size: f64,
    /// Multiplier of the running stage's pattern.
    pub load_factor: f64,
    /// Sum of the violations of the program's rows, dimensionless.
    pub violation: f64,
    /// Those in reach.
    pub contacts: Vec<ContactIterate>,
}

/// A contact at an iterate.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactIterate {
    /// Name of the node.
    pub node: Arc<str>,
    /// Name of the obstacle.
    pub obstacle: Arc<str>,
    /// Length.
    pub gap: f64,
    /// Force.
    pub normal_reaction: f64,
    /// `μ r_n - |r_t|`, a force.
    pub within_cone: f64,
    /// `|Δu_t|`, a length.
    pub slip: f64,
}
