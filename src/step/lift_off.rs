//! Where a node that slips in space leaves its obstacle.
//!
//! Along the path the traction `-μ N d` of a slip in the direction `d` balances the other forces at the node, `f`. Across `d`
//! the rates of both are
//!
//! ```text
//! μ N d' = f'  (its part across d)
//! ```
//!
//! so that the direction may turn the faster, the smaller the normal reaction `N` is: as a power of `N` that is no whole number,
//! which no step in the mode of slip follows to `N = 0`. The state there does not depend on the direction: it is the point of
//! the branch without this contact at which the gap is zero.

use crate::mechanics::contact::{Mode, Reaction, Sliding};
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::state::Rate;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::event_functions::{EventFunction, EventZero};
use crate::step::mode_step::{Reached, StepStart};
use crate::step::tolerances::LAST_SLIP;

/// The point at which the first such node leaves, if it is closer to the start than the step and than [`LAST_SLIP`] and nothing
/// else happens before.
pub(crate) fn ahead(
    start: &StepStart<'_>,
    step: f64,
    (ends, load_sign): (&[End], f64),
    work: &mut Work,
) -> Option<Box<Reached>> {
    let longest = step.min(LAST_SLIP);
    let (contact, way) = first_to_leave(start).filter(|(_, way)| *way <= longest)?;
    let mut modes = start.modes.to_vec();
    modes[contact] = Mode::Free;
    let mut from = start.state.clone();
    from.reactions[contact] = Reaction::default();
    let system = ModeSystem::new(start.loading, &modes, &from);
    if system.has_tracks() {
        return None;
    }
    let mut guess = start.state.advanced(start.rate, way);
    guess.reactions[contact] = Reaction::default();
    let event_function = EventFunction::Gap(contact);
    let scale = event_function.scale(start.loading, &guess, start.force_scale);
    let closing = EventZero { event_function, scale, towards: start.rate };
    let guess = system.iterate(guess);
    let mut corrected = newton::correct_from(&system, guess, &closing, start.force_scale, &mut None, work).ok()?;
    corrected.modes = start.modes.to_vec();
    let distance = corrected.state.distance(start.state);
    let mut reached = Reached::new(corrected, start.rate.clone(), distance, 0.0);
    let leaves = EventFunction::Normal(contact);
    let is_other = |one: &EventFunction| {
        !matches!(*one, EventFunction::Normal(own) | EventFunction::Sliding(own) | EventFunction::Gap(own)
            | EventFunction::Cone { contact: own, .. } if own == contact)
    };
    let others: Vec<EventFunction> =
        start.event_functions(ends, load_sign).into_iter().filter(|one| is_other(one)).collect();
    let is_first = (0.0..=longest).contains(&distance) && start.passed(&others, &reached).is_empty();
    reached.event = Some(leaves);
    // The error of the path so far stays.
    reached.drift = start.drift.cloned();
    reached.error_estimate = start.drift.map_or(0.0, Rate::size);
    is_first.then_some(reached)
}

/// The node slipping in a plane whose normal reaction vanishes first, and the way to there.
fn first_to_leave(start: &StepStart<'_>) -> Option<(usize, f64)> {
    let way = |contact: usize| start.state.reactions[contact].normal / -start.rate.reactions[contact].normal;
    let is_turning = |contact: &usize| {
        let pair = &start.loading.contacts[*contact];
        matches!(start.modes[*contact], Mode::Slip { .. }) && pair.tangents() > 1 && pair.sliding == Sliding::Plane
    };
    let falling = |contact: &usize| start.rate.reactions[*contact].normal < 0.0;
    let slipping = (0..start.modes.len()).filter(is_turning).filter(falling);
    slipping.map(|contact| (contact, way(contact))).min_by(|a, b| a.1.total_cmp(&b.1))
}
