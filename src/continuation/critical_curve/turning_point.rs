//! Where a curve of critical points turns back in the parameter: two limit points of the path, a load maximum and a load
//! minimum, meet there and vanish (a cusp of the equilibrium surface). Where the critical point is a change of contact, its
//! event function touches zero there without passing it (grazing), and past it the contact does not change.
//!
//! Near such a point the state does not follow from the parameter, but the parameter from the state: the critical point is
//! sought in a plane across the last chord `c` of the curve, and the parameter `p` is the unknown (pseudo-arclength
//! continuation; H. B. Keller, in: *Applications of Bifurcation Theory*, Academic Press 1977, 359):
//!
//! ```text
//! c·(x - x_last) = const,    R(x, p) = 0,    e(x) = 0
//! ```

use crate::continuation::critical_curve::curve_position::{CurvePosition, SceneFamily, extrapolated};
use crate::continuation::critical_curve::history::contact_history::{PointClosing, PointGuess};
use crate::continuation::critical_curve::history::solved_history::SolvedHistory;
use crate::continuation::critical_curve::history::tolerances::UNFOLDED;
use crate::continuation::critical_curve::tolerances::{PARAMETER_ROUND_OFF, SMALLEST_RETURN, TURNING_WIDTH};
use crate::continuation::scene::Scene;
use crate::mechanics::equations::closing_equation::HyperplaneEquation;
use crate::mechanics::problem::state::State;
use crate::result::increment::PointKind;
use crate::step::corrector::cost_counters::Work;

/// Iterations for the parameter at which the point in a plane is critical.
const MOST_ITERATIONS: usize = 20;
/// First change of the parameter there, in units of the last step of the curve.
const FIRST_DIFFERENCE: f64 = 0.05;
/// Planes that are tried past the last point, each twice as far as the one before.
const MOST_PLANES: usize = 12;
/// First distance at which the other one of two bifurcation points is sought, in units of the last chord.
const FIRST_OTHER: f64 = 0.25;
/// Part of the way to where two bifurcation points meet, by which it is approached.
const CLOSER: f64 = 0.9;
/// Parabolas through the last three points, whose top is the turning point.
const MOST_PARABOLAS: usize = 6;

/// A turning point, and a point of the curve past it.
pub(super) struct TurningPoint {
    pub at: (Scene, SolvedHistory),
    pub past: (Scene, SolvedHistory),
}

/// The turning point past the last point of a curve that goes in this sense of the parameter, if there is one near by.
pub(super) fn turn(
    family: SceneFamily<'_>,
    place: &CurvePosition,
    sense: f64,
    work: &mut Work,
) -> Option<TurningPoint> {
    let before = place.before.as_ref()?;
    let closing = place.history.points.last()?.closing;
    if !matches!(closing, PointClosing::Event(_)) || place.here.parameter == before.parameter {
        return None;
    }
    let (first, last) = (before.parameter, place.here.parameter);
    let mut planes = 0..MOST_PLANES;
    let (far, past) = planes.find_map(|power| {
        let far = f64::from(1_u32 << power);
        // A plane in which there is no such point may lie too close to the last one.
        let past = in_plane(family, place, far, work)?;
        let is_back = sense * (past.1.parameter - last) < -SMALLEST_RETURN * (last - first).abs();
        is_back.then_some((far, past))
    })?;
    // In units of the last chord.
    let mut known = [(-1.0, first), (0.0, last), (far, past.1.parameter)];
    let mut found_at = None;
    for _ in 0..MOST_PARABOLAS {
        let top = top_of_parabola(&known).filter(|top| *top > 0.0)?;
        let found = in_plane(family, place, top, work)?;
        let (nearest, width) = known
            .iter()
            .enumerate()
            .map(|(index, (far, _))| (index, (far - top).abs()))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        let farthest =
            known.iter().enumerate().max_by(|(_, a), (_, b)| (a.0 - top).abs().total_cmp(&(b.0 - top).abs()))?.0;
        known[if nearest == farthest { 0 } else { farthest }] = (top, found.1.parameter);
        found_at = Some((top, found));
        if width <= TURNING_WIDTH {
            break;
        }
    }
    let (top, at) = found_at?;
    if sense * (at.1.parameter - last) < 0.0 {
        return None;
    }
    // As far past it as the last point is before: the first plane in which the point was back may lie much farther.
    let nearer =
        in_plane(family, place, 2.0 * top, work).filter(|one| sense * (one.1.parameter - at.1.parameter) < 0.0);
    Some(TurningPoint { at, past: nearer.unwrap_or(past) })
}

/// Where a curve of bifurcation points turns back: two of them meet and vanish.
pub(super) struct MeetingBifurcations {
    /// The value at which they meet.
    pub value: f64,
    /// The other one at the last value of the curve.
    pub other: (Scene, SolvedHistory),
}

/// The bifurcation point that the last one of a curve meets ahead, at most so far in the parameter. Close to the place where
/// they meet, both are as far from it, by the root of the distance in the parameter.
pub(super) fn meeting(
    family: SceneFamily<'_>,
    place: &CurvePosition,
    (sense, reach): (f64, f64),
    work: &mut Work,
) -> Option<MeetingBifurcations> {
    let CurvePosition { history, here, before } = place;
    let before = before.as_ref().filter(|_| history.kind == PointKind::SmoothBifurcation)?;
    let stage = history.points.last()?.stage;
    let scene = family(here.parameter).ok()?;
    let own = here.scales.express(here.critical(), stage, &scene);
    let chord = before.scales.express(before.critical(), stage, &scene).chord(&own);
    let mut solve = |like: &SolvedHistory, value: f64, state: State| {
        let scene = family(value).ok()?;
        let mut guesses = like.points.clone();
        let guess = guesses.last_mut()?;
        *guess = PointGuess { from: state.clone(), state, ..guess.clone() };
        let found = SolvedHistory::of(history, &scene, value, &guesses, work)?;
        (found.unfolding <= UNFOLDED).then_some((scene, found))
    };
    let is_other = |solved: &SolvedHistory| solved.critical().distance(&own) > SMALLEST_RETURN * chord.size();
    let mut distances = (0..MOST_PLANES).map(|power| FIRST_OTHER * f64::from(1_u32 << power));
    let other = distances
        .find_map(|far| solve(here, here.parameter, own.advanced(&chord, far)).filter(|(_, found)| is_other(found)))?;
    let other_before = solve(before, before.parameter, other.1.critical().advanced(&chord, 1.0))?.1;
    // The square of their distance falls to zero linearly, the more nearly the closer they are.
    let square = |one: &SolvedHistory, other: &SolvedHistory| one.critical().distance(other.critical()).powi(2);
    let mut first = (before.parameter, square(before, &other_before));
    let mut pair = (here.clone(), other.1.clone());
    let mut value = here.parameter;
    for _ in 0..MOST_PARABOLAS {
        let last = (pair.0.parameter, square(&pair.0, &pair.1));
        let ahead = last.1 * (last.0 - first.0) / (first.1 - last.1);
        let found = last.0 + ahead;
        if !(0.0..=reach).contains(&(sense * (found - here.parameter))) || first.1 <= last.1 {
            return None;
        }
        let change = (found - value).abs();
        value = found;
        if change <= PARAMETER_ROUND_OFF * value.abs().max(reach) {
            break;
        }
        let closer = last.0 + CLOSER * ahead;
        let middle = pair.0.critical().advanced(&pair.0.critical().chord(pair.1.critical()), 0.5);
        let near = |one: &SolvedHistory| middle.advanced(&middle.chord(one.critical()), (1.0 - CLOSER).sqrt());
        let (one, two) = (near(&pair.0), near(&pair.1));
        let Some(one) = solve(&pair.0, closer, one) else { break };
        let Some(two) = solve(&pair.1, closer, two) else { break };
        (first, pair) = (last, (one.1, two.1));
    }
    Some(MeetingBifurcations { value, other })
}

/// The critical point in the plane across the last chord, at so many lengths of it from the last point.
fn in_plane(
    family: SceneFamily<'_>,
    place: &CurvePosition,
    far: f64,
    work: &mut Work,
) -> Option<(Scene, SolvedHistory)> {
    let before = place.before.as_ref()?;
    let stage = place.history.points.last()?.stage;
    let width = place.here.parameter - before.parameter;
    let mut solve = |parameter: f64| {
        let scene = family(parameter).ok()?;
        let mut guesses = extrapolated(place, &scene, parameter);
        let from = place.here.scales.express(place.here.critical(), stage, &scene);
        let chord = before.scales.express(before.critical(), stage, &scene).chord(&from);
        let length = chord.size();
        let normal = chord.clone().normalised()?;
        let guess: &mut PointGuess = guesses.last_mut()?;
        let state: State = from.advanced(&chord, far);
        *guess = PointGuess { state, from: from.clone(), ..guess.clone() };
        let plane = HyperplaneEquation { from: &from, rate: &normal, step: far * length };
        let solved = SolvedHistory::up_to(&place.history, &scene, parameter, &guesses, Some(plane), work)?;
        Some((scene, solved))
    };
    let mut here = solve(place.here.parameter)?;
    let mut next = solve(place.here.parameter + FIRST_DIFFERENCE * width)?;
    let mut least = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let slope = (next.1.off_event - here.1.off_event) / (next.1.parameter - here.1.parameter);
        let correction = -next.1.off_event / slope;
        let round_off = PARAMETER_ROUND_OFF * next.1.parameter.abs().max(width.abs());
        // Where corrections no longer become smaller they are round-off.
        if next.1.off_event == 0.0 || correction.abs() <= round_off && correction.abs() >= 0.5 * least {
            return Some(next);
        }
        if !correction.is_finite() {
            return (least <= round_off).then_some(next);
        }
        least = least.min(correction.abs());
        let found = solve(next.1.parameter + correction)?;
        if found.1.parameter == next.1.parameter {
            return Some(found);
        }
        here = std::mem::replace(&mut next, found);
    }
    None
}

/// Where the parabola through three points has its top; `None` where they lie on a line.
fn top_of_parabola(points: &[(f64, f64); 3]) -> Option<f64> {
    let [(a, fa), (b, fb), (c, fc)] = *points;
    let (first, second) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
    let curvature = (second - first) / (c - a);
    let top = 0.5 * (a + b) - 0.5 * first / curvature;
    top.is_finite().then_some(top)
}
