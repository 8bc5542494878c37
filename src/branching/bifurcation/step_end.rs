//! The end of a step, with what is known of it before it becomes a point of the path.

use crate::branching::bifurcation::locate::Crossing;
use crate::branching::bifurcation::singularity::test_functions::Signature;
use crate::mechanics::problem::state::Rate;
use crate::step::mode_step::Reached;

/// The end of a step.
pub(crate) struct StepEnd {
    pub reached: Box<Reached>,
    /// The smooth bifurcation at the point, if it is one.
    pub crossing: Option<Crossing>,
    /// Signature just past the point, in the mode that led there, where it is known.
    pub signature: Option<Signature>,
    /// The contact changes within the step, if they are treated together.
    pub joined: Option<JoinedChanges>,
    /// The point is the one where the stage began.
    pub returned: bool,
}

/// Contact changes within a step that are treated together.
pub(crate) struct JoinedChanges {
    pub count: u64,
    /// The path's direction at the end of the step if no contact changed: it shows the turn of the path without its
    /// kinks.
    pub unchanged: Rate,
}

impl StepEnd {
    /// The end of a step within one mode.
    pub fn in_mode(reached: Box<Reached>, crossing: Option<Crossing>, signature: Option<Signature>) -> Self {
        Self { reached, crossing, signature, joined: None, returned: false }
    }

    /// The end of a step of whose equations nothing else is known.
    pub fn plain(reached: Box<Reached>) -> Self {
        Self::in_mode(reached, None, None)
    }

    /// Number of contact changes within the step that are treated together.
    pub fn changes(&self) -> u64 {
        self.joined.as_ref().map_or(0, |joined| joined.count)
    }
}
