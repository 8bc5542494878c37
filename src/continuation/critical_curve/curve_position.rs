//! The last point of a curve, and the guess at the next.

use crate::continuation::critical_curve::history::contact_history::{ContactHistory, PointGuess};
use crate::continuation::critical_curve::history::solved_history::SolvedHistory;
use crate::continuation::scene::Scene;
use crate::model::InputErrors;

/// A scene for each value of a parameter.
pub type SceneFamily<'a> = &'a dyn Fn(f64) -> Result<Scene, InputErrors>;

/// The curve at its last point.
#[derive(Clone)]
pub(super) struct CurvePosition {
    pub history: ContactHistory,
    pub here: SolvedHistory,
    pub before: Option<SolvedHistory>,
}

/// Guesses at a value by the line through the last two points of the curve.
pub(super) fn extrapolated(position: &CurvePosition, scene: &Scene, value: f64) -> Vec<PointGuess> {
    let CurvePosition { history, here, before } = position;
    let ratio = before.as_ref().map_or(0.0, |before| {
        let width = here.parameter - before.parameter;
        if width == 0.0 { 0.0 } else { (value - here.parameter) / width }
    });
    let guess = |(index, point): (usize, &PointGuess)| {
        let stage = history.points[index].stage;
        let last = here.scales.express(&point.state, stage, scene);
        let state = match before {
            Some(before) => {
                let first = before.scales.express(&before.points[index].state, stage, scene);
                last.advanced(&first.chord(&last), ratio)
            }
            None => last.clone(),
        };
        PointGuess { state, from: last, ..point.clone() }
    };
    here.points.iter().enumerate().map(guess).collect()
}
