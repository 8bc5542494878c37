//! What a path in closed form has to tell.

use crate::check::scenes::exact::curve::{Reach, Stage};

/// A scene's path in closed form.
pub trait ExactSolution: Send + Sync {
    /// The family's name.
    fn name(&self) -> &'static str;

    /// The formula in a line.
    fn formula(&self) -> &'static str;

    /// The path's stages, unbounded branches as far as `reach`; ends by load and displacement are not looked at.
    fn stages(&self, reach: Reach) -> Vec<Stage>;
}
