//! Every case with a known solution.

use crate::check::extreme;
use crate::check::verify::{Case, beams, published};

/// Built-in scenes and published problems first, then plane beams and the extreme families. Linear structures are solved
/// both from event to event and in steps.
pub fn cases() -> Vec<Case> {
    published::cases().into_iter().chain(beams::cases()).chain(extreme::cases()).flat_map(Case::with_steps).collect()
}
