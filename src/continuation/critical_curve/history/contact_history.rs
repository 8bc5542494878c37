//! The changes of contact by which a path comes to a critical point.
//!
//! Friction remembers: a contact sticks where it came to rest, and where that is depends on the parameter. But between two
//! changes of contact the equations of one mode hold, and they know of the past only the place at which the mode began. The
//! points at which contacts change therefore determine each other one after the other, and the critical point at last: each
//! is the zero of its event function on the branch of its mode, from the point before. With another value of the parameter
//! the same points are found again by Newton's method, without the path between them.

use crate::continuation::critical_curve::history::solved_history::scene_loading;
use crate::continuation::critical_curve::history::tolerances::{OUT_OF_PLANE, ZERO_AT_POINT};
use crate::continuation::path_state::passed_points::PassedPoint;
use crate::continuation::path_state::resumable_state::constant_load;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled, size};
use crate::mechanics::contact::{ContactPair, Mode, Sliding, all_continue};
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::result::increment::PointKind;
use crate::step::event_functions::{self, EventFunction};

/// What kind of points a curve is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CriticalKind {
    /// Smooth and nonsmooth limit points.
    Limit,
    /// Smooth bifurcation points.
    Bifurcation,
    /// Points at which a contact changes, whether the load turns there or not.
    ContactChange,
}

impl CriticalKind {
    /// The kind of a point of a path; `None` of a point that cannot be followed.
    pub fn of(point: &PassedPoint) -> Option<Self> {
        match (point.kind, point.event) {
            (PointKind::SmoothLimit | PointKind::NonsmoothLimit, _) => Some(Self::Limit),
            // Where a stage ends at a limit point its kind stays.
            (_, Some(EventFunction::LoadRate { .. })) => Some(Self::Limit),
            (PointKind::SmoothBifurcation, _) => Some(Self::Bifurcation),
            (PointKind::ContactChange, _) => Some(Self::ContactChange),
            _ => None,
        }
    }

    /// Whether a point of a path may be one of a curve of this kind.
    pub fn has(self, point: &PassedPoint) -> bool {
        let is_turning = self == Self::ContactChange && point.kind == PointKind::NonsmoothLimit;
        is_turning || Self::of(point) == Some(self)
    }
}

/// Why a critical point cannot be followed in a parameter.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum HistoryRefusal {
    /// Contacts changed together.
    #[error("contacts change together within an increment before the point, although all changes were to be resolved")]
    Joined,
    /// Several contacts slip in a plane.
    #[error(
        "{0} slips against friction in a plane, where the direction of slip turns along the path: such a path is no \
         sequence of points; sweep the parameter instead"
    )]
    TurningSlip(String),
    /// Rotations in space.
    #[error(
        "nodes turn in space, where a path depends on the references of its rotations; sweep the parameter instead"
    )]
    TurningNodes,
    /// Friction between bodies, or on an obstacle that turns.
    #[error(
        "{0} touches another body, or an obstacle that turns, with friction, where the slip is summed up along the path; \
         sweep the parameter instead"
    )]
    SlidingBodies(String),
    /// A count of increments.
    #[error("stage \"{0}\" ends after a number of increments, which is no state of the structure; give it another end")]
    CountedEnd(String),
}

/// A point of the history.
#[derive(Debug, Clone)]
pub(crate) struct HistoryPoint {
    pub stage: usize,
    /// Modes in which the path arrives and leaves.
    pub modes: Vec<Mode>,
    pub leaving_modes: Vec<Mode>,
    /// Whether contacts change here.
    pub changes: bool,
    pub closing: PointClosing,
    /// Signs of the load rate with which the path arrives and leaves; 0 where it is zero, or the path does not change.
    pub load_signs: [f64; 2],
    /// Event functions of the mode after the point that are zero at it.
    pub touching: Vec<EventFunction>,
}

impl HistoryPoint {
    /// The same point with its directions of slip in the tangent planes at a state, where another model has turned them.
    pub fn in_frames(&self, loading: Loading<'_>, state: &State) -> Self {
        let turned = |modes: &[Mode]| -> Vec<Mode> {
            let in_plane = |(contact, mode): (usize, &Mode)| match *mode {
                Mode::Slip { direction } => {
                    let normal = loading.frame(contact, state).normal;
                    Mode::Slip { direction: unit_part(&direction, &normal) }
                }
                other => other,
            };
            modes.iter().enumerate().map(in_plane).collect()
        };
        Self { modes: turned(&self.modes), leaving_modes: turned(&self.leaving_modes), ..self.clone() }
    }
}

impl PointGuess {
    /// The same guess with its tangential reactions in the tangent planes at its state, where another model has turned them.
    pub fn in_frames(&self, loading: Loading<'_>) -> Self {
        let mut guess = self.clone();
        for (contact, reaction) in guess.state.reactions.iter_mut().enumerate() {
            let normal = loading.frame(contact, &self.state).normal;
            reaction.tangential = tangential_part(&reaction.tangential, &normal);
        }
        guess
    }
}

/// The direction of a vector without its part along a normal; the vector itself where nothing of it is left, or nothing is taken.
fn unit_part(vector: &Vector, normal: &Vector) -> Vector {
    let part = tangential_part(vector, normal);
    let length = size(&part);
    if part == *vector || length == 0.0 { *vector } else { scaled(&part, 1.0 / length) }
}

/// A vector without its part along a normal; the vector itself where that part is round-off.
fn tangential_part(vector: &Vector, normal: &Vector) -> Vector {
    let along = dot(vector, normal);
    if along.abs() <= OUT_OF_PLANE * size(vector) { *vector } else { add(vector, -along, normal) }
}

/// What is zero at a point of the history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PointClosing {
    Event(EventFunction),
    /// A bound of the stage, by its place among them.
    StageEnd(usize),
    /// Nothing: the stage begins here.
    StageBegin,
    /// The equations along the branch are singular: another branch crosses it.
    Bifurcation,
}

impl PointClosing {
    /// The event function that is zero; none at a bifurcation point. `None` where the stage begins, or has no such bound.
    pub fn event(self, stage_ends: &[End]) -> Option<Option<EventFunction>> {
        match self {
            Self::Event(event) => Some(Some(event)),
            Self::StageEnd(place) => Some(Some(EventFunction::End(*stage_ends.get(place)?))),
            Self::Bifurcation => Some(None),
            Self::StageBegin => None,
        }
    }
}

/// The state of a point and the directions of the path there, where Newton's method starts.
#[derive(Debug, Clone)]
pub(crate) struct PointGuess {
    pub state: State,
    /// The converged point from which the state was extrapolated; the state itself where there is none.
    pub from: State,
    pub rate: Rate,
    pub leaving_rate: Option<Rate>,
    /// At a bifurcation point the motion that becomes free, where it is known.
    pub motion: Option<Rate>,
}

/// The points by which a path comes to a critical point, the last of them.
#[derive(Debug, Clone)]
pub(crate) struct ContactHistory {
    pub points: Vec<HistoryPoint>,
    pub kind: PointKind,
    /// For each contact whether it has friction in the model of the path: without, its slips have no sense that friction opposes.
    pub frictional: Vec<bool>,
    pub force_scale: f64,
}

impl ContactHistory {
    /// The history of the last of these points of a path, and where its points are.
    ///
    /// # Errors
    /// See [`HistoryRefusal`].
    pub fn of(scene: &Scene, passed: &[PassedPoint]) -> Result<(Self, Vec<PointGuess>), HistoryRefusal> {
        refuse_scene(scene)?;
        let (mut points, mut guesses) = (Vec::new(), Vec::new());
        let last = passed.len().saturating_sub(1);
        let mut reached: Vec<f64> = Vec::new();
        let mut load = 0.0;
        for (place, point) in passed.iter().enumerate() {
            refuse_modes(scene, &point.modes)?;
            while reached.len() < point.stage {
                reached.push(std::mem::take(&mut load));
            }
            load = point.state.load;
            let changes = point.kind == PointKind::Start || !all_continue(&point.leaving_modes, &point.modes);
            // A limit point or bifurcation point on the way leaves no trace.
            if place < last && !changes && !point.stage_ends {
                continue;
            }
            let closing = match CriticalKind::of(point) {
                Some(CriticalKind::Bifurcation) if place == last => PointClosing::Bifurcation,
                _ => closing(scene, point)?,
            };
            let touching = if changes { touching(scene, point, &reached) } else { Vec::new() };
            points.push(HistoryPoint {
                stage: point.stage,
                modes: point.modes.clone(),
                leaving_modes: point.leaving_modes.clone(),
                changes,
                closing,
                load_signs: [sign(Some(&point.rate)), sign(point.leaving_rate.as_ref().filter(|_| changes))],
                touching,
            });
            guesses.push(PointGuess {
                state: point.state.clone(),
                from: point.state.clone(),
                rate: point.rate.clone(),
                leaving_rate: point.leaving_rate.clone().filter(|_| changes),
                motion: None,
            });
        }
        let critical = &passed[last];
        // Where a stage ends at its limit point, the point says so by its event.
        let is_smooth = matches!(critical.event, Some(EventFunction::LoadRate { .. }));
        let kind = if is_smooth { PointKind::SmoothLimit } else { critical.kind };
        let frictional = scene.contacts.iter().map(|contact| contact.tangents() > 0).collect();
        Ok((Self { points, kind, frictional, force_scale: critical.force_scale }, guesses))
    }

    /// Whether contacts have friction in this model that had none in that of the path: the path may slip otherwise there.
    pub fn gets_friction(&self, scene: &Scene) -> bool {
        let mut pairs = self.frictional.iter().zip(&scene.contacts);
        pairs.any(|(had, contact)| !had && contact.tangents() > 0)
    }
}

/// Load rates below this have no sign.
const NO_LOAD_RATE: f64 = 1e-9;

fn sign(rate: Option<&Rate>) -> f64 {
    let load = rate.map_or(0.0, |rate| rate.load);
    if load.abs() <= NO_LOAD_RATE { 0.0 } else { load.signum() }
}

/// The event functions of the mode after a point that are zero there.
fn touching(scene: &Scene, point: &PassedPoint, reached: &[f64]) -> Vec<EventFunction> {
    let Some(rate) = &point.leaving_rate else { return Vec::new() };
    let held = constant_load(scene, reached);
    let loading = scene_loading(scene, point.stage, &held);
    let of_mode = event_functions::of_mode(loading, &point.leaving_modes, &point.state, rate);
    let is_zero = |function: &EventFunction| {
        let value = function.value(loading, &point.leaving_modes, &point.state, rate);
        value.abs() <= ZERO_AT_POINT * function.scale(loading, &point.state, point.force_scale)
    };
    of_mode.into_iter().filter(is_zero).collect()
}

fn closing(scene: &Scene, point: &PassedPoint) -> Result<PointClosing, HistoryRefusal> {
    let stage = &scene.stages[point.stage];
    match point.event {
        _ if point.kind == PointKind::Start => Ok(PointClosing::StageBegin),
        Some(EventFunction::End(end)) => {
            let place = stage.ends.iter().position(|other| *other == end);
            place.map(PointClosing::StageEnd).ok_or_else(|| HistoryRefusal::CountedEnd(stage.name.to_string()))
        }
        Some(event) => Ok(PointClosing::Event(event)),
        None if point.stage_ends => Err(HistoryRefusal::CountedEnd(stage.name.to_string())),
        None => Err(HistoryRefusal::Joined),
    }
}

fn refuse_scene(scene: &Scene) -> Result<(), HistoryRefusal> {
    if scene.structure.turning.are_there() {
        return Err(HistoryRefusal::TurningNodes);
    }
    let bodies = scene.contacts.iter().position(|one| one.tangents() > 0 && one.kinematics.node().is_none());
    bodies.map_or(Ok(()), |contact| Err(HistoryRefusal::SlidingBodies(scene.contact_names[contact].0.to_string())))
}

fn refuse_modes(scene: &Scene, modes: &[Mode]) -> Result<(), HistoryRefusal> {
    let turns = |(mode, contact): (&Mode, &ContactPair)| {
        matches!(mode, Mode::Slip { .. }) && contact.tangents() > 0 && contact.sliding == Sliding::Plane
    };
    let turning = modes.iter().zip(&scene.contacts).position(turns);
    turning.map_or(Ok(()), |contact| Err(HistoryRefusal::TurningSlip(scene.contact_names[contact].0.to_string())))
}
