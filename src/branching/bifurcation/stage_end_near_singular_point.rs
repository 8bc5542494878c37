//! A bound of the stage at or near a singular point of the path.
//!
//! Newton's method is singular at such a point, and near it may converge to another branch. As for the singular point
//! itself (`locate`), the point at which the path meets the bound is therefore found on a cubic Hermite interpolant
//! between regular points, and accepted by its residual as every other point is.

use crate::algebra::scalar_root::find_root;
use crate::branching::bifurcation::locate::{self, Located, WIDTHS};
use crate::branching::bifurcation::simultaneous_limit_points;
use crate::branching::bifurcation::singularity::test_functions::{self, Signature, SignatureChange};
use crate::branching::bifurcation::step_end::StepEnd;
use crate::branching::bifurcation::tolerances::LARGEST_SHIFT_TO_BOUND;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tolerances::ACCEPTED_RESIDUAL;
use crate::step::event_functions::EventFunction;
use crate::step::interpolation::{PlacedPoint, between, placed, unit};
use crate::step::mode_step::{Reached, StepStart};
use crate::step::tolerances::BOUND_TOLERANCE;

/// Trial step lengths, relative to the step that ends at the bound: the point past the bound has to be regular.
const LENGTHENED: [f64; 4] = [1.0, 1.01, 1.1, 1.5];

/// Ends a step at a bound of the stage, or at the bifurcation point just before it, where Newton's method does not
/// reach the bound; `None` where there is no singular point nearby.
///
/// `load_sign` and `known`: sign of the load rate and signature at the start.
pub(crate) fn beside_singular(
    start: &StepStart<'_>,
    step: f64,
    ends: &[End],
    load_sign: f64,
    known: Option<Signature>,
    work: &mut Work,
) -> Option<StepEnd> {
    let bounds: Vec<End> = ends.iter().copied().filter(|end| end.is_bound()).collect();
    if bounds.is_empty() {
        return None;
    }
    let left_to =
        |bound: &End, state: &State| EventFunction::End(*bound).value(start.loading, start.modes, state, start.rate);
    let beyond = LENGTHENED.iter().find_map(|factor| {
        let beyond = start.advance(factor * step, &[], load_sign, simultaneous_limit_points::locate, work).ok()?;
        let passed = bounds.iter().any(|bound| left_to(bound, &beyond.corrected.state) < -BOUND_TOLERANCE);
        (passed && beyond.determinant.is_some()).then_some(beyond)
    })?;
    let here = Signature::at(start.loading, start.modes, start.state, start.rate, &mut None, work);
    let located = known.or(here).and_then(|before| match test_functions::compare(start, before, &beyond, work).1 {
        SignatureChange::None => None,
        change => locate::locate(start, before, change, &beyond, work),
    });
    if let Some(located) = located {
        return at_crossing(start, located, &bounds, &left_to, &beyond, work);
    }
    if here.is_some() {
        return None;
    }
    // The start itself is singular.
    let origin = PlacedPoint { place: 0.0, state: start.state.clone(), rate: start.rate.clone() };
    WIDTHS.iter().rev().find_map(|width| {
        let width = width * beyond.step;
        let farther = start.reach(width, work).ok()?;
        let farther = placed(start, &farther);
        let (place, bound) = first_met(&origin, &farther, &bounds, &left_to)?;
        let (state, rate) = between(&origin, &farther, place);
        ended(start, state, &rate, bound, width, &beyond).map(StepEnd::plain)
    })
}

/// The bound or the bifurcation point, whichever comes first.
fn at_crossing(
    start: &StepStart<'_>,
    located: Located,
    bounds: &[End],
    left_to: &impl Fn(&End, &State) -> f64,
    beyond: &Reached,
    work: &mut Work,
) -> Option<StepEnd> {
    let [nearer, farther] = located.between(start, beyond.step, work)?;
    let Located { mut point, crossing, .. } = located;
    let width = farther.place - nearer.place;
    if let Some(bound) = bounds.iter().find(|bound| left_to(bound, &point.corrected.state).abs() <= BOUND_TOLERANCE) {
        // The bifurcation point and the bound coincide within round-off; the bound is met exactly.
        let event_function = EventFunction::End(*bound);
        let slope =
            event_function.slope(start.loading, start.modes, &point.corrected.state, &point.rate).unwrap_or(0.0);
        let ahead = -left_to(bound, &point.corrected.state) / slope;
        let state = point
            .corrected
            .state
            .advanced(&point.rate, if ahead.abs() <= LARGEST_SHIFT_TO_BOUND { ahead } else { 0.0 });
        let found = ended(start, state, &point.rate, *bound, width, beyond)?;
        let after = crossing.after;
        return Some(StepEnd::in_mode(found, Some(crossing), Some(after)));
    }
    let (place, bound) = first_met(&nearer, &farther, bounds, left_to)?;
    if place > point.step {
        point.corrected.iterations_to_small = beyond.corrected.iterations_to_small;
        let after = crossing.after;
        return Some(StepEnd::in_mode(point, Some(crossing), Some(after)));
    }
    let (state, rate) = between(&nearer, &farther, place);
    ended(start, state, &rate, bound, width, beyond).map(StepEnd::plain)
}

/// The bound that the path meets first between two points, and its place.
fn first_met(
    nearer: &PlacedPoint,
    farther: &PlacedPoint,
    bounds: &[End],
    left_to: &impl Fn(&End, &State) -> f64,
) -> Option<(f64, End)> {
    let met = |bound: &End| {
        let (first, last) = (left_to(bound, &nearer.state), left_to(bound, &farther.state));
        let value = |place: f64| Some(left_to(bound, &between(nearer, farther, place).0));
        let bracketed = first > 0.0 && last < 0.0;
        let place = bracketed.then(|| find_root(value, (nearer.place, first), (farther.place, last), 0.0))??;
        Some((place, *bound))
    };
    bounds.iter().filter_map(met).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The point at which a stage ends, with the bound met exactly; `None` where its residual is not accepted.
fn ended(
    start: &StepStart<'_>,
    mut state: State,
    rate: &Rate,
    bound: End,
    width: f64,
    beyond: &Reached,
) -> Option<Box<Reached>> {
    bound.make_exact(&mut state);
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    let mut corrected = newton::judged(&system, state, start.force_scale);
    corrected.iterations_to_small = beyond.corrected.iterations_to_small;
    (corrected.residual <= ACCEPTED_RESIDUAL).then(|| {
        let step = corrected.state.distance(start.state);
        let mut point = Reached::new(corrected, unit(rate), step, width.powi(4));
        (point.drift, point.event) = (start.drift.cloned(), Some(EventFunction::End(bound)));
        point
    })
}
