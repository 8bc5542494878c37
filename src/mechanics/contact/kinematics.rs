//! The motion of a contact with the structure.
//!
//! ```text
//! x = m(u)       ẋ = B(u) u̇       forces on the structure: Bᵀ r,   their derivative at constant r: Σ_k r_k ∂²m_k/∂u²
//! ```
//!
//! `x` is the position of the contact in the axes of its obstacle, relative to the undeformed position; obstacle, gap,
//! normal and friction refer to these axes. For a node in front of a rigid obstacle `x` is the displacement of the node
//! and `B` the identity. For a node in front of a surface of another body the axes move with this body, and `B` has
//! columns for the nodes of both.

use crate::mechanics::contact::vector::Vector;
use std::fmt::Debug;
use std::sync::Arc;

/// The kinematics of a contact: the nodes that move it, and how.
#[derive(Debug, Clone)]
pub enum Kinematics {
    /// A single node; each of its translations has weight 1.
    Node(usize),
    /// Several nodes together.
    Coupled(Arc<dyn CoupledKinematics>),
}

/// The motion of a contact that several nodes move together. All quantities are dimensionless.
///
/// `displacement` holds the degrees of freedom of these nodes, node by node: the translations of a node, then as many
/// of its rotations as [`rotations`](Self::rotations) says. The reactions are work-conjugate to `x`.
pub trait CoupledKinematics: Debug + Send + Sync {
    /// The nodes that move the contact, each once.
    fn nodes(&self) -> &[usize];

    /// The number of rotations of each node that move the contact.
    fn rotations(&self) -> usize {
        0
    }

    /// The position `m(u)` of the contact; zero at zero displacement.
    fn place(&self, displacement: &[f64]) -> Vector;

    /// Writes the columns of `B(u)`, one per degree of freedom.
    fn write_columns(&self, displacement: &[f64], columns: &mut [Vector]);

    /// A bound on the change of the gap under a unit motion of the degrees of freedom, valid at all displacements;
    /// infinite where no bound is known: the contact then always counts as within reach.
    fn fastest(&self) -> f64 {
        f64::INFINITY
    }

    /// Writes `Σ_k r_k ∂²m_k/∂u²`, row by row.
    fn write_curvature(&self, displacement: &[f64], force: &Vector, curvature: &mut [f64]);
}

impl Kinematics {
    /// The nodes that move the contact.
    pub fn nodes(&self) -> &[usize] {
        match self {
            Self::Node(node) => std::slice::from_ref(node),
            Self::Coupled(coupled) => coupled.nodes(),
        }
    }

    /// A bound on the change of the gap under a unit motion of the degrees of freedom.
    pub fn fastest(&self) -> f64 {
        match self {
            Self::Node(_) => 1.0,
            Self::Coupled(coupled) => coupled.fastest(),
        }
    }

    /// The node, if a single node moves the contact.
    #[inline(always)]
    pub fn node(&self) -> Option<usize> {
        match self {
            Self::Node(node) => Some(*node),
            Self::Coupled(_) => None,
        }
    }
}
