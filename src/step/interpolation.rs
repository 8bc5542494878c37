//! Interpolation between the points of a step computed so far: cubic Hermite interpolants of the states, and
//! polynomials through values and slopes of one quantity.

use crate::mechanics::problem::state::{Rate, State};
use crate::step::mode_step::{Reached, StepStart};
use crate::step::tolerances::LONGEST_EXTRAPOLATION;
use serde::{Deserialize, Serialize};

/// A point on the path with its `place`: the distance from the start of the step, negative before the start.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlacedPoint {
    pub place: f64,
    pub state: State,
    /// Derivative of the state with respect to `place`.
    pub rate: Rate,
}

pub(crate) fn placed(start: &StepStart<'_>, reached: &Reached) -> PlacedPoint {
    let place = reached.corrected.state.distance(start.state);
    let cosine = start.state.cosine_of_chord(&reached.corrected.state, place, &reached.rate);
    let mut rate = reached.rate.clone();
    rate.scale(1.0 / cosine);
    PlacedPoint { place, state: reached.corrected.state.clone(), rate }
}

impl PlacedPoint {
    /// The point before another of the same mode; `rate` is the direction at this point.
    pub fn before(state: State, mut rate: Rate, here: &State) -> Option<Self> {
        let width = state.distance(here);
        let cosine = state.cosine_of_chord(here, width, &rate);
        if width <= 0.0 || cosine <= 0.0 {
            return None;
        }
        rate.scale(1.0 / cosine);
        Some(Self { place: -width, state, rate })
    }

    /// The state one step past a point with direction `rate`, extrapolated by the cubic through both points: the error
    /// of displacements and load is of fourth order in the step. Reactions, in which the equations are linear, are
    /// extrapolated linearly: round-off that does not enter the equations, of a traction off its plane, must not grow
    /// from step to step.
    pub fn foresee(&self, here: &State, rate: &Rate, step: f64) -> Option<State> {
        if step > -LONGEST_EXTRAPOLATION * self.place {
            return None;
        }
        let mut state = here.advanced(rate, step);
        let width = -self.place;
        let x = (step + width) / width;
        let y = 1.0 - x;
        let (along, begun, ended) = (x * x * (1.0 + 2.0 * y), width * x * y * y, -width * x * x * y);
        let bent = |before: f64, before_rate: f64, here: f64, rate: f64| {
            before + along * (here - before) + begun * before_rate + ended * rate
        };
        let ends = self.state.displacement.iter().zip(&self.rate.displacement);
        let ends = ends.zip(here.displacement.iter().zip(&rate.displacement));
        for (value, ((before, before_rate), (here, rate))) in state.displacement.iter_mut().zip(ends) {
            *value = bent(*before, *before_rate, *here, *rate);
        }
        state.load = bent(self.state.load, self.rate.load, here.load, rate.load);
        Some(state)
    }
}

pub(crate) fn unit(rate: &Rate) -> Rate {
    let mut rate = rate.clone();
    let size = rate.size();
    if size > 0.0 {
        rate.scale(1.0 / size);
    }
    rate
}

/// The cubic Hermite interpolant between two points, and its derivative.
pub(crate) fn between(left: &PlacedPoint, right: &PlacedPoint, place: f64) -> (State, Rate) {
    let width = right.place - left.place;
    if width <= 0.0 {
        return (left.state.clone(), left.rate.clone());
    }
    let x = (place - left.place) / width;
    let y = 1.0 - x;
    let chord = left.state.chord(&right.state);
    let mut state = left.state.advanced(&chord, x * x * (1.0 + 2.0 * y));
    state.advance(&left.rate, width * x * y * y);
    state.advance(&right.rate, -width * x * x * y);
    let mut rate = chord;
    rate.scale(6.0 * x * y / width);
    rate.add(&left.rate, y * (y - 2.0 * x));
    rate.add(&right.rate, x * (x - 2.0 * y));
    (state, rate)
}

/// A quantity at a position: its value, and its slope where it is known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Knot {
    pub place: f64,
    pub value: f64,
    /// Derivative with respect to `place`, where it is known.
    pub slope: Option<f64>,
}

/// The polynomial of least degree through knots (Newton's form).
pub(crate) struct NewtonPolynomial {
    places: Vec<f64>,
    coefficients: Vec<f64>,
}

impl NewtonPolynomial {
    /// The polynomial through knots at different places.
    pub fn through(knots: &[Knot]) -> Self {
        let (mut places, mut differences) = (Vec::new(), Vec::new());
        let mut slopes = Vec::new();
        for knot in knots {
            for _ in 0..1 + usize::from(knot.slope.is_some()) {
                places.push(knot.place);
                differences.push(knot.value);
                slopes.push(knot.slope.unwrap_or(0.0));
            }
        }
        let mut coefficients: Vec<f64> = differences.first().copied().into_iter().collect();
        for order in 1..places.len() {
            for index in 0..places.len() - order {
                let width = places[index + order] - places[index];
                differences[index] =
                    if width == 0.0 { slopes[index] } else { (differences[index + 1] - differences[index]) / width };
            }
            coefficients.push(differences[0]);
        }
        Self { places, coefficients }
    }

    /// Value and derivative.
    pub fn at(&self, place: f64) -> (f64, f64) {
        let (mut value, mut slope) = (0.0, 0.0);
        for (coefficient, knot) in self.coefficients.iter().zip(&self.places).rev() {
            slope = slope * (place - knot) + value;
            value = value * (place - knot) + coefficient;
        }
        (value, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::{Knot, NewtonPolynomial, PlacedPoint};
    use crate::mechanics::problem::state::{Rate, State};

    /// On a circle of radius 1 the error of the guess is of fourth order in the step, and too long a step gives no
    /// guess.
    #[test]
    fn a_step_is_foreseen_to_fourth_order() {
        let state = |angle: f64| State {
            displacement: vec![angle.cos()],
            remainder: Vec::new(),
            load_remainder: 0.0,
            load: angle.sin(),
            reactions: Vec::new(),
        };
        let rate = |angle: f64| Rate { displacement: vec![-angle.sin()], load: angle.cos(), reactions: Vec::new() };
        let error = |step: f64| {
            let before = PlacedPoint::before(state(-step), rate(-step), &state(0.0)).expect("a point before");
            let guess = before.foresee(&state(0.0), &rate(0.0), step).expect("a guess");
            assert!(before.foresee(&state(0.0), &rate(0.0), 4.1 * step).is_none());
            (guess.displacement[0].hypot(guess.load) - 1.0).abs()
        };
        let (coarse, fine) = (error(0.1), error(0.05));
        assert!(coarse < 1e-4 && coarse / fine > 12.0, "{coarse:e} {fine:e}");
        assert!(PlacedPoint::before(state(0.0), rate(0.0), &state(0.0)).is_none(), "no way between");
    }

    #[test]
    fn a_polynomial_meets_values_and_slopes() {
        let exact = |x: f64| (x * x * x * x - 2.0 * x + 1.0, 4.0 * x * x * x - 2.0);
        let knot = |place: f64, sloped: bool| {
            let (value, slope) = exact(place);
            Knot { place, value, slope: sloped.then_some(slope) }
        };
        let polynomial = NewtonPolynomial::through(&[knot(0.5, true), knot(-1.0, false), knot(2.0, true)]);
        for place in [-1.5, -1.0, 0.0, 0.5, 1.3, 2.0] {
            let (found, exact) = (polynomial.at(place), exact(place));
            assert!((found.0 - exact.0).abs() < 1e-12 && (found.1 - exact.1).abs() < 1e-12);
        }
    }
}
