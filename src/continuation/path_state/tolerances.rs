//! Tolerances for coincident states and for reactions that are zero within the accuracy of event location.

/// States closer than this coincide.
pub(crate) const SAME_STATE: f64 = 1e-9;

/// Reactions up to this, relative to the largest force so far, are zero within the accuracy of event location.
pub(crate) const ROUND_OFF: f64 = 1e-14;
