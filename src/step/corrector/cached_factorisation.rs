//! Factorisations that earlier solves leave for reuse.
//!
//! Where the path is straight, the equations at the start of a step are those at its end: the factorisation that gave
//! the direction is reused throughout the step. It agrees with a fresh factorisation to the last bit: a path resumed from
//! a checkpoint has none, computes one, and continues identically. Elsewhere the factorisation that led to a contact
//! change serves to find the directions there, within the same increment.

use crate::algebra::SystemFactorisation;
use crate::algebra::sparse::SparseFactorisation;
use crate::mechanics::equations::{ModeSystem, matrix, mode_factorisation};
use crate::mechanics::problem::linearity;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::Rate;
use std::sync::Arc;

/// A reusable factorisation of the equations of some modes at a point or near it, with any border, if there is one;
/// copies have none, so that no memory is held without use.
#[derive(Default)]
pub struct CachedFactorisation(Option<Arc<SparseFactorisation>>);

impl CachedFactorisation {
    /// Shares a factorisation that may be reused.
    pub(crate) fn shared(serving: Option<&SystemFactorisation>) -> Self {
        match serving {
            Some(SystemFactorisation::Sparse(sparse)) => Self(Some(Arc::clone(sparse))),
            Some(SystemFactorisation::Dense(_)) | None => Self(None),
        }
    }

    /// Keeps a factorisation for the step along a direction, where it can be reused there.
    pub(crate) fn of(loading: Loading<'_>, factorisation: SystemFactorisation) -> Self {
        match factorisation {
            SystemFactorisation::Sparse(sparse) if linearity::is_linear(loading) => Self(Some(sparse)),
            SystemFactorisation::Sparse(_) | SystemFactorisation::Dense(_) => Self(None),
        }
    }

    pub(crate) fn is_one(&self) -> bool {
        self.0.is_some()
    }

    pub(crate) fn sparse(&self) -> Option<&SparseFactorisation> {
        self.0.as_deref()
    }

    /// The factorisation of a system at its anchor, bordered by the direction; computed where there is none to reuse.
    pub(crate) fn along(self, system: &ModeSystem<'_>, rate: &Rate) -> Option<SystemFactorisation> {
        let is_its_own = |sparse: &SparseFactorisation| sparse.size() == system.size();
        let bordered = self.0.and_then(Arc::into_inner).filter(is_its_own).and_then(|sparse| {
            let sparse = sparse.with_last_row(|matrix| matrix::border(system, matrix, rate))?;
            mode_factorisation::is_kept(system, &sparse).then(|| SystemFactorisation::Sparse(Arc::new(sparse)))
        });
        bordered
            .or_else(|| mode_factorisation::factorise_bordered(system, &system.iterate(system.anchor.clone()), rate))
    }
}

impl Clone for CachedFactorisation {
    fn clone(&self) -> Self {
        Self(None)
    }
}

impl std::fmt::Debug for CachedFactorisation {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(if self.0.is_some() { "CachedFactorisation(one)" } else { "CachedFactorisation(none)" })
    }
}
