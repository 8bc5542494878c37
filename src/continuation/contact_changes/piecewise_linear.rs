//! Straight stretches of a path, each of which is one increment.
//!
//! Where every element is linear, every obstacle in reach is a plane and no slip can turn, the tangent of a mode is
//! constant and every watched quantity is linear in the arc length: the place of the next event follows from the
//! present point, and no event lies before it. The event is solved for directly (`prediction`); the direction there is
//! that of the start, and so is the signature that detects bifurcations. Along stretches of bifurcations the increments
//! are kept, because another direction can be followed from any of them.

use crate::continuation::contact_changes::prediction::ForeseenChange;
use crate::continuation::contact_changes::tolerances::{
    CONSTANT_BOUND_SLOPE, CONSTANT_SLOPE, EVENT_OVERSHOOT, VANISHING_EVENT_VALUE,
};
use crate::continuation::path_state::path_context::PathTrace;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::linearity::is_straight;
use crate::mechanics::problem::node_contact_forces;
use crate::step::event_functions::{self, EventFunction};

/// The next event, where the path is straight up to the event and a little beyond.
pub(crate) fn next_event_ahead(trace: &mut PathTrace<'_>) -> Option<ForeseenChange> {
    if !trace.scene.jumps || trace.at.listed.as_ref().is_some_and(|listed| listed.point.bifurcation) {
        return None;
    }
    loop {
        let (event_function, way) = straight_way(trace)?;
        let (contacts, step) = (trace.at.near.len(), way * (1.0 + EVENT_OVERSHOOT));
        trace.look_ahead(step);
        if trace.at.near.len() == contacts {
            return Some(ForeseenChange { event_function, way, step, is_straight: true });
        }
    }
}

/// The quantity that first decreases to zero, and the arc length up to its zero.
fn straight_way(trace: &PathTrace<'_>) -> Option<(EventFunction, f64)> {
    let (loading, here) = (trace.loading(), &trace.at.here);
    let rate = here.rate.as_ref()?;
    // The force of several obstacles in space does not vary linearly up to the bound of its admissible set.
    if !loading.contacts.iter().all(is_straight)
        || loading.corners.iter().any(|corner| !node_contact_forces::is_in_plane(loading, corner))
    {
        return None;
    }
    let ends = &trace.scene.stages[trace.at.stage].ends;
    if ends.iter().any(|end| matches!(end, End::Increments(_))) {
        return None;
    }
    let mut event_functions = event_functions::of_mode(loading, &here.modes, &here.state, rate);
    event_functions.extend(ends.iter().map(|end| EventFunction::End(*end)));
    let ahead = here.state.advanced(rate, 1.0);
    let mut nearest: Option<(EventFunction, f64)> = None;
    for event_function in event_functions {
        let now = event_function.value(loading, &here.modes, &here.state, rate);
        let change = event_function.value(loading, &here.modes, &ahead, rate) - now;
        if change >= 0.0 {
            continue;
        }
        let scale = event_function.scale(loading, &here.state, trace.at.totals.force_scale);
        let constant = if event_function.is_of_contact() { CONSTANT_SLOPE } else { CONSTANT_BOUND_SLOPE };
        let [rounding, rounding_ahead] = [&here.state, &ahead].map(|state| event_function.rounding(loading, state));
        if change < -(constant * scale).max(rounding_ahead) {
            if now <= (VANISHING_EVENT_VALUE * scale).max(rounding) {
                return None;
            }
            let way = now / -change;
            if nearest.is_none_or(|(_, least)| way < least) {
                nearest = Some((event_function, way));
            }
        }
    }
    nearest.filter(|(_, way)| way.is_finite())
}
