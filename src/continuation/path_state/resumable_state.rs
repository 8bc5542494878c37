//! Everything that determines the continuation of a path from its present point: the content of a checkpoint.

use crate::branching::bifurcation::singularity::test_functions::Signature;
use crate::branching::directions::feasible_direction::DirectionChoice;
use crate::continuation::path_state::motion::JumpProgress;
use crate::continuation::path_state::simultaneous_change_backoff::JoinBackoff;
use crate::continuation::path_state::totals::Totals;
use crate::continuation::path_state::visited_states::VisitedStates;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::loading::LoadPattern;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::structure::turning_nodes::TurningNodes;
use crate::result::increment::Point;
use crate::step::interpolation::PlacedPoint;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A path at its present point.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Progress {
    pub phase: Phase,
    pub stage: usize,
    /// The stage ended at the present point; the next one begins with the next increment.
    pub stage_over: bool,
    /// Loads at which the previous stages ended.
    pub reached: Vec<f64>,
    /// Constant load of the previous stages, for every contact of the scene: see [`hold`](Self::hold).
    #[serde(skip)]
    pub held: Arc<LoadPattern>,
    /// Indices of the scene's contacts in reach, in ascending order: each has one reaction and one mode.
    pub near: Vec<usize>,
    pub here: PresentPoint,
    /// Total rotation vectors from which those of nodes in space are measured, over all degrees of freedom; empty where
    /// none turns, and before the first step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub references: Vec<f64>,
    /// Arc length of the next attempted step.
    pub step: f64,
    /// Waiting time before contact changes are treated together again.
    pub waiting: JoinBackoff,
    /// Number of consecutive steps up to here that are too short for progress and change no contact.
    pub creeping: u64,
    pub totals: Totals,
    pub counts: StageCounts,
    /// States at which a direction was taken, to detect a cycle.
    pub visited: VisitedStates,
    /// The state in which the stage began and its first direction.
    pub begun: Option<(State, Rate)>,
    /// The motion, over all degrees of freedom, along which the structure moved without a change of its load where the stage
    /// before ended, at a limit point.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_motion: Option<Vec<f64>>,
    /// Directions listed with the present point.
    pub listed: Option<Listed>,
    /// The start of a path that follows another's direction.
    pub followed: Option<Followed>,
    /// A jump under way; the present point is then a state of its motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<JumpProgress>,
}

/// The present point and the data for its continuation.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct PresentPoint {
    pub state: State,
    pub modes: Vec<Mode>,
    /// Direction in `modes`; `None` before the stage's first decision.
    pub rate: Option<Rate>,
    pub load_sign: f64,
    /// Error of the path up to the present point, where known.
    pub drift: Option<Rate>,
    /// The previous point, in the same modes and of the same stage.
    pub before: Option<PlacedPoint>,
    /// Arc length between the last two contact changes, if both ended a step and the last is the present point.
    pub apart: Option<f64>,
    /// Signature to detect smooth bifurcations; `None` until known in these modes.
    pub signature: Option<Signature>,
    /// The direction was found with a factorisation that also serves for the step along it (`cached_factorisation`).
    #[serde(default)]
    pub is_factorised: bool,
    /// The equations of `modes` had a second null vector where the direction was taken.
    #[serde(default)]
    pub is_singular: bool,
    /// Offset of the path from the direction: see `choice::DirectionChoice`.
    #[serde(default)]
    pub beside: Option<Rate>,
}

/// Counts of the running stage.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(crate) struct StageCounts {
    pub increments: u64,
    pub limit_points: u64,
    pub contact_changes: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Phase {
    NotStarted,
    Running,
    Ended,
}

impl Progress {
    /// The state of a path before its first increment.
    pub fn new(scene: &Scene) -> Self {
        let near: Vec<usize> = if scene.analysis.keep_all { (0..scene.contacts.len()).collect() } else { Vec::new() };
        let contacts = near.len();
        Self {
            phase: Phase::NotStarted,
            stage: 0,
            stage_over: false,
            reached: Vec::new(),
            held: Arc::default(),
            near,
            here: PresentPoint {
                state: State::at_rest(&scene.structure, contacts),
                modes: vec![Mode::Free; contacts],
                rate: None,
                load_sign: 0.0,
                drift: None,
                before: None,
                apart: None,
                signature: None,
                is_factorised: false,
                is_singular: false,
                beside: None,
            },
            references: Vec::new(),
            step: scene.analysis.arc_length.initial,
            waiting: JoinBackoff::default(),
            creeping: 0,
            totals: Totals::begun(),
            counts: StageCounts::default(),
            visited: VisitedStates::default(),
            begun: None,
            free_motion: None,
            listed: None,
            followed: None,
            motion: None,
        }
    }
}

impl Progress {
    /// Adds contacts, which are free, to those in reach and renumbers these.
    pub fn admit(&mut self, contacts: &[usize]) {
        let before = self.near.clone();
        self.near.extend(contacts);
        self.near.sort_unstable();
        let old: Vec<Option<usize>> = self.near.iter().map(|contact| before.binary_search(contact).ok()).collect();
        let reactions = |values: &mut Vec<Reaction>| *values = spread(values, &old);
        let modes = |values: &mut Vec<Mode>| *values = spread_modes(values, &old);
        let rate = |rate: &mut Rate| reactions(&mut rate.reactions);
        let listed = |listed: &mut Listed| {
            for option in &mut listed.options {
                rate(&mut option.rate);
                modes(&mut option.modes);
            }
            listed.arriving.iter_mut().for_each(|arriving| modes(&mut arriving.modes));
        };
        let state = |state: &mut State| reactions(&mut state.reactions);
        state(&mut self.here.state);
        modes(&mut self.here.modes);
        self.here.rate.iter_mut().for_each(rate);
        self.here.drift.iter_mut().for_each(rate);
        if let Some(before) = &mut self.here.before {
            state(&mut before.state);
            rate(&mut before.rate);
        }
        if let Some((begun, direction)) = &mut self.begun {
            state(begun);
            rate(direction);
        }
        let passed = self.motion.iter_mut().flat_map(|motion| motion.row.iter_mut().chain([&mut motion.from]));
        passed.for_each(state);
        self.listed.iter_mut().for_each(listed);
        self.followed.iter_mut().for_each(|followed| listed(&mut followed.listed));
    }

    /// Expresses the present point, and points and rates near by, by other references of the rotations.
    pub fn express(&mut self, before: &TurningNodes, after: &TurningNodes) {
        let here = &mut self.here;
        let place = &here.state.displacement;
        let rate = |rate: &mut Rate| before.express(after, &mut place.clone(), Some(&mut rate.displacement));
        here.rate.iter_mut().chain(&mut here.drift).chain(&mut here.beside).for_each(rate);
        let listed = self.followed.iter_mut().map(|followed| &mut followed.listed).chain(&mut self.listed);
        for option in listed.flat_map(|listed| &mut listed.options) {
            rate(&mut option.rate);
            option.beside.iter_mut().for_each(rate);
        }
        let point = |state: &mut State, rate: &mut Rate| {
            before.express(after, &mut state.displacement, Some(&mut rate.displacement));
        };
        here.before.iter_mut().for_each(|before| point(&mut before.state, &mut before.rate));
        self.begun.iter_mut().for_each(|(state, rate)| point(state, rate));
        if let Some(motion) = &mut self.motion {
            let passed = motion.row.iter_mut().chain([&mut motion.from]);
            passed.for_each(|state| before.express(after, &mut state.displacement, None));
        }
        here.state.displacement = before.totals(&here.state.displacement).into_owned();
        self.references = after.references().to_vec();
    }

    /// Sums up the constant load of the previous stages: the same bits whenever it is computed.
    pub fn hold(&mut self, scene: &Scene) {
        self.held = Arc::new(constant_load(scene, &self.reached));
    }
}

/// The constant load of the stages that ended at these loads, for every contact of the scene.
pub(crate) fn constant_load(scene: &Scene, reached: &[f64]) -> LoadPattern {
    let mut held = scene.stages[0].pattern.zeroed();
    let mut parts = scene.stages.iter().zip(reached).peekable();
    while let Some((stage, load)) = parts.next() {
        // The parts of one stage add up to one load, however often it has turned.
        let mut sum = stage.sense * load;
        while let Some((part, load)) = parts.next_if(|(next, _)| Arc::ptr_eq(&next.of_stage, &stage.of_stage)) {
            sum += part.sense * load;
        }
        held.add(sum, &stage.of_stage);
    }
    held
}

fn spread(near: &[Reaction], places: &[Option<usize>]) -> Vec<Reaction> {
    places.iter().map(|place| place.map_or_else(Reaction::default, |place| near[place])).collect()
}

fn spread_modes(near: &[Mode], places: &[Option<usize>]) -> Vec<Mode> {
    places.iter().map(|place| place.map_or(Mode::Free, |place| near[place])).collect()
}

impl StageCounts {
    /// Whether one of the counts ends the stage.
    pub fn end_stage(&self, ends: &[End]) -> bool {
        ends.iter().any(|end| match end {
            End::LimitPoints(count) => self.limit_points >= *count,
            End::ContactChanges(count) => self.contact_changes >= *count,
            End::Increments(count) => self.increments >= *count,
            End::Load { .. } | End::Displacement { .. } => false,
        })
    }
}

/// The directions listed at a point, and the data of the point before one of them was taken.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Listed {
    pub options: Vec<DirectionChoice>,
    pub taken: Option<usize>,
    /// `None` where the path begins.
    pub arriving: Option<Arriving>,
    pub point: Point,
    pub residual: f64,
    pub error_estimate: f64,
}

/// The data with which a path arrives at a point.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Arriving {
    pub modes: Vec<Mode>,
    pub load_sign: f64,
    /// Counts that include the increment that led here, but not its events.
    pub counts: StageCounts,
}

/// The start of a path that follows a direction of another.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Followed {
    pub listed: Listed,
    pub direction: usize,
    pub event: String,
}
