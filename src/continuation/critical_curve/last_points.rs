//! The last points of a curve in one direction, to be compared with paths at its end.
//!
//! Between two changes of contact the equations of a curve do not look at the path: a change that comes and goes there is
//! seen on a path alone.

use crate::continuation::critical_curve::curve_outcome::DirectionEnd;
use crate::continuation::critical_curve::curve_position::CurvePosition;
use crate::continuation::critical_curve::history::solved_history::StateScales;
use crate::continuation::critical_curve::tolerances::{CLEAR_OF_CHANGE, CLEAR_OF_LOSS};
use crate::continuation::critical_curve::traced_paths::TracedPaths;
use crate::mechanics::problem::state::State;
use std::collections::VecDeque;

/// Points that are kept, the last ones.
const MOST_KEPT: usize = 256;

/// Points close to a change that are compared with paths, between one that is on a path and one that is not.
const MOST_BETWEEN: usize = 16;

/// A point of the curve that may be compared with a path.
#[derive(Clone)]
pub(super) struct PassedCritical {
    pub parameter: f64,
    /// Place along the curve.
    place: i64,
    pub stage: usize,
    pub state: State,
    pub scales: StateScales,
    /// No change of the curve lies close by: there two limit points, or a limit point and a change, are too close for the
    /// steps of a path.
    is_clear: bool,
}

/// The last points of a direction.
pub(super) struct LastPoints {
    points: VecDeque<PassedCritical>,
    /// The last value at which the curve changed.
    change: Option<f64>,
    /// Points closer to a change than this are not compared ...
    close: f64,
    /// ... nor those closer than this to the value past which the curve is lost.
    close_to_loss: f64,
}

impl LastPoints {
    /// None so far, of a curve with this longest step.
    pub fn none(longest_step: f64) -> Self {
        let [close, close_to_loss] = [CLEAR_OF_CHANGE, CLEAR_OF_LOSS].map(|part| part * longest_step);
        Self { points: VecDeque::new(), change: None, close, close_to_loss }
    }

    /// Keeps a point; `changes`: the curve changes there.
    pub fn keep(&mut self, position: &CurvePosition, place: i64, changes: bool) {
        let parameter = position.here.parameter;
        let is_close = |other: f64| (other - parameter).abs() < self.close;
        if changes {
            let crowded = self.points.iter_mut().rev().take_while(|one| is_close(one.parameter));
            crowded.for_each(|one| one.is_clear = false);
        }
        let is_clear = !changes && !self.change.is_some_and(is_close);
        if changes {
            self.change = Some(parameter);
        }
        if self.points.len() == MOST_KEPT {
            self.points.pop_front();
        }
        let here = &position.here;
        let stage = position.history.points.last().map_or(0, |point| point.stage);
        let (state, scales) = (here.critical().clone(), here.scales.clone());
        self.points.push_back(PassedCritical { parameter, place, stage, state, scales, is_clear });
    }

    /// The end of the direction, after one of its last points has been compared with a path of its own. Where they differ, the
    /// first point that is on no path is sought by bisection.
    pub fn compared(&self, end: DirectionEnd, paths: &mut TracedPaths<'_>) -> DirectionEnd {
        let lost = match &end {
            DirectionEnd::Lost { value, .. } | DirectionEnd::Model { value, .. } => Some(*value),
            _ => None,
        };
        let is_apart =
            |one: &&PassedCritical| lost.is_none_or(|lost| (one.parameter - lost).abs() >= self.close_to_loss);
        let clear: Vec<&PassedCritical> = self.points.iter().filter(|one| one.is_clear).filter(is_apart).collect();
        let Some(last) = clear.last() else { return end };
        if paths.has(last) {
            return end;
        }
        // The points before `on` are on paths, as far as that has been looked at; the one at `off` is not.
        let (mut on, mut off) = (0, clear.len() - 1);
        while on < off {
            let middle = on.midpoint(off);
            if paths.has(clear[middle]) { on = middle + 1 } else { off = middle }
        }
        let first = clear[off];
        let on = off.checked_sub(1).map(|on| self.last_on_path(clear[on], first, paths));
        let place = on.map_or(first.place, |on| on.place + first.place.signum());
        DirectionEnd::OffPath { value: first.parameter, last: on.map(|on| on.parameter), place, end: Box::new(end) }
    }

    /// The last of the points from `on`, which is on a path, to `off`, which is not, up to which all are on paths. Points
    /// close to a change count here: that a path has such a point is certain, that it has none is not.
    fn last_on_path<'a>(
        &'a self,
        on: &'a PassedCritical,
        off: &PassedCritical,
        paths: &mut TracedPaths<'_>,
    ) -> &'a PassedCritical {
        let after = self.points.iter().skip_while(|one| one.place != on.place).skip(1);
        let between = after.take_while(|one| one.place != off.place).take(MOST_BETWEEN);
        between.take_while(|one| paths.has(one)).last().unwrap_or(on)
    }

    /// The value of the last point.
    pub fn value(&self) -> Option<f64> {
        self.points.back().map(|one| one.parameter)
    }
}
