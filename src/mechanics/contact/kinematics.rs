//! The motion of a contact with the structure.
//!
//! ```text
//! x = m(u)       ẋ = B(u) u̇       forces on the structure: Bᵀ r,   their derivative at constant r: Σ_k r_k ∂B_k/∂u
//! ```
//!
//! `x` is the position of the contact in the axes of its obstacle, relative to the undeformed position; obstacle, gap,
//! normal and friction refer to these axes. For a node in front of a rigid obstacle `x` is the displacement of the node
//! and `B` the identity. For a node in front of a surface of another body the axes move with this body, and `B` has
//! columns for the nodes of both: see [`bodies`](super::bodies).

use crate::mechanics::contact::vector::{Vector, add};
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

/// The degrees of freedom of the nodes of a contact: the value of each by its index, node by node in the order of
/// [`CoupledKinematics::nodes`], the translations of a node before those of its rotations that move the contact.
pub type LocalDisplacements<'a> = &'a dyn Fn(usize) -> f64;

/// The motion of a contact that several nodes move together. All quantities are dimensionless; the reactions are
/// work-conjugate to `ẋ`.
pub trait CoupledKinematics: Debug + Send + Sync {
    /// The nodes that may move the contact, each once; the first is the one that the contact is named after.
    fn nodes(&self) -> &[usize];

    /// How many of the nodes, from the first, belong to the body of the node that the contact is named after.
    fn own_nodes(&self) -> usize {
        1
    }

    /// The nodes of the surface that is touched: those of [`Self::nodes`] that are not its own, unless a surface touches
    /// itself.
    fn touched_nodes(&self) -> &[usize] {
        &self.nodes()[self.own_nodes()..]
    }

    /// The number of rotations of each node that move the contact.
    fn rotations(&self) -> usize {
        0
    }

    /// The position `m(u)` of the contact; zero at zero displacement. Where a surface has no coordinates along it, those parts
    /// are zero, and [`Self::motion`] has them.
    fn place(&self, displacement: LocalDisplacements<'_>) -> Vector;

    /// The motion `∫ B du` between two positions of one path, not far from each other.
    fn motion(&self, from: LocalDisplacements<'_>, to: LocalDisplacements<'_>) -> Vector {
        add(&self.place(to), -1.0, &self.place(from))
    }

    /// Calls `each` with the index of a degree of freedom and its column of `B(u)`; columns of zeros may be left out.
    fn each_column(&self, displacement: LocalDisplacements<'_>, each: &mut dyn FnMut(usize, &Vector));

    /// Calls `add` with row, column and value of the entries of `Σ_k r_k ∂B_k/∂u`; zeros may be left out. The matrix is
    /// not symmetric where rows of `B` are no gradients.
    fn each_curvature(
        &self,
        displacement: LocalDisplacements<'_>,
        force: &Vector,
        add: &mut dyn FnMut(usize, usize, f64),
    );

    /// Round-off of gaps and motions that are those of coordinates, not of displacements.
    fn rounding(&self) -> f64 {
        0.0
    }

    /// The distance to the end of the surface that is touched, beyond which there is no contact; infinite where there is no
    /// such end. Positive before it.
    fn distance_to_end(&self, _displacement: LocalDisplacements<'_>) -> f64 {
        f64::INFINITY
    }

    /// Where the node that the contact is named after is beyond the end of the surface: the distance to it, which then is the
    /// gap of an open contact.
    fn beyond_end(&self, _displacement: LocalDisplacements<'_>) -> Option<f64> {
        None
    }

    /// A distance that has to be covered before the contact can close, and by how much a unit motion of the degrees of
    /// freedom shortens it at most; `None` where no bound is known: the contact then always counts as within reach.
    fn clearance(&self, _displacement: LocalDisplacements<'_>) -> Option<(f64, f64)> {
        None
    }
}

impl Kinematics {
    /// The nodes that move the contact; the first is the one that the contact is named after.
    pub fn nodes(&self) -> &[usize] {
        match self {
            Self::Node(node) => std::slice::from_ref(node),
            Self::Coupled(coupled) => coupled.nodes(),
        }
    }

    /// The nodes of the body of the node that the contact is named after.
    pub fn own_nodes(&self) -> &[usize] {
        match self {
            Self::Node(node) => std::slice::from_ref(node),
            Self::Coupled(coupled) => &coupled.nodes()[..coupled.own_nodes()],
        }
    }

    /// Round-off of gaps and motions that are those of coordinates, not of displacements.
    pub fn rounding(&self) -> f64 {
        match self {
            Self::Node(_) => 0.0,
            Self::Coupled(coupled) => coupled.rounding(),
        }
    }

    /// The nodes of the surface that is touched; none of an obstacle.
    pub fn touched_nodes(&self) -> &[usize] {
        match self {
            Self::Node(_) => &[],
            Self::Coupled(coupled) => coupled.touched_nodes(),
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
