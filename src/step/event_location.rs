//! The location of the zero of an event function within a step.
//!
//! A quantity is interpolated by the polynomial through its values and slopes at the points of the step computed so far
//! (a rate by the derivative of the polynomial of its integral). At the zero of the polynomial a new point is solved
//! for, from the Hermite interpolant of the neighbouring states, and added to the points: the error of the position
//! decreases at least quadratically. Where it does not decrease, the bracket is halved.

use crate::algebra::SystemFactorisation;
use crate::algebra::scalar_root::find_root;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::equations::corrected_point::Failure;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::state::State;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tolerances::ACCEPTED_RESIDUAL;
use crate::step::event_functions::EventFunction;
use crate::step::interpolation::{Knot, NewtonPolynomial, PlacedPoint, between, placed, unit};
use crate::step::mode_step::{Reached, Refused, StepStart};
use crate::step::tolerances::{
    EVENT_TOLERANCE, LARGEST_DEVIATION, LARGEST_SLOPE_RATIO, LOCATED_LENGTH, LOCATED_VALUE, LONGEST_STRAIGHT_STEP,
    OFFSET_MULTIPLE, POSITION_ROUND_OFF_MULTIPLE, SLOWEST_DECREASE, SMALLEST_SEPARATION, STRAIGHT_STEP_MULTIPLE,
};

/// Largest number of points tried.
const MOST_POINTS: usize = 100;
/// Distances past the start, over the bracket, at which a quantity that is zero at the start is evaluated.
const FURTHER_ON: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// The points of a step computed so far, in order, and the start of the step.
pub(crate) struct StepPoints {
    origin: PlacedPoint,
    points: Vec<(PlacedPoint, Box<Reached>)>,
    /// The last factorisation, which may be reused at nearby points.
    serving: Option<SystemFactorisation>,
}

impl StepPoints {
    pub fn new(start: &StepStart<'_>, reached: &Reached, serving: Option<SystemFactorisation>) -> Self {
        let origin = PlacedPoint { place: 0.0, state: start.state.clone(), rate: start.rate.clone() };
        Self { origin, points: vec![(placed(start, reached), Box::new(reached.clone()))], serving }
    }

    fn placed(&self) -> impl Iterator<Item = &PlacedPoint> {
        std::iter::once(&self.origin).chain(self.points.iter().map(|(placed, _)| placed))
    }

    /// The state at a position, interpolated between the neighbouring points.
    pub fn guess(&self, place: f64) -> State {
        let next = self.points.partition_point(|(point, _)| point.place < place).min(self.points.len() - 1);
        let before = if next == 0 { &self.origin } else { &self.points[next - 1].0 };
        between(before, &self.points[next].0, place).0
    }

    fn insert(&mut self, start: &StepStart<'_>, reached: &Reached) {
        let point = placed(start, reached);
        let at = self.points.partition_point(|(other, _)| other.place < point.place);
        self.points.insert(at, (point, Box::new(reached.clone())));
    }

    /// The point at a position; it is added to the points of the step.
    pub fn reach(&mut self, start: &StepStart<'_>, place: f64, work: &mut Work) -> Result<Box<Reached>, Refused> {
        let reached =
            start.reach_by(self.guess(place), place, &mut self.serving, work).or_else(|_| start.reach(place, work))?;
        self.insert(start, &reached);
        Ok(reached)
    }
}

/// The value of a quantity at a point.
#[derive(Debug, Clone, Copy)]
struct Sample {
    /// The value, at unit speed along the path's chord.
    value: f64,
    /// The quantity, or its integral where it is a rate.
    knot: Knot,
    is_slope: bool,
}

/// A quantity at the points of a step, and two neighbouring points: at the first the quantity is not negative, at the
/// second it is.
struct Bracket {
    samples: Vec<Sample>,
    /// Index of the second point.
    end: usize,
}

impl Bracket {
    fn ends(&self) -> [&Sample; 2] {
        [&self.samples[self.end - 1], &self.samples[self.end]]
    }

    fn width(&self) -> f64 {
        let [first, last] = self.ends();
        last.knot.place - first.knot.place
    }

    /// Whether a value near zero belongs to a point within [`LOCATED_LENGTH`] of the zero, by the slope of the secant.
    fn is_located(&self, value: f64) -> bool {
        let [first, last] = self.ends();
        value.abs() * self.width() <= LOCATED_LENGTH * (first.value - last.value)
    }

    /// The zero of the polynomial through the ends and the point nearest to them; `None` where the quantity is zero at
    /// the first end and the polynomial does not rise from there.
    fn estimate(&self, zero: f64) -> Option<f64> {
        let [first, last] = self.ends();
        let width = self.width();
        let near = |place: f64| (place - first.knot.place).abs().min((place - last.knot.place).abs());
        // Of points that lie close together only one is used, since their difference is round-off.
        let apart = |sample: &&Sample| near(sample.knot.place) > SMALLEST_SEPARATION * width;
        let third = self.samples.iter().filter(apart).min_by(|a, b| near(a.knot.place).total_cmp(&near(b.knot.place)));
        let mut used = vec![first, last];
        if last.value.abs() < first.value.abs() {
            used.swap(0, 1);
        }
        used.extend(third);
        // Over a short distance the integral of a rate is round-off.
        let is_slope = last.is_slope && width * width * width > f64::EPSILON;
        let knot = |sample: &&Sample| match sample.is_slope && !is_slope {
            true => Knot { place: sample.knot.place, value: sample.value, slope: None },
            false => sample.knot,
        };
        let knots: Vec<Knot> = used.iter().map(knot).collect();
        let polynomial = NewtonPolynomial::through(&knots);
        let value = |place: f64| {
            let (value, slope) = polynomial.at(place);
            if is_slope { slope } else { value }
        };
        let start = if first.value > zero {
            (first.knot.place, first.value)
        } else {
            let further = FURTHER_ON.iter().map(|part| first.knot.place + part * self.width());
            further.map(|place| (place, value(place))).find(|(_, value)| *value > 0.0)?
        };
        find_root(|place| Some(value(place)), start, (last.knot.place, last.value), 0.0)
    }
}

fn sample(start: &StepStart<'_>, event_function: EventFunction, at: &PlacedPoint) -> Sample {
    let value = event_function.value(start.loading, start.modes, &at.state, &at.rate);
    let whole = event_function.whole(start.loading, start.modes, start.state, &at.state);
    let knot = match whole {
        Some(whole) => Knot { place: at.place, value: whole, slope: Some(value) },
        None => Knot {
            place: at.place,
            value,
            slope: event_function.slope(start.loading, start.modes, &at.state, &at.rate),
        },
    };
    Sample { value, knot, is_slope: whole.is_some() }
}

/// The bracket of the points between which a quantity first becomes negative.
fn bracket(start: &StepStart<'_>, event_function: EventFunction, stretch: &StepPoints, zero: f64) -> Option<Bracket> {
    let samples: Vec<Sample> = stretch.placed().map(|placed| sample(start, event_function, placed)).collect();
    let end = samples.iter().skip(1).position(|sample| sample.value < -zero)? + 1;
    Some(Bracket { samples, end })
}

/// The quantity that falls to zero first, among those that are negative at the last point.
pub(crate) fn earliest<'w>(
    start: &StepStart<'_>,
    passed: &'w [EventFunction],
    stretch: &StepPoints,
    zero: impl Fn(EventFunction) -> f64,
) -> Option<&'w EventFunction> {
    let place = |event_function: &EventFunction| {
        let estimate = bracket(start, *event_function, stretch, zero(*event_function))?.estimate(zero(*event_function));
        Some(estimate.unwrap_or(0.0))
    };
    passed.iter().min_by(|a, b| {
        let [a, b] = [a, b].map(|event_function| place(event_function).unwrap_or(f64::INFINITY));
        a.total_cmp(&b)
    })
}

/// The first zero of a quantity that is negative at the last point; values up to `zero` count as zero.
pub(crate) fn locate(
    start: &StepStart<'_>,
    event_function: EventFunction,
    stretch: &mut StepPoints,
    zero: f64,
    work: &mut Work,
) -> Result<Box<Reached>, Refused> {
    let unclear = Refused::Newton(Failure::NotConverged);
    let last = stretch.points.last().ok_or(unclear)?;
    let reach = last.0.state.displacement.iter().fold(last.0.state.load.abs(), |most, value| most.max(value.abs()));
    let same_place = |place: f64| POSITION_ROUND_OFF_MULTIPLE * f64::EPSILON * (place + reach);
    let located = zero * (LOCATED_VALUE / EVENT_TOLERANCE);
    if let EventFunction::End(end) = event_function
        && let Some(bracket) = bracket(start, event_function, stretch, 0.0)
        && let Some(found) = meet(start, end, &bracket, stretch, work)
    {
        return Ok(found);
    }
    let (mut nearest, mut halve) = (f64::INFINITY, false);
    for _ in 0..MOST_POINTS {
        let bracket = bracket(start, event_function, stretch, located).ok_or(unclear)?;
        let [first, second] = bracket.ends();
        if !(first.value.is_finite() && second.value.is_finite()) {
            return Err(unclear);
        }
        let best = if first.value.abs() < second.value.abs() { bracket.end - 1 } else { bracket.end };
        let behind_start = bracket.end > 1;
        let is_located = first.value <= located || bracket.is_located(first.value);
        if behind_start && first.value <= zero && is_located {
            return Ok(stretch.points[bracket.end - 2].1.clone());
        }
        let place = match bracket.estimate(if behind_start { located } else { zero }) {
            Some(_) if halve => first.knot.place + 0.5 * bracket.width(),
            Some(place) => place,
            None => {
                // A contact that has just changed starts at zero: the search begins a little further on.
                begin_further_on(start, event_function, stretch, zero, work)?;
                continue;
            }
        };
        let known = bracket.samples[best].knot.place;
        if best > 0 && (place - known).abs() <= same_place(place) {
            return Ok(stretch.points[best - 1].1.clone());
        }
        // Exactly at this position the equations may be singular to the last digit.
        let beside = (place - OFFSET_MULTIPLE * same_place(place)).max(0.5 * place);
        let found = stretch.reach(start, place, work).or_else(|refused| match event_function {
            // A bound at a singular point ends the stage there: see `stage_end`.
            EventFunction::End(_) => Err(refused),
            _ => stretch.reach(start, beside, work),
        })?;
        let value = event_function.value(start.loading, start.modes, &found.corrected.state, &found.rate);
        if value.abs() <= located {
            return Ok(found);
        }
        if value.abs() <= STRAIGHT_STEP_MULTIPLE * zero
            && let Some(exact) = by_series(start, event_function, stretch, zero, &found)
        {
            return Ok(exact);
        }
        let decreases = value.abs() <= SLOWEST_DECREASE * nearest;
        if nearest <= zero && !decreases {
            // The remainder is round-off.
            return Ok(if value.abs() < nearest { found } else { stretch.points[best.max(1) - 1].1.clone() });
        }
        halve = !decreases;
        nearest = nearest.min(value.abs());
    }
    Err(unclear)
}

/// Whether a quantity that is zero at a point falls through zero there.
pub(crate) fn falls_through(
    start: &StepStart<'_>,
    event_function: EventFunction,
    stretch: &StepPoints,
    zero: &Reached,
) -> bool {
    let away = |placed: &&PlacedPoint| (placed.place - zero.step).abs() > SMALLEST_SEPARATION * zero.step;
    let sampled = |placed: &PlacedPoint| {
        (placed.place - zero.step, event_function.value(start.loading, start.modes, &placed.state, &placed.rate))
    };
    let before = stretch.placed().filter(away).filter(|placed| placed.place < zero.step).last();
    let after = stretch.placed().filter(away).find(|placed| placed.place > zero.step);
    before.zip(after).is_some_and(|(before, after)| falls(sampled(before), sampled(after)))
}

/// The zero at a straight step from a point close to it; `None` where the error of the step is not negligible.
fn by_series(
    start: &StepStart<'_>,
    event_function: EventFunction,
    stretch: &StepPoints,
    zero: f64,
    found: &Reached,
) -> Option<Box<Reached>> {
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    if system.has_tracks() {
        return None;
    }
    let bracket = bracket(start, event_function, stretch, 0.0)?;
    let place = bracket.estimate(zero)?;
    let [left, right] = [bracket.end - 1, bracket.end].map(|index| stretch.placed().nth(index));
    let (left, right) = (left?, right?);
    let distance = |point: &PlacedPoint| (point.place - place).abs();
    let (near, far) = if distance(left) < distance(right) { (left, right) } else { (right, left) };
    let (way, width) = (place - near.place, far.place - near.place);
    if way.abs() > LONGEST_STRAIGHT_STEP * width.abs() {
        return None;
    }
    let mut rate = near.rate.clone();
    rate.scale(1.0 - way / width);
    rate.add(&far.rate, way / width);
    let state = near.state.advanced(&near.rate, way);
    let rate = unit(&rate);
    let value = event_function.value(start.loading, start.modes, &state, &rate).abs();
    let mut corrected = newton::judged(&system, state, start.force_scale);
    if value > zero || !bracket.is_located(value) || corrected.residual > ACCEPTED_RESIDUAL {
        return None;
    }
    corrected.modes.clone_from(&found.corrected.modes);
    corrected.directions.clone_from(&found.corrected.directions);
    corrected.iterations_to_small = found.corrected.iterations_to_small;
    let step = corrected.state.distance(start.state);
    let mut nearer = Box::new(found.clone());
    (nearer.corrected, nearer.rate, nearer.step) = (corrected, rate, step);
    Some(nearer)
}

/// The point at which a bound of the stage is met, with the bound as closing equation; `None` where it lies elsewhere.
fn meet(
    start: &StepStart<'_>,
    end: End,
    bracket: &Bracket,
    stretch: &StepPoints,
    work: &mut Work,
) -> Option<Box<Reached>> {
    let place = bracket.estimate(0.0)?;
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    let mut met = start.settle(system, stretch.guess(place), &end.held()?, work).ok()?;
    end.make_exact(&mut met.corrected.state);
    ((met.step - place).abs() <= LARGEST_DEVIATION * bracket.width()).then_some(met)
}

/// Adds a point past the start at which a quantity that is zero at the start is positive.
fn begin_further_on(
    start: &StepStart<'_>,
    event_function: EventFunction,
    stretch: &mut StepPoints,
    zero: f64,
    work: &mut Work,
) -> Result<(), Refused> {
    let first = stretch.points[0].0.place;
    for part in FURTHER_ON {
        let near = stretch.reach(start, part * first, work)?;
        if event_function.value(start.loading, start.modes, &near.corrected.state, &near.rate) > zero {
            return Ok(());
        }
    }
    Err(Refused::AtStart(event_function))
}

/// Whether a quantity that is zero at position 0 decreases through zero and does not only touch it: the secants to the
/// values on both sides have similar, negative slopes.
fn falls(before: (f64, f64), after: (f64, f64)) -> bool {
    let (first, second) = (before.1 / before.0, after.1 / after.0);
    first < 0.0 && second < 0.0 && first <= second / LARGEST_SLOPE_RATIO && second <= first / LARGEST_SLOPE_RATIO
}

#[cfg(test)]
mod tests {
    use super::falls;

    #[test]
    fn what_touches_zero_or_lingers_there_is_not_seen_to_fall() {
        let sees = |value: fn(f64) -> f64| falls((-0.2, value(-0.2)), (0.02, value(0.02)));
        assert!(sees(|x| -3.0 * x));
        assert!(sees(|x| -x - x * x));
        assert!(!sees(|x| x * x), "it touches zero");
        assert!(!sees(|x| -x * x * x), "it lingers");
        assert!(!sees(|x| x), "it rises");
        assert!(!sees(|_| 0.0), "it stays");
    }
}
