//! The paths that are traced for a curve: past a change to go on from, and at its ends to compare its points with.

use crate::continuation::critical_curve::curve_position::{CurvePosition, SceneFamily, extrapolated};
use crate::continuation::critical_curve::cusp::Cusp;
use crate::continuation::critical_curve::history::contact_history::{ContactHistory, CriticalKind};
use crate::continuation::critical_curve::history::solved_history::SolvedHistory;
use crate::continuation::critical_curve::history::traced_history::PointsOnPath;
use crate::continuation::critical_curve::last_points::PassedCritical;
use crate::continuation::critical_curve::tolerances::{ON_PATH, SAME_POINT};
use crate::continuation::path_state::passed_points::PassedPoint;
use crate::continuation::scene::Scene;
use crate::mechanics::problem::state::State;
use crate::resources::cancel::CancelFlag;
use crate::step::corrector::cost_counters::Work;

/// Paths are at most this many times as long as the longest one so far up to the critical point, in increments ...
const MOST_PATH_FACTOR: u64 = 8;
/// ... and may be this long in any case.
const LEAST_PATH: u64 = 1_600;
/// Points of a path that are tried, those nearest to the curve.
const MOST_CANDIDATES: usize = 4;

/// The paths of a curve.
pub(super) struct TracedPaths<'a> {
    pub family: SceneFamily<'a>,
    pub cancel: CancelFlag,
    /// What the curve is made of.
    pub kind: CriticalKind,
    /// How many there have been.
    pub count: u64,
    /// Most increments of the next one.
    longest: u64,
}

/// What a path has past a change.
pub(super) struct PathPastChange {
    /// The curve at the point that continues it, if there is one.
    pub position: Option<CurvePosition>,
    /// Whether the path has points of that kind in this stage.
    pub has_any: bool,
}

impl<'a> TracedPaths<'a> {
    /// `index`: increments of the first path up to the critical point.
    pub fn new(family: SceneFamily<'a>, cancel: CancelFlag, kind: CriticalKind, index: u64) -> Self {
        Self { family, cancel, kind, count: 1, longest: LEAST_PATH.max(MOST_PATH_FACTOR.saturating_mul(index)) }
    }

    /// The point that continues the curve, on a path at a value past a change: followed back there, it is the same state
    /// but for `slack`. Unless `any`, no other change lies between them.
    pub fn past_change(
        &mut self,
        position: &CurvePosition,
        (change, slack): (&SolvedHistory, f64),
        (scene, value): (&Scene, f64),
        any: bool,
        work: &mut Work,
    ) -> PathPastChange {
        let stage = position.history.points.last().map_or(0, |point| point.stage);
        let points = self.near(&change.scales.express(change.critical(), stage, scene), stage, scene);
        let continues = |passed: &[PassedPoint]| {
            let (history, guesses) = ContactHistory::of(scene, passed).ok()?;
            let here = SolvedHistory::of(&history, scene, value, &guesses, work)?;
            let begin = CurvePosition { history, here, before: None };
            if !begin.here.broken().is_empty() {
                return None;
            }
            let (scene_at_change, back) = back_to(self.family, &begin, change.parameter, any, work)?;
            let at_change = back.scales.express(back.critical(), stage, &scene_at_change);
            let expected = change.scales.express(change.critical(), stage, &scene_at_change);
            let is_same = at_change.distance(&expected) <= SAME_POINT * (1.0 + expected.size()) + slack;
            is_same.then_some(CurvePosition { before: Some(back), ..begin })
        };
        let position = points.nearest_first().take(MOST_CANDIDATES).find_map(continues);
        PathPastChange { position, has_any: points.nearest_first().next().is_some() }
    }

    /// The limit point that comes from a cusp, on a path at a value past it.
    pub fn past_cusp(&mut self, cusp: &Cusp, (scene, value): (&Scene, f64), work: &mut Work) -> Option<CurvePosition> {
        let (at, stage) = (&cusp.at.here, cusp.at.history.points.last()?.stage);
        let points = self.near(&at.scales.express(at.critical(), stage, scene), stage, scene);
        let comes = |passed: &[PassedPoint]| {
            let (history, guesses) = ContactHistory::of(scene, passed).ok()?;
            let here = SolvedHistory::of(&history, scene, value, &guesses, work)?;
            let is_one = here.broken().is_empty() && cusp.leads_to(&here, scene);
            is_one.then_some(CurvePosition { history, here, before: None })
        };
        points.nearest_first().take(MOST_CANDIDATES).find_map(comes)
    }

    /// The points of the curve's kind on a path, those nearest to a state first.
    fn near(&mut self, state: &State, stage: usize, scene: &Scene) -> PointsOnPath {
        self.count += 1;
        let points = PointsOnPath::near(scene, (state, stage), self.kind, self.longest, &self.cancel);
        if let Some(nearest) = points.nearest_first().next().and_then(|points| points.last()) {
            self.longest = self.longest.max(MOST_PATH_FACTOR.saturating_mul(nearest.index));
        }
        points
    }

    /// Whether a path traced at the value of a point of the curve has this point.
    pub fn has(&mut self, point: &PassedCritical) -> bool {
        let Ok(scene) = (self.family)(point.parameter) else { return true };
        self.count += 1;
        let state = point.scales.express(&point.state, point.stage, &scene);
        let points = PointsOnPath::near(&scene, (&state, point.stage), self.kind, self.longest, &self.cancel);
        let nearest = points.nearest_first().next().and_then(|points| points.last());
        nearest.is_some_and(|found| found.state.distance(&state) <= ON_PATH * (1.0 + state.size()))
    }
}

/// The critical point of a history at the change that it comes from, by a few steps, with the scene there; unless `any`, the
/// conditions of its path hold on the way.
fn back_to(
    family: SceneFamily<'_>,
    begin: &CurvePosition,
    value: f64,
    any: bool,
    work: &mut Work,
) -> Option<(Scene, SolvedHistory)> {
    let mut position = begin.clone();
    for part in [0.5, 0.75, 0.9375] {
        let parameter = begin.here.parameter + part * (value - begin.here.parameter);
        let scene = family(parameter).ok()?;
        let next =
            SolvedHistory::of(&position.history, &scene, parameter, &extrapolated(&position, &scene, parameter), work)?;
        if !any && !next.broken().is_empty() {
            return None;
        }
        position.before = Some(std::mem::replace(&mut position.here, next));
    }
    let scene = family(value).ok()?;
    let back = SolvedHistory::of(&position.history, &scene, value, &extrapolated(&position, &scene, value), work)?;
    Some((scene, back))
}
