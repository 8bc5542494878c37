//! Two changes of contact by which a path comes to its critical point meet in the parameter and vanish, as where a contact
//! slips along a stretch that shrinks to nothing.
//!
//! At the value `p*` where they meet, the event function of the first touches zero without passing it (a fold): the states
//! `x1` and `x2` of the two are apart by the root of the distance in the parameter, and neither is found past it. The square
//! of their distance, known at the last two values `p1` and `p2` of the curve, gives the value:
//!
//! ```text
//! d_i = |x2(p_i) - x1(p_i)|^2,    p* = p2 + d_2 (p2 - p1) / (d_1 - d_2)
//! ```

use crate::continuation::critical_curve::curve_position::CurvePosition;
use crate::continuation::critical_curve::history::contact_history::PointClosing;
use crate::step::event_functions::EventFunction;

/// Two successive changes of contact that meet.
pub(super) struct MeetingChanges {
    /// The value of the parameter.
    pub value: f64,
    /// What happens at each.
    pub events: [EventFunction; 2],
}

/// The changes of contact that meet ahead of the last point of a curve in this sense of the parameter, at most so far from it.
pub(super) fn ahead(place: &CurvePosition, (sense, reach): (f64, f64)) -> Option<MeetingChanges> {
    let CurvePosition { history, here, before } = place;
    let before = before.as_ref()?;
    (1..history.points.len()).find_map(|later| {
        let [first, second] = [&history.points[later - 1], &history.points[later]];
        let (PointClosing::Event(one), PointClosing::Event(other)) = (first.closing, second.closing) else {
            return None;
        };
        if first.stage != second.stage || !first.changes {
            return None;
        }
        // The square of their distance falls to zero linearly.
        let [far, near] = [before, here].map(|at| at.points[later - 1].state.distance(&at.points[later].state).powi(2));
        let value = here.parameter + near * (here.parameter - before.parameter) / (far - near);
        let is_ahead = near < far && (0.0..=reach).contains(&(sense * (value - here.parameter)));
        is_ahead.then_some(MeetingChanges { value, events: [one, other] })
    })
}
