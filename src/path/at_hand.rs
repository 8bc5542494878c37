//! A factorisation that is left over where a direction was found, for the step along it.
//!
//! Where nothing bends the path the equations at the start of a step are those at its end. What is at hand is what would be
//! made anew without it, to the last bit: a path that is taken up from a checkpoint has none, makes it, and is the same.

use super::loading::Loading;
use super::mode_system::ModeSystem;
use super::state::Rate;
use super::straight;
use crate::linear_algebra::SystemFactorisation;
use crate::linear_algebra::sparse::SparseFactorisation;

/// The equations of the modes of a direction where it begins, with any border; one holder has it, and copies have none.
#[derive(Default)]
pub struct AtHand(Option<Box<SparseFactorisation>>);

impl AtHand {
    /// What is worth keeping of a factorisation.
    pub(super) fn of(loading: Loading<'_>, factorisation: SystemFactorisation) -> Self {
        match factorisation {
            SystemFactorisation::Sparse(sparse) if straight::is_linear(loading) => Self(Some(sparse)),
            SystemFactorisation::Sparse(_) | SystemFactorisation::Dense(_) => Self(None),
        }
    }

    pub(super) fn is_one(&self) -> bool {
        self.0.is_some()
    }

    /// The equations of a system at its anchor, bordered by the direction; made where they are no longer at hand.
    pub(super) fn along(self, system: &ModeSystem<'_>, rate: &Rate) -> Option<SystemFactorisation> {
        let is_its_own = |sparse: &SparseFactorisation| sparse.size() == system.size();
        let bordered = self.0.filter(|sparse| is_its_own(sparse)).and_then(|sparse| {
            let sparse = sparse.with_last_row(|matrix| system.border(matrix, rate))?;
            system.is_kept(&sparse).then(|| SystemFactorisation::Sparse(Box::new(sparse)))
        });
        bordered.or_else(|| system.bordered(&system.iterate(system.anchor.clone()), rate))
    }
}

impl Clone for AtHand {
    fn clone(&self) -> Self {
        Self(None)
    }
}

impl std::fmt::Debug for AtHand {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(if self.0.is_some() { "AtHand(one)" } else { "AtHand(none)" })
    }
}
