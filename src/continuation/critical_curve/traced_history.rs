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
    #[error("limit point {asked} was asked for; the path has {found} of them and ends: {why}")]
    NoLimitPoint {
        /// Number of limit points.
        found: u64,
        /// The one asked for, from 1.
        asked: u64,
        /// Why the path ends, in words.
        why: String,
    },
    /// The path ends before the increment.
    #[error("the path ends before increment {index}: {why}")]
    NoIncrement {
        /// Index of the increment.
        index: u64,
        /// Why the path ends, in words.
        why: String,
    },
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

/// The critical point at which a curve starts.
pub(super) struct FirstPoint {
    pub history: ContactHistory,
    pub guesses: Vec<PointGuess>,
    /// Index of its increment.
    pub index: u64,
}

/// Traces a path to the critical point at which a curve starts.
///
/// # Errors
/// See [`CurveRefusal`].
pub(super) fn start(scene: &Scene, start: CurveStart, cancel: &CancelFlag) -> Result<FirstPoint, CurveRefusal> {
    let passed = up_to(scene, start, cancel)?;
    let asked = &passed[passed.len() - 1];
    if !passed.iter().any(is_joined) {
        return first(scene, &passed);
    }
    let limits = LimitsOnPath::near(scene, &asked.state, asked.stage, 4 * asked.index + 100, cancel);
    let found = limits.nearest_first().next().ok_or(CurveRefusal::NotResolved)?;
    let off = found[found.len() - 1].state.distance(&asked.state);
    if off > ASKED_POINT * (1.0 + asked.state.size()) { Err(CurveRefusal::NotResolved) } else { first(scene, found) }
}

fn first(scene: &Scene, passed: &[PassedPoint]) -> Result<FirstPoint, CurveRefusal> {
    let (history, guesses) = ContactHistory::of(scene, passed)?;
    Ok(FirstPoint { history, guesses, index: passed[passed.len() - 1].index })
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
            CurveStart::LimitPoint(asked) if fresh.is_some() && limits == asked => return Ok(path.into_passed_points()),
            CurveStart::Increment(index) if increment.index == index => {
                return if fresh.is_some() {
                    Ok(path.into_passed_points())
                } else {
                    Err(CurveRefusal::NotCritical(index))
                };
            }
            CurveStart::LimitPoint(_) | CurveStart::Increment(_) => {}
        }
    }
    let why = path.report().map_or_else(String::new, |report| report.sentence);
    Err(match start {
        _ if cancel.is_cancelled() => CurveRefusal::Cancelled,
        CurveStart::LimitPoint(asked) => CurveRefusal::NoLimitPoint { found: limits, asked, why },
        CurveStart::Increment(index) => CurveRefusal::NoIncrement { index, why },
    })
}

/// The limit points of a stage on a path with all contact changes resolved.
pub(super) struct LimitsOnPath {
    passed: Vec<PassedPoint>,
    /// Places of the limit points among them, the one nearest to a state first.
    limits: Vec<usize>,
}

impl LimitsOnPath {
    /// Traces the first `most` increments of a path.
    pub fn near(scene: &Scene, expected: &State, stage: usize, most: u64, cancel: &CancelFlag) -> Self {
        let mut scene = scene.clone();
        scene.analysis.events = Events::All;
        scene.analysis.max_increments = scene.analysis.max_increments.max(most);
        let mut path = Path::new(&scene, cancel.clone());
        path.keep_passed_points();
        while path.next().is_some_and(|increment| increment.index < most) {}
        let passed = path.into_passed_points();
        let limits = passed.iter().enumerate().filter(|(_, point)| point.stage == stage && is_limit(point));
        let mut limits: Vec<(f64, usize)> =
            limits.map(|(place, point)| (point.state.distance(expected), place)).collect();
        limits.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { passed, limits: limits.into_iter().map(|(_, place)| place).collect() }
    }

    /// The points of the path up to each limit point, the nearest one first.
    pub fn nearest_first(&self) -> impl Iterator<Item = &[PassedPoint]> {
        self.limits.iter().map(|place| &self.passed[..=*place])
    }
}
