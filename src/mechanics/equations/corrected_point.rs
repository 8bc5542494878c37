//! A point found by the equations of a mode, and the direction of the path there.

use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::Vector;
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::DVector;

/// A converged point, its residual and its number of iterations.
#[derive(Debug, Clone)]
pub struct Corrected {
    pub state: State,
    /// The modes with the directions of slip as they are at the point.
    pub modes: Vec<Mode>,
    /// Iterations until the error was small; further iterations only polish, and their number depends on round-off.
    pub iterations_to_small: u64,
    /// Equilibrium residual over the force scale; where the rounding of the displacements alone exceeds the tolerance,
    /// the part beyond this rounding.
    pub residual: f64,
    /// Residuals of equilibrium and contact, one per row.
    pub(crate) left_over: DVector<f64>,
    /// Largest force in the structure, its loads and its contacts.
    pub force_scale: f64,
    pub(crate) directions: Vec<Vector>,
}

/// The reason why no point was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    Singular,
    NotConverged,
}

/// The path's direction at a converged point, and further results of its equations.
pub struct Tangent {
    /// The path's direction, of unit arc length.
    pub rate: Rate,
    /// The point's distance to the branch (dimensionless).
    pub error: f64,
    /// Sign of the bordered determinant, where it is certain.
    pub determinant: Option<f64>,
    /// For each contact that slips in a plane, the stiffness across the slip: force per motion. Empty where no contact
    /// slips in a plane.
    pub stiffness_across: Vec<Option<f64>>,
}
