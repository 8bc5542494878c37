//! The motion of a jump, as far as it has come: part of the state of a path.

use crate::continuation::path_state::tolerances::FIRST_TIME_STEP;
use crate::mechanics::problem::state::State;
use crate::result::increment::JumpMotionKind;
use serde::{Deserialize, Serialize};

/// A jump under way from a state at rest, at a load that does not yield.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JumpProgress {
    /// The state from which the structure jumps.
    pub from: State,
    /// The state of the last row, where time steps are kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub row: Option<State>,
    /// A motion towards which the structure is pushed in the first time step, over all degrees of freedom; empty: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub push: Vec<f64>,
    /// Time steps so far.
    pub steps: u64,
    /// Length of the next time step, in units of the damping over the stiffness scale, or of the period for inertia.
    pub time_step: f64,
    /// Displacements of the last time step, over its length; empty before the first.
    pub velocity: Vec<f64>,
    pub largest_speed: f64,
    /// Length of the way so far (dimensionless).
    pub travelled: f64,
    /// Speed below which the state at rest is sought next.
    pub rests_below: f64,
    /// Part by which the load is raised to set the structure in motion.
    pub raised: f64,
    /// Nothing resists the motion but damping: without the raised load it would stop wherever it is.
    pub is_unresisted: bool,
    /// Where the other kind of motion leads, once it is known; only where it is asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other: Option<OtherMotionEnd>,
}

/// The end of the other kind of motion from the state from which a structure jumps.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OtherMotionEnd {
    pub kind: JumpMotionKind,
    /// Time steps it took.
    pub steps: u64,
    /// Displacements at rest; empty where it did not come to rest.
    pub displacement: Vec<f64>,
    /// Why it did not come to rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Energies given off and dissipated on the way (dimensionless).
    pub released: f64,
    pub dissipated: f64,
}

impl JumpProgress {
    /// A motion that begins at a state.
    pub fn begin(from: State, cause: JumpCause) -> Self {
        Self {
            from,
            row: None,
            push: Vec::new(),
            steps: 0,
            time_step: FIRST_TIME_STEP,
            velocity: Vec::new(),
            largest_speed: 0.0,
            travelled: 0.0,
            rests_below: f64::MAX,
            raised: 0.0,
            is_unresisted: cause == JumpCause::Mechanism,
            other: None,
        }
    }
}

/// Why a path jumps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JumpCause {
    /// The load can only fall from here, but only rises by the stage's control.
    LoadCannotRise,
    /// The state loses its stability, and no branch leaves along which the load goes on.
    LosesStability,
    /// There is no direction at all.
    NoDirection,
    /// The way on is a motion that no element resists.
    Mechanism,
}

impl JumpCause {
    /// Description of the event; `falls`: the load factor is to fall.
    pub fn describe(self, falls: bool) -> &'static str {
        match self {
            Self::LoadCannotRise if falls => "the load cannot fall: the structure jumps",
            Self::LoadCannotRise => "the load cannot rise: the structure jumps",
            Self::LosesStability => "the state loses its stability: the structure jumps",
            Self::NoDirection => "no quasi-static continuation: the structure jumps",
            Self::Mechanism => "no element resists: the structure moves",
        }
    }
}
