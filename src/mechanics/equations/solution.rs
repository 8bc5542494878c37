//! A point found by the equations of a mode, and the direction of the path there.

use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::Vector;
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::DVector;

/// A converged point and what it took.
#[derive(Debug, Clone)]
pub struct Corrected {
    pub state: State,
    /// The modes with the directions of slip as they are at the point.
    pub modes: Vec<Mode>,
    /// Iterations until the error was small; those after it polish, and their number is round-off's.
    pub iterations_to_small: u64,
    /// Equilibrium residual over the force scale; where the rounding of the displacements alone leaves more than is
    /// accepted, what is beyond it.
    pub residual: f64,
    /// Equilibrium and contact equations left over, one a row.
    pub(crate) left_over: DVector<f64>,
    /// Largest force in the structure, its loads and its contacts.
    pub force_scale: f64,
    pub(crate) directions: Vec<Vector>,
}

/// Why no point was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    Singular,
    NotConverged,
}

/// The path's direction at a converged point, and what its equations tell besides.
pub struct Tangent {
    /// Of unit arc length.
    pub rate: Rate,
    /// The point's distance to the branch (dimensionless).
    pub error: f64,
    /// Sign of the bordered determinant, where it is certain.
    pub determinant: Option<f64>,
    /// Where contacts slip in planes: of each such contact the force across it per motion across it.
    pub stiffness_across: Vec<Option<f64>>,
}
