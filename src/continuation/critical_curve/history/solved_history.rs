//! The points of a history at one value of the parameter, and the conditions under which a path comes along them.

use crate::continuation::critical_curve::history::branch_point_location::ModeBranch;
use crate::continuation::critical_curve::history::contact_history::{
    ContactHistory, HistoryPoint, PointClosing, PointGuess,
};
use crate::continuation::critical_curve::history::tolerances::{FOUND_ZERO, PASSED};
use crate::continuation::path_state::resumable_state::constant_load;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::equations::closing_equation::HyperplaneEquation;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::loading::{LoadPattern, Loading};
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use crate::step::event_functions::{self, EventFunction};

/// A quantity that is not negative where a path comes along the points of a history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PathCondition {
    /// Place of the point in the history.
    pub point: usize,
    pub about: ConditionSide,
    pub function: EventFunction,
}

impl PathCondition {
    /// Whether both are of the same quantity, whose bound may depend on the parameter.
    pub fn is_like(&self, other: &Self) -> bool {
        let is_bound = matches!(self.about, ConditionSide::StageEnd(_));
        self.point == other.point && self.about == other.about && (is_bound || self.function == other.function)
    }
}

/// Which quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ConditionSide {
    /// The event function where the path arrives.
    Arriving,
    /// The event function where the path leaves.
    Leaving,
    /// The slope with which an event function that is zero at the point begins.
    Beginning,
    /// A bound of the stage, by its place: the stage has not ended before.
    StageEnd(usize),
}

/// The scales of a scene, by which its states are dimensionless.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateScales {
    length: f64,
    force: f64,
    loads: Vec<f64>,
}

/// The points of a history at one value of the parameter.
#[derive(Debug, Clone)]
pub(crate) struct SolvedHistory {
    pub parameter: f64,
    pub points: Vec<PointGuess>,
    /// Modes at the critical point, with the directions of slip there.
    pub modes: Vec<Mode>,
    /// Loads at which the stages before that of the critical point ended, dimensionless.
    pub reached: Vec<f64>,
    pub residual: f64,
    /// The value of the event function at the critical point; 0 unless a plane stood in its place.
    pub off_event: f64,
    /// How far branches that met at the critical point pass each other (dimensionless); 0 where they meet.
    pub unfolding: f64,
    /// Conditions with their values, relative to the scales of the quantities.
    pub conditions: Vec<(PathCondition, f64)>,
    pub scales: StateScales,
}

/// The loading of all contacts of a scene in a stage.
pub(crate) fn scene_loading<'a>(scene: &'a Scene, stage: usize, held: &'a LoadPattern) -> Loading<'a> {
    Loading {
        structure: &scene.structure,
        contacts: &scene.contacts,
        corners: &scene.corners,
        pattern: &scene.stages[stage].pattern,
        held,
    }
}

impl StateScales {
    pub fn of(scene: &Scene) -> Self {
        let plan = scene.plan();
        let loads = scene.stages.iter().map(|stage| stage.load_scale).collect();
        Self { length: plan.displacement_scale, force: plan.force_scale, loads }
    }

    /// A state of a stage, made dimensionless by these scales, in those of another scene.
    pub fn express(&self, state: &State, stage: usize, scene: &Scene) -> State {
        let other = Self::of(scene);
        let mut state = state.clone();
        if other == *self {
            return state;
        }
        let (length, force) = (self.length / other.length, self.force / other.force);
        for node in 0..scene.structure.numbering.nodes() {
            for freedom in scene.structure.translations_of(node) {
                state.displacement[freedom] *= length;
                if let Some(remainder) = state.remainder.get_mut(freedom) {
                    *remainder *= length;
                }
            }
        }
        let ratio = self.loads[stage] / other.loads[stage];
        (state.load, state.load_remainder) = (ratio * state.load, ratio * state.load_remainder);
        for Reaction { normal, tangential } in &mut state.reactions {
            *normal *= force;
            tangential.iter_mut().for_each(|value| *value *= force);
        }
        state
    }
}

impl SolvedHistory {
    /// The state of the critical point.
    pub fn critical(&self) -> &State {
        &self.points[self.points.len() - 1].state
    }

    /// The least value of these conditions, with its condition.
    pub fn least_of(&self, which: &[PathCondition]) -> Option<(PathCondition, f64)> {
        let asked = self.conditions.iter().filter(|(one, _)| which.iter().any(|other| one.is_like(other)));
        asked.copied().min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// The conditions that do not hold.
    pub fn broken(&self) -> Vec<PathCondition> {
        self.conditions.iter().filter(|(_, value)| *value < -PASSED).map(|(condition, _)| *condition).collect()
    }

    /// The conditions that do not hold, and those that end just here: they are zero, and were not at the point before.
    pub fn ended_since(&self, before: &Self) -> Vec<PathCondition> {
        let held = |condition: &PathCondition| {
            before.conditions.iter().any(|(other, value)| other.is_like(condition) && *value > FOUND_ZERO)
        };
        let ended =
            |(condition, value): &&(PathCondition, f64)| *value < -PASSED || *value <= PASSED && held(condition);
        self.conditions.iter().filter(ended).map(|(condition, _)| *condition).collect()
    }

    /// Finds the points of the history, one after the other, near guesses; `None` where one of them is not found.
    pub fn of(
        history: &ContactHistory,
        scene: &Scene,
        parameter: f64,
        guesses: &[PointGuess],
        work: &mut Work,
    ) -> Option<Self> {
        Self::up_to(history, scene, parameter, guesses, None, work)
    }

    /// As [`of`](Self::of), but for the last point: in place of its event it has a plane.
    pub fn up_to(
        history: &ContactHistory,
        scene: &Scene,
        parameter: f64,
        guesses: &[PointGuess],
        plane: Option<HyperplaneEquation<'_>>,
        work: &mut Work,
    ) -> Option<Self> {
        let contacts = scene.contacts.len();
        if history.points.iter().any(|point| point.modes.len() != contacts || point.stage >= scene.stages.len()) {
            return None;
        }
        let mut anchor = State::at_rest(&scene.structure, contacts);
        let (mut reached, mut held) = (Vec::new(), constant_load(scene, &[]));
        let (mut points, mut conditions) = (Vec::with_capacity(history.points.len()), Vec::new());
        let (mut modes, mut residual, mut off_event, mut unfolding) = (Vec::new(), 0.0, 0.0, 0.0);
        for (place, (point, guess)) in history.points.iter().zip(guesses).enumerate() {
            if reached.len() < point.stage {
                while reached.len() < point.stage {
                    reached.push(anchor.take_load());
                }
                held = constant_load(scene, &reached);
            }
            if scene.structure.freedoms() != guess.state.displacement.len() {
                return None;
            }
            let loading = scene_loading(scene, point.stage, &held);
            let (point, guess) = (&point.in_frames(loading, &guess.state), &guess.in_frames(loading));
            let stage_ends = &scene.stages[point.stage].ends;
            if point.closing == PointClosing::StageBegin {
                let at = Solved { place, point, loading, force_scale: history.force_scale };
                let leaving = at.leave(&anchor, &guess.rate, &mut conditions, work)?;
                at.turns(None, Some(&leaving), &mut conditions);
                points.push(PointGuess {
                    state: anchor.clone(),
                    from: anchor.clone(),
                    rate: leaving.clone(),
                    leaving_rate: Some(leaving),
                    motion: None,
                });
                continue;
            }
            let closing = point.closing.event(stage_ends)?;
            let branch = ModeBranch { loading, modes: &point.modes, anchor: &anchor, force_scale: history.force_scale };
            let is_last = place + 1 == history.points.len();
            let mut found = match (closing, plane.filter(|_| is_last)) {
                (Some(closing), Some(plane)) => {
                    let (found, value) = branch.in_plane(closing, guess, plane, work)?;
                    off_event = value;
                    found
                }
                (Some(closing), None) => branch.locate(closing, guess, work)?,
                (None, _) => branch.locate_bifurcation(guess, work)?,
            };
            if let Some(EventFunction::End(end)) = closing {
                end.make_exact(&mut found.state);
            }
            let at = Solved { place, point, loading, force_scale: history.force_scale };
            at.arriving(&found.state, &found.rate, closing, stage_ends, &mut conditions);
            let leaving = match &guess.leaving_rate {
                Some(towards) if point.changes => Some(at.leave(&found.state, towards, &mut conditions, work)?),
                _ => None,
            };
            let is_smooth = matches!(closing, Some(EventFunction::LoadRate { .. }));
            at.turns(Some(&found.rate).filter(|_| !is_smooth), leaving.as_ref(), &mut conditions);
            (modes, residual, unfolding) = (found.modes, found.residual, found.unfolding);
            anchor = found.state.clone();
            points.push(PointGuess {
                from: anchor.clone(),
                state: found.state,
                rate: found.rate,
                leaving_rate: leaving,
                motion: found.motion,
            });
            let of_mode = anchor.reactions.iter_mut().zip(&point.leaving_modes);
            of_mode.filter(|(_, mode)| **mode == Mode::Free).for_each(|(reaction, _)| *reaction = Reaction::default());
        }
        let scales = StateScales::of(scene);
        Some(Self { parameter, points, modes, reached, residual, off_event, unfolding, conditions, scales })
    }
}

/// A point being judged.
struct Solved<'a> {
    place: usize,
    point: &'a HistoryPoint,
    loading: Loading<'a>,
    force_scale: f64,
}

impl Solved<'_> {
    fn condition(&self, about: ConditionSide, function: EventFunction) -> PathCondition {
        PathCondition { point: self.place, about, function }
    }

    /// The event functions of the mode that ends here, and the bounds of the stage.
    fn arriving(
        &self,
        state: &State,
        rate: &Rate,
        closing: Option<EventFunction>,
        stage_ends: &[End],
        conditions: &mut Vec<(PathCondition, f64)>,
    ) {
        let modes = &self.point.modes;
        for function in event_functions::of_mode(self.loading, modes, state, rate) {
            if Some(function) != closing {
                let value = function.value(self.loading, modes, state, rate);
                let scaled = value / function.scale(self.loading, state, self.force_scale);
                conditions.push((self.condition(ConditionSide::Arriving, function), scaled));
            }
        }
        for (place, end) in stage_ends.iter().enumerate() {
            let function = EventFunction::End(*end);
            if Some(function) != closing {
                let value = function.value(self.loading, modes, state, rate);
                conditions.push((self.condition(ConditionSide::StageEnd(place), function), value));
            }
        }
    }

    /// The direction in which the path leaves, with its conditions.
    fn leave(
        &self,
        state: &State,
        towards: &Rate,
        conditions: &mut Vec<(PathCondition, f64)>,
        work: &mut Work,
    ) -> Option<Rate> {
        let modes = &self.point.leaving_modes;
        let branch = ModeBranch { loading: self.loading, modes, anchor: state, force_scale: self.force_scale };
        let rate = branch.direction(state, towards, work)?;
        for function in event_functions::of_mode(self.loading, modes, state, &rate) {
            if matches!(function, EventFunction::Sliding(_)) {
                let value = function.value(self.loading, modes, state, &rate);
                conditions.push((self.condition(ConditionSide::Leaving, function), value));
            } else if self.point.touching.contains(&function)
                && let Some(slope) = function.slope(self.loading, modes, state, &rate)
            {
                let scaled = slope / function.scale(self.loading, state, self.force_scale);
                conditions.push((self.condition(ConditionSide::Beginning, function), scaled));
            }
        }
        Some(rate)
    }

    /// The load goes on or turns as it did, so that no limit point arises or vanishes here.
    fn turns(&self, arriving: Option<&Rate>, leaving: Option<&Rate>, conditions: &mut Vec<(PathCondition, f64)>) {
        let sides = [(ConditionSide::Arriving, arriving), (ConditionSide::Leaving, leaving)];
        for ((about, rate), sign) in sides.into_iter().zip(self.point.load_signs) {
            if let Some(rate) = rate.filter(|_| sign != 0.0) {
                conditions.push((self.condition(about, EventFunction::LoadRate { sign }), sign * rate.load));
            }
        }
    }
}
