//! The history of a path that is traced for it, to a point that can be followed in a parameter.

use crate::continuation::critical_curve::history::contact_history::{
    ContactHistory, CriticalKind, HistoryRefusal, PointGuess,
};
use crate::continuation::critical_curve::history::tolerances::ASKED_POINT;
use crate::continuation::path::iterator::Path;
use crate::continuation::path_state::passed_points::PassedPoint;
use crate::continuation::scene::Scene;
use crate::mechanics::problem::state::State;
use crate::model::request::Events;
use crate::resources::cancel::CancelFlag;

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
    /// Nothing that can be followed happens at the increment.
    #[error(
        "increment {0} cannot be followed in a parameter; take one whose `point.kind` is `smooth_limit`, \
         `nonsmooth_limit`, `smooth_bifurcation` or `contact_change`"
    )]
    NotCritical(u64),
    /// The point is not found where all contact changes are resolved.
    #[error("the point is not found on a path with all contact changes resolved")]
    NotResolved,
    /// The point is not found by its own equations.
    #[error(
        "the point is not found by the equations of its history; a bifurcation point must be simple: two branches meet \
         there, and no contact touches without a force"
    )]
    NotSolved,
    /// The history of the point.
    #[error(transparent)]
    History(#[from] HistoryRefusal),
    /// Cancelled.
    #[error("cancelled")]
    Cancelled,
}

fn is_joined(point: &PassedPoint) -> bool {
    point.event.is_none() && point.leaving_modes != point.modes
}

/// The critical point at which a curve starts.
pub(crate) struct FirstPoint {
    pub history: ContactHistory,
    pub guesses: Vec<PointGuess>,
    pub kind: CriticalKind,
    /// Index of its increment.
    pub index: u64,
}

/// Traces a path to the critical point at which a curve starts.
///
/// # Errors
/// See [`CurveRefusal`].
pub(crate) fn start(scene: &Scene, start: CurveStart, cancel: &CancelFlag) -> Result<FirstPoint, CurveRefusal> {
    let (passed, kind) = up_to(scene, start, cancel)?;
    let asked = &passed[passed.len() - 1];
    if !passed.iter().any(is_joined) {
        return first(scene, &passed, kind);
    }
    let near = (&asked.state, asked.stage);
    let points = PointsOnPath::near(scene, near, kind, 4 * asked.index + 100, cancel);
    let found = points.nearest_first().next().ok_or(CurveRefusal::NotResolved)?;
    let off = found[found.len() - 1].state.distance(&asked.state);
    let is_other = off > ASKED_POINT * (1.0 + asked.state.size());
    if is_other { Err(CurveRefusal::NotResolved) } else { first(scene, found, kind) }
}

fn first(scene: &Scene, passed: &[PassedPoint], kind: CriticalKind) -> Result<FirstPoint, CurveRefusal> {
    let (history, guesses) = ContactHistory::of(scene, passed)?;
    Ok(FirstPoint { history, guesses, kind, index: passed[passed.len() - 1].index })
}

/// The points of the path as it was asked for, up to the critical point.
fn up_to(
    scene: &Scene,
    start: CurveStart,
    cancel: &CancelFlag,
) -> Result<(Vec<PassedPoint>, CriticalKind), CurveRefusal> {
    let mut path = Path::new(scene, cancel.clone());
    path.keep_passed_points();
    let mut limits = 0;
    let mut seen = 0;
    while let Some(increment) = path.next() {
        let passed = path.passed_points();
        let fresh = passed[seen..].last().and_then(CriticalKind::of);
        seen = passed.len();
        limits += u64::from(fresh == Some(CriticalKind::Limit));
        match (start, fresh) {
            (CurveStart::LimitPoint(asked), Some(kind @ CriticalKind::Limit)) if limits == asked => {
                return Ok((path.into_passed_points(), kind));
            }
            (CurveStart::Increment(index), fresh) if increment.index == index => {
                let kind = fresh.ok_or(CurveRefusal::NotCritical(index))?;
                return Ok((path.into_passed_points(), kind));
            }
            _ => {}
        }
    }
    let why = path.report().map_or_else(String::new, |report| report.sentence);
    Err(match start {
        _ if cancel.is_cancelled() => CurveRefusal::Cancelled,
        CurveStart::LimitPoint(asked) => CurveRefusal::NoLimitPoint { found: limits, asked, why },
        CurveStart::Increment(index) => CurveRefusal::NoIncrement { index, why },
    })
}

/// The points of one kind in a stage on a path with all contact changes resolved.
pub(crate) struct PointsOnPath {
    passed: Vec<PassedPoint>,
    /// Places of those points among them, the one nearest to a state first.
    found: Vec<usize>,
}

impl PointsOnPath {
    /// Traces the first `most` increments of a path.
    pub fn near(
        scene: &Scene,
        (expected, stage): (&State, usize),
        kind: CriticalKind,
        most: u64,
        cancel: &CancelFlag,
    ) -> Self {
        let mut scene = scene.clone();
        scene.analysis.events = Events::All;
        scene.analysis.max_increments = scene.analysis.max_increments.max(most);
        let mut path = Path::new(&scene, cancel.clone());
        path.keep_passed_points();
        while path.next().is_some_and(|increment| increment.index < most) {}
        let passed = path.into_passed_points();
        let found = passed.iter().enumerate().filter(|(_, point)| point.stage == stage && kind.has(point));
        let mut found: Vec<(f64, usize)> =
            found.map(|(place, point)| (point.state.distance(expected), place)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { passed, found: found.into_iter().map(|(_, place)| place).collect() }
    }

    /// The points of the path up to each of those points, the nearest one first.
    pub fn nearest_first(&self) -> impl Iterator<Item = &[PassedPoint]> {
        self.found.iter().map(|place| &self.passed[..=*place])
    }
}
