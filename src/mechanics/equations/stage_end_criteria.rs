//! The criteria that end a stage.

use crate::mechanics::equations::closing_equation::PrescribedValue;
use crate::mechanics::problem::state::State;

/// One criterion that ends a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// `sign (s - bound) >= 0`
    Load {
        bound: f64,
        sign: f64,
    },
    /// `sign (u - bound) >= 0`
    Displacement {
        freedom: usize,
        bound: f64,
        sign: f64,
    },
    LimitPoints(u64),
    ContactChanges(u64),
    Increments(u64),
}

impl End {
    /// Whether the criterion is a bound on the load or on a displacement, not a count.
    pub fn is_bound(self) -> bool {
        matches!(self, Self::Load { .. } | Self::Displacement { .. })
    }

    /// The closing equation of a bound; `None` for a count.
    pub fn held(self) -> Option<PrescribedValue> {
        match self {
            Self::Load { bound, .. } => Some(PrescribedValue::Load(bound)),
            Self::Displacement { freedom, bound, .. } => Some(PrescribedValue::Displacement { freedom, value: bound }),
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => None,
        }
    }

    /// Whether a state meets a bound exactly, without round-off.
    pub fn is_met_exactly(self, state: &State) -> bool {
        match self {
            Self::Load { bound, .. } => state.load == bound,
            Self::Displacement { freedom, bound, .. } => state.displacement[freedom] == bound,
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => false,
        }
    }

    /// Puts a state that meets a bound up to round-off exactly on the bound.
    pub fn make_exact(self, state: &mut State) {
        match self {
            Self::Load { bound, .. } => state.set_load(bound),
            Self::Displacement { freedom, bound, .. } => state.place(freedom, bound, 0.0),
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => {}
        }
    }
}
