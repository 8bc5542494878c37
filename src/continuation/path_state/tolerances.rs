//! When two states are one, and when a reaction is what the location of its zero left over.

/// States closer than this are one.
pub(crate) const SAME_STATE: f64 = 1e-9;

/// A reaction this small against the largest force so far is what the location of its zero left over.
pub(crate) const ROUND_OFF: f64 = 1e-14;
