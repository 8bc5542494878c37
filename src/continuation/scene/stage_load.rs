//! The load of a stage.

use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::loading::LoadPattern;
use crate::resources::budget::Taken;
use std::sync::Arc;

/// A stage's load pattern over all degrees of freedom and its ends, dimensionless.
#[derive(Debug, Clone)]
pub(crate) struct StageLoad {
    pub name: Arc<str>,
    pub pattern: LoadPattern,
    pub load_scale: f64,
    /// Factor by which given scales exceed the default ones; at least 1.
    pub enlarged: f64,
    pub ends: Vec<End>,
    /// The loads at which the stage may end, in the user's units, in the order of those `ends`.
    pub(super) given_loads: Vec<f64>,
    pub(super) _held: Taken,
}

impl StageLoad {
    /// A load in the user's units. At the bound of a stage it is the given number itself: division by a scale and
    /// multiplication may not restore it.
    pub fn load_factor(&self, load: f64) -> f64 {
        let bounds =
            self.ends.iter().filter_map(|end| if let End::Load { bound, .. } = end { Some(*bound) } else { None });
        let given = bounds.zip(&self.given_loads).find(|(bound, _)| *bound == load);
        given.map_or(load * self.load_scale, |(_, given)| *given)
    }
}
