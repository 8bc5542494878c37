//! How a contact moves with the structure.
//!
//! ```text
//! x = m(u)        ẋ = B(u) u̇        forces on the structure: Bᵀ r,   their derivative at constant r: Σ_k r_k ∂²m_k/∂u²
//! ```
//!
//! `x` is the place of the contact in the axes of its obstacle, measured from where it is undeformed; obstacle, gap, normal
//! and friction are all in these axes. Of a node in front of a rigid obstacle `x` is the node's displacement and `B` the
//! identity. Of a node in front of a surface of another body the axes go with that body, and `B` has columns for the nodes
//! of both.

use crate::mechanics::contact::vector::Vector;
use std::fmt::Debug;
use std::sync::Arc;

/// What moves a contact.
#[derive(Debug, Clone)]
pub enum Kinematics {
    /// A node, each of its translations with weight 1.
    Node(usize),
    /// Several nodes together.
    Coupled(Arc<dyn CoupledKinematics>),
}

/// The motion of a contact that several nodes move together. All quantities are dimensionless.
///
/// `displacement` holds the degrees of freedom of its nodes, node by node: the translations of a node, then as many of its
/// rotations as [`rotations`](Self::rotations) says. The reactions are work-conjugate to `x`.
pub trait CoupledKinematics: Debug + Send + Sync {
    /// The nodes that move the contact, each once.
    fn nodes(&self) -> &[usize];

    /// How many rotations of each of its nodes move the contact.
    fn rotations(&self) -> usize {
        0
    }

    /// `m(u)`: zero where nothing is displaced.
    fn place(&self, displacement: &[f64]) -> Vector;

    /// Writes the columns of `B(u)`, one a degree of freedom.
    fn write_columns(&self, displacement: &[f64], columns: &mut [Vector]);

    /// A bound on how far the gap can change by unit motion of the degrees of freedom, wherever they are; infinite where
    /// none is known: then the contact is taken as in reach all along.
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

    /// A bound on how far the gap can change by unit motion of the degrees of freedom.
    pub fn fastest(&self) -> f64 {
        match self {
            Self::Node(_) => 1.0,
            Self::Coupled(coupled) => coupled.fastest(),
        }
    }

    /// The node, where it is only one.
    #[inline(always)]
    pub fn node(&self) -> Option<usize> {
        match self {
            Self::Node(node) => Some(*node),
            Self::Coupled(_) => None,
        }
    }
}
