//! The interface of exact solutions.

use crate::check::scenes::exact::curve::{CurveStage, Reach};

/// The path of a scene in closed form.
pub trait ExactSolution: Send + Sync {
    /// The name of the family.
    fn name(&self) -> &'static str;

    /// The formula in one line.
    fn formula(&self) -> &'static str;

    /// The stages of the path, with unbounded branches up to `reach`. The last stage ignores its bounds on load and
    /// displacement, which `CurveStage::end_at` applies.
    fn stages(&self, reach: Reach) -> Vec<CurveStage>;
}
