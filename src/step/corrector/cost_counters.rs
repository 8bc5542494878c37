//! Counts of work.

use crate::algebra::factorisations;
use crate::resources::budget;
use serde::{Deserialize, Serialize};

/// Work done, whether it led to a point or not.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Work {
    pub factorisations: u64,
    pub newton_iterations: u64,
    pub qp_solves: u64,
    pub mpec_solves: u64,
    #[serde(default)]
    pub sqp_iterations: u64,
    /// Points certified as solutions of their increment's program without solving it.
    #[serde(default)]
    pub certificates: u64,
    /// Increments whose end the program alone did not find.
    #[serde(default)]
    pub mpec_fallbacks: u64,
    /// Factorisations at smooth bifurcation points: to locate them and to list the directions there.
    #[serde(default)]
    pub bifurcation_factorisations: u64,
}

impl Work {
    /// Does a piece of work at a smooth bifurcation point and counts its factorisations, whether it counts them itself
    /// or not.
    pub(crate) fn at_bifurcation<T>(&mut self, piece: impl FnOnce(&mut Self) -> T) -> T {
        let _locating = budget::locating_bifurcation();
        let (begun, counted) = (factorisations(), self.factorisations);
        let done = piece(self);
        let all = factorisations() - begun;
        self.factorisations = self.factorisations.max(counted + all);
        self.bifurcation_factorisations += all;
        done
    }
}
