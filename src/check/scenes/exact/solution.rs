//! The interface of exact solutions.

use crate::check::scenes::exact::curve::{CurveStage, Reach};

/// The path of a scene in closed form.
pub trait ExactSolution: Send + Sync {
    /// The family's name.
    fn name(&self) -> &'static str;

    /// The formula in a line.
    fn formula(&self) -> &'static str;

    /// The stages of the path, with unbounded branches up to `reach`; ends by load and displacement are ignored.
    fn stages(&self, reach: Reach) -> Vec<CurveStage>;
}
