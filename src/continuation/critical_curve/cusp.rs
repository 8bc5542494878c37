//! Where a curve of limit points passes through a bifurcation point.
//!
//! The limit points of an imperfect structure come to the bifurcation point of the perfect one: its distance from them falls
//! with the third root of the imperfection, and the difference of their loads with the power 2/3 (W. T. Koiter, *On the
//! Stability of Elastic Equilibrium*, Delft 1945). Over the parameter the curve has a cusp there, and no small step leads past
//! it; but the bifurcation point with its unfolding is a smooth function of the parameter, so that the value at which the
//! unfolding vanishes is found directly.

use crate::continuation::critical_curve::curve_position::{CurvePosition, SceneFamily};
use crate::continuation::critical_curve::history::contact_history::{ContactHistory, PointClosing};
use crate::continuation::critical_curve::history::solved_history::SolvedHistory;
use crate::continuation::critical_curve::history::tolerances::UNFOLDED;
use crate::continuation::critical_curve::tolerances::CUSP_EXPONENTS;
use crate::continuation::scene::Scene;
use crate::result::increment::PointKind;
use crate::step::corrector::cost_counters::Work;

/// Corrections of the value at which the unfolding vanishes.
const MOST_CORRECTIONS: usize = 6;

/// A bifurcation point that a curve of limit points passes through.
pub(super) struct Cusp {
    pub scene: Scene,
    /// The history to the bifurcation point, and the solution there.
    pub at: CurvePosition,
    /// Distance of a limit point from it (dimensionless), over the third root of that of the parameter.
    steepness: f64,
}

impl Cusp {
    /// The cusp ahead of the last point of a curve that goes in this sense of the parameter, at most so far from it.
    pub fn ahead(
        family: SceneFamily<'_>,
        place: &CurvePosition,
        (sense, reach): (f64, f64),
        work: &mut Work,
    ) -> Option<Self> {
        let before = place.before.as_ref()?;
        if place.history.kind != PointKind::SmoothLimit {
            return None;
        }
        let history = to_bifurcation(&place.history)?;
        let mut solve = |solved: &SolvedHistory, value: f64| {
            let scene = family(value).ok()?;
            let mut guesses = solved.points.clone();
            let stage = history.points.last()?.stage;
            for guess in &mut guesses {
                guess.state = solved.scales.express(&guess.state, stage, &scene);
                guess.from = guess.state.clone();
            }
            let found = SolvedHistory::of(&history, &scene, value, &guesses, work)?;
            Some((scene, found))
        };
        // The unfolding has no sign here; both values lie on the same side of the cusp.
        let mut first = solve(before, before.parameter)?.1;
        let mut last = solve(&place.here, place.here.parameter)?.1;
        for _ in 0..MOST_CORRECTIONS {
            let slope = (last.unfolding - first.unfolding) / (last.parameter - first.parameter);
            let value = last.parameter - last.unfolding / slope;
            let ahead = sense * (value - place.here.parameter);
            if !(0.0..=reach).contains(&ahead) {
                return None;
            }
            let (scene, found) = solve(&last, value)?;
            if found.unfolding <= UNFOLDED {
                return Self::confirmed(scene, CurvePosition { history, here: found, before: None }, place, before);
            }
            (first, last) = (last, found);
        }
        None
    }

    /// The cusp, if the last two limit points come to it as they should.
    fn confirmed(scene: Scene, at: CurvePosition, place: &CurvePosition, before: &SolvedHistory) -> Option<Self> {
        let stage = at.history.points.last()?.stage;
        let off = |solved: &SolvedHistory| {
            let state = solved.scales.express(solved.critical(), stage, &scene);
            (state.distance(at.here.critical()), (solved.parameter - at.here.parameter).abs())
        };
        let (near, far) = (off(&place.here), off(before));
        let exponent = (far.0 / near.0).ln() / (far.1 / near.1).ln();
        let [least, most] = CUSP_EXPONENTS;
        (least..=most).contains(&exponent).then(|| Self { steepness: near.0 / near.1.cbrt(), scene, at })
    }

    /// Whether a limit point at a value past the cusp comes from there.
    pub fn leads_to(&self, solved: &SolvedHistory, scene: &Scene) -> bool {
        let Some(stage) = self.at.history.points.last().map(|point| point.stage) else { return false };
        let state = self.at.here.scales.express(self.at.here.critical(), stage, scene);
        let steepness = state.distance(solved.critical()) / (solved.parameter - self.at.here.parameter).abs().cbrt();
        (0.5 * self.steepness..=2.0 * self.steepness).contains(&steepness)
    }
}

/// The same history up to the singular point of the branch, in place of its limit point.
fn to_bifurcation(history: &ContactHistory) -> Option<ContactHistory> {
    let mut history = history.clone();
    history.kind = PointKind::SmoothBifurcation;
    history.points.last_mut()?.closing = PointClosing::Bifurcation;
    Some(history)
}
