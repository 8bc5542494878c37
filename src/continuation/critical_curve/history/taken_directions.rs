//! Whether a path takes, at the points of a history, the directions by which the history goes on.
//!
//! The equations of a curve hold whichever direction the path prefers. Where the selection rule comes to prefer another one,
//! as where the other dissipates more from there on, the path goes elsewhere: before the critical point it does not come
//! there any more, and from the critical point it leaves otherwise.

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::feasible_direction::{PriorMotion, Rules};
use crate::branching::selection::selection_rule;
use crate::complementarity::rate_search::branch_and_bound::Effort;
use crate::continuation::critical_curve::history::contact_history::{
    ContactHistory, HistoryPoint, PointClosing, PointGuess,
};
use crate::continuation::critical_curve::history::solved_history::{SolvedHistory, scene_loading};
use crate::continuation::critical_curve::history::tolerances::SAME_DIRECTION;
use crate::continuation::path_state::resumable_state::constant_load;
use crate::continuation::scene::Scene;
use crate::mechanics::multi_contact::changeable_contacts::standings;
use crate::model::request::StageControl;
use crate::resources::cancel::CancelFlag;
use crate::step::event_functions::EventFunction;

/// For each point of the history whether the path takes its direction there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TakenDirections(Vec<bool>);

impl TakenDirections {
    /// Lists the directions at every point of the history at which contacts change, and takes one, as a path does.
    pub fn of(history: &ContactHistory, scene: &Scene, solved: &SolvedHistory, cancel: &CancelFlag) -> Self {
        let points = history.points.iter().zip(&solved.points);
        Self(points.map(|(point, at)| is_taken(history, scene, solved, (point, at), cancel)).collect())
    }

    /// The first point of the history at which this differs from others of the same history.
    pub fn first_difference(&self, other: &Self) -> Option<usize> {
        self.0.iter().zip(&other.0).position(|(own, other)| own != other)
    }

    /// Whether the path takes the direction of the history at one of its points.
    pub fn is_taken_at(&self, point: usize) -> bool {
        self.0.get(point).copied().unwrap_or(true)
    }
}

fn is_taken(
    history: &ContactHistory,
    scene: &Scene,
    solved: &SolvedHistory,
    (point, at): (&HistoryPoint, &PointGuess),
    cancel: &CancelFlag,
) -> bool {
    let Some(own) = at.leaving_rate.as_ref().filter(|_| point.changes) else { return true };
    let held = constant_load(scene, &solved.reached[..point.stage.min(solved.reached.len())]);
    let loading = scene_loading(scene, point.stage, &held);
    let stopped = match point.closing {
        PointClosing::Event(EventFunction::Sliding(contact)) => Some(contact),
        _ => None,
    };
    let before = match point.closing {
        PointClosing::StageBegin => PriorMotion::StageStart { free: None },
        _ => PriorMotion::Incoming(Incoming { modes: Some(&point.modes), stopped, ..Incoming::along(&at.rate) }),
    };
    let (analysis, force_scale) = (&scene.analysis, history.force_scale);
    let load_rises = scene.stages[point.stage].control == StageControl::Load;
    let effort = Effort { most_modes: analysis.max_modes, certify: !analysis.keep_all, cancel };
    let rules = Rules { selection: analysis.selection, load_rises, effort, force_scale };
    let standings = standings(loading, &at.state, force_scale);
    let decision = selection_rule::decide(loading, &at.state, &standings, before, rules);
    let taken = decision.taken.and_then(|taken| decision.options.get(taken));
    taken.is_some_and(|taken| taken.rate.product(own) > 1.0 - SAME_DIRECTION)
}
