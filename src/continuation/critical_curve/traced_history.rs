//! The history of a path that is traced for it.

use crate::continuation::critical_curve::contact_history::{ContactHistory, HistoryRefusal, PointGuess};
use crate::continuation::critical_curve::tolerances::ASKED_POINT;
use crate::continuation::path::iterator::Path;
use crate::continuation::path_state::passed_points::PassedPoint;
use crate::continuation::scene::Scene;
use crate::mechanics::problem::state::State;
use crate::model::request::Events;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::PointKind;
use crate::step::event_functions::EventFunction;

/// The critical point at which a curve starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveStart {
    /// The limit point of this number on the path, from 1.
    LimitPoint(u64),
    /// The increment of this index.
    Increment(u64),
}

/// Why there is no curve.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CurveRefusal {
    /// The path has too few limit points.
    #[error("the path has {found} limit points and ends; limit point {asked} was asked for")]
    NoLimitPoint {
        /// Number of limit points.
        found: u64,
        /// The one asked for, from 1.
        asked: u64,
    },
    /// The path ends before the increment.
    #[error("the path ends before increment {0}")]
    NoIncrement(u64),
    /// The increment is no limit point.
    #[error("increment {0} is no limit point; take one whose `point.kind` is `smooth_limit` or `nonsmooth_limit`")]
    NotCritical(u64),
    /// The point is not found where all contact changes are resolved.
    #[error("the limit point is not found on a path with all contact changes resolved")]
    NotResolved,
    /// The point is not found by its own equations.
    #[error("the limit point is not found by the equations of its history")]
    NotSolved,
    /// The history of the point.
    #[error(transparent)]
    History(#[from] HistoryRefusal),
    /// Cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// Whether a point of a path is a limit point.
fn is_limit(point: &PassedPoint) -> bool {
    matches!(point.kind, PointKind::SmoothLimit | PointKind::NonsmoothLimit)
        // Where a stage ends at a limit point its kind stays.
        || matches!(point.event, Some(EventFunction::LoadRate { .. }))
}

fn is_joined(point: &PassedPoint) -> bool {
    point.event.is_none() && point.leaving_modes != point.modes
}

/// The points of a path up to the critical point at which a curve starts.
///
/// # Errors
/// See [`CurveRefusal`].
pub(super) fn start(
    scene: &Scene,
    start: CurveStart,
    cancel: &CancelFlag,
) -> Result<(ContactHistory, Vec<PointGuess>), CurveRefusal> {
    let passed = up_to(scene, start, cancel)?;
    let passed = if passed.iter().any(is_joined) {
        let asked = passed[passed.len() - 1].clone();
        let mut nearest = near(scene, &asked.state, asked.stage, 4 * asked.index + 100, cancel);
        let found = nearest.drain(..).next().ok_or(CurveRefusal::NotResolved)?;
        let last = &found[found.len() - 1];
        if last.state.distance(&asked.state)
            > ASKED_POINT * (1.0 + asked.state.distance(&State::at_rest(&scene.structure, 0)))
        {
            return Err(CurveRefusal::NotResolved);
        }
        found
    } else {
        passed
    };
    Ok(ContactHistory::of(scene, &passed)?)
}

/// The points of the path as it was asked for, up to the critical point.
fn up_to(scene: &Scene, start: CurveStart, cancel: &CancelFlag) -> Result<Vec<PassedPoint>, CurveRefusal> {
    let mut path = Path::new(scene, cancel.clone());
    path.keep_passed_points();
    let mut limits = 0;
    let mut seen = 0;
    while let Some(increment) = path.next() {
        let passed = path.passed_points();
        let fresh = passed[seen..].last().filter(|point| is_limit(point));
        seen = passed.len();
        limits += u64::from(fresh.is_some());
        match start {
            CurveStart::LimitPoint(asked) if fresh.is_some() && limits == asked => return Ok(passed.to_vec()),
            CurveStart::Increment(index) if increment.index == index => {
                return if fresh.is_some() { Ok(passed.to_vec()) } else { Err(CurveRefusal::NotCritical(index)) };
            }
            CurveStart::LimitPoint(_) | CurveStart::Increment(_) => {}
        }
    }
    Err(match start {
        _ if cancel.is_cancelled() => CurveRefusal::Cancelled,
        CurveStart::LimitPoint(asked) => CurveRefusal::NoLimitPoint { found: limits, asked },
        CurveStart::Increment(index) => CurveRefusal::NoIncrement(index),
    })
}

/// The limit points of a stage on a path with all contact changes resolved, each with the points before, those nearest to a
/// state first; of the first `most` increments.
pub(super) fn near(
    scene: &Scene,
    expected: &State,
    stage: usize,
    most: u64,
    cancel: &CancelFlag,
) -> Vec<Vec<PassedPoint>> {
    let mut scene = scene.clone();
    scene.analysis.events = Events::All;
    scene.analysis.max_increments = scene.analysis.max_increments.max(most);
    let mut path = Path::new(&scene, cancel.clone());
    path.keep_passed_points();
    while path.next().is_some_and(|increment| increment.index < most) {}
    let passed = path.passed_points();
    let limits = passed.iter().enumerate().filter(|(_, point)| point.stage == stage && is_limit(point));
    let mut limits: Vec<(f64, usize)> = limits.map(|(place, point)| (point.state.distance(expected), place)).collect();
    limits.sort_by(|a, b| a.0.total_cmp(&b.0));
    limits.iter().map(|(_, place)| passed[..=*place].to_vec()).collect()
}
