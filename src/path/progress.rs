//! Everything that decides how a path goes on from its present point: what a checkpoint holds.

use super::at_once::Waiting;
use super::follow::{Followed, Listed};
use super::history::History;
use super::interpolation::Placed;
use super::loading::LoadPattern;
use super::scene::{End, Scene};
use super::singular::Signature;
use super::state::{Rate, State};
use super::totals::Totals;
use crate::contact::{Mode, Reaction};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A path at its present point.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Progress {
    pub phase: Phase,
    pub stage: usize,
    /// The stage ended at the present point; the next one begins with the next increment.
    pub stage_over: bool,
    /// Loads at which the stages before ended.
    pub reached: Vec<f64>,
    /// What they hold, of every contact of the scene: see [`hold`](Self::hold).
    #[serde(skip)]
    pub held: Arc<LoadPattern>,
    /// Which of the scene's contacts are in reach, in order: reactions and modes are theirs, one each.
    pub near: Vec<usize>,
    pub here: Here,
    /// Arc length that the next step tries.
    pub step: f64,
    /// When contact changes are to be taken together again.
    pub waiting: Waiting,
    /// Steps at which no contact changes, one after another up to here, that are too short to get anywhere.
    pub creeping: u64,
    pub totals: Totals,
    pub counts: StageCounts,
    /// States at which a direction was taken, for telling a cycle.
    pub visited: History,
    /// Where the stage began and the direction it took.
    pub begun: Option<(State, Rate)>,
    /// Directions listed with the present point.
    pub listed: Option<Listed>,
    /// Where a path that follows another's direction begins.
    pub followed: Option<Followed>,
}

/// The present point and how the path goes on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Here {
    pub state: State,
    pub modes: Vec<Mode>,
    /// Direction in `modes`; `None` before the stage's first decision.
    pub rate: Option<Rate>,
    pub load_sign: f64,
    /// Error of the path up to here, where it has one.
    pub drift: Option<Rate>,
    /// The point before, in the same modes and of the same stage.
    pub before: Option<Placed>,
    /// Arc length from one contact change to the next, where both ended a step and the last is the present point.
    pub apart: Option<f64>,
    /// Signs that tell smooth bifurcations; `None` until known in these modes.
    pub signature: Option<Signature>,
    /// The direction was found with a factorisation that serves the step along it (`at_hand`).
    #[serde(default)]
    pub is_factorised: bool,
    /// The equations of `modes` had another null vector where the direction was taken.
    #[serde(default)]
    pub is_singular: bool,
    /// How far the path is off the direction: see `decide::Choice`.
    #[serde(default)]
    pub beside: Option<Rate>,
}

/// A state that the path has passed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Visited {
    pub stage: usize,
    pub displacement: Vec<f64>,
    pub load: f64,
    /// The contacts that are not free, in order.
    pub held: Vec<Held>,
}

/// A contact of the scene that sticks or slips.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Held {
    pub contact: usize,
    pub mode: Mode,
    pub reaction: Reaction,
}

impl Visited {
    /// Bytes that a state of a scene takes, with all contacts held.
    pub fn most_bytes(scene: &Scene) -> usize {
        scene.structure.freedoms() * size_of::<f64>() + scene.contacts.len() * size_of::<Held>() + size_of::<Self>()
    }

    /// Whether another state is this one, but for differences below `distance` (of displacements and load together) and
    /// `force`.
    pub fn is(&self, other: &Self, distance: f64, force: f64) -> bool {
        let alike = |(one, other): (&Held, &Held)| {
            one.contact == other.contact
                && one.mode.continues(other.mode)
                && one.reaction.difference(&other.reaction) < force
        };
        let apart = |(one, other): (&f64, &f64)| (one - other).powi(2);
        // Most differ in the load alone.
        self.stage == other.stage
            && (self.load - other.load).abs() < distance
            && self.held.len() == other.held.len()
            && self.held.iter().zip(&other.held).all(alike)
            && self.displacement.iter().zip(&other.displacement).map(apart).sum::<f64>()
                + (self.load - other.load).powi(2)
                < distance * distance
    }
}

/// What has been counted in the running stage.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct StageCounts {
    pub increments: u64,
    pub limit_points: u64,
    pub contact_changes: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Phase {
    NotStarted,
    Running,
    Ended,
}

impl Progress {
    /// Before the first increment.
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
            here: Here {
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
            step: scene.analysis.arc_length.initial,
            waiting: Waiting::default(),
            creeping: 0,
            totals: Totals::begun(),
            counts: StageCounts::default(),
            visited: History::default(),
            begun: None,
            listed: None,
            followed: None,
        }
    }
}

impl Progress {
    /// Sums up what the stages before hold: the same bits whenever it is done.
    pub fn hold(&mut self, scene: &Scene) {
        let mut held = scene.stages[0].pattern.zeroed();
        for (stage, load) in scene.stages.iter().zip(&self.reached) {
            held.add(*load, &stage.pattern);
        }
        self.held = Arc::new(held);
    }
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
