//! A point of a curve of critical points in the user's units and names.

use crate::continuation::critical_curve::history::contact_history::{
    ContactHistory, CriticalKind, HistoryPoint, PointClosing,
};
use crate::continuation::critical_curve::history::solved_history::{
    ConditionSide, PathCondition, SolvedHistory, scene_loading,
};
use crate::continuation::critical_curve::meeting_changes::MeetingChanges;
use crate::continuation::path_state::resumable_state::constant_load;
use crate::continuation::path_state::row_conversion::{self, RowSource};
use crate::continuation::path_state::totals::Totals;
use crate::continuation::scene::Scene;
use crate::result::increment::{Increment, Point, PointKind};
use crate::step::corrector::cost_counters::Work;
use crate::step::event_functions::EventFunction;

/// A point of a curve of critical points.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// Place along the curve: 0 at its start, above 0 towards larger values first, below 0 towards smaller ones.
    pub place: i64,
    /// The value of the parameter.
    pub value: f64,
    /// Whether the curve's points change their kind here, or the path to them its changes of contact.
    pub codimension_two: bool,
    /// Whether the point was found on a path traced for it.
    pub from_path: bool,
    /// Load factors at which the stages before ended.
    pub stage_ends: Vec<f64>,
    /// The scales of the model at this value, as its plan has them: of lengths, and of the load of each stage.
    pub displacement_scale: f64,
    pub load_scales: Vec<f64>,
    /// The state: displacements, contacts, forces, load factor; `point.kind` is the kind of the critical point. It has no
    /// energies, no arc length and no slip, which are of the path.
    pub increment: Increment,
}

/// The data of a point besides its state.
pub(super) struct PointNote {
    pub event: Option<String>,
    pub codimension_two: bool,
    pub from_path: bool,
}

/// Converts the critical point of a solved history.
pub(super) fn point(
    scene: &Scene,
    history: &ContactHistory,
    solved: &SolvedHistory,
    note: PointNote,
    work: Work,
) -> CurvePoint {
    let held = constant_load(scene, &solved.reached);
    let stage = history.points.last().map_or(0, |point| point.stage);
    let loading = scene_loading(scene, stage, &held);
    let places: Vec<Option<usize>> = (0..scene.contacts.len()).map(Some).collect();
    let rows: Vec<usize> = (0..scene.reported.len()).collect();
    let point = Point::plain(history.kind, note.event);
    let state = solved.critical();
    let mut totals = Totals::begun();
    (totals.work, totals.force_scale) = (work, history.force_scale);
    let row = RowSource {
        stage,
        stability: None,
        loading,
        whole: loading,
        places: &places,
        rows: &rows,
        state,
        before: state,
        modes: &solved.modes,
        step: 0.0,
        point: &point,
        options: &[],
        taken: None,
        residual: solved.residual,
        error_estimate: 0.0,
        elapsed_s: 0.0,
        mode_named: None,
    };
    let ends = scene.stages.iter().zip(&solved.reached).map(|(stage, load)| stage.load_factor(*load));
    CurvePoint {
        place: 0,
        value: solved.parameter,
        codimension_two: note.codimension_two,
        from_path: note.from_path,
        stage_ends: ends.collect(),
        displacement_scale: scene.plan().displacement_scale,
        load_scales: scene.plan().load_scales.clone(),
        increment: row_conversion::increment(scene, &totals, &row),
    }
}

/// A value as sentences tell it, without the round-off of its last digits.
pub(crate) fn in_words(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// The kind of a critical point in words.
pub(super) fn kind_name(kind: PointKind) -> &'static str {
    match kind {
        PointKind::NonsmoothLimit => "nonsmooth limit point",
        PointKind::SmoothBifurcation => "bifurcation point",
        PointKind::ContactChange => "contact change",
        _ => "smooth limit point",
    }
}

/// What a curve is made of, in words.
pub(super) fn plural_name(kind: CriticalKind) -> &'static str {
    match kind {
        CriticalKind::Limit => "limit points",
        CriticalKind::Bifurcation => "bifurcation points",
        CriticalKind::ContactChange => "contact changes",
    }
}

/// What is told where the path takes another direction from here on, or that of the curve again.
pub(super) fn describe_direction(history: &ContactHistory, point: usize, is_own: bool) -> String {
    let which = if is_own {
        "along the direction of the curve again"
    } else {
        "along another direction, which the rule prefers from here on"
    };
    format!("the path leaves {} {which}", place_name(history, point))
}

/// The number of a change on the way to the critical point, from 1, and how many there are.
fn changes_before(history: &ContactHistory, place: usize) -> (usize, usize) {
    let changes = |points: &[HistoryPoint]| points.iter().filter(|one| one.closing != PointClosing::StageBegin).count();
    (changes(&history.points[..=place]), changes(&history.points) - 1)
}

/// A point of the history in words.
fn place_name(history: &ContactHistory, place: usize) -> String {
    let kind = kind_name(history.kind);
    if place + 1 == history.points.len() {
        return format!("the {kind}");
    }
    let (count, all) = changes_before(history, place);
    if history.points[place].closing == PointClosing::StageBegin {
        return "the point where a stage begins".to_owned();
    }
    format!("change {count} of the {all} by which it comes to the {kind}")
}

/// What happens where a condition ends.
pub(super) fn describe(scene: &Scene, history: &ContactHistory, condition: &PathCondition) -> String {
    let kind = kind_name(history.kind);
    let point = &history.points[condition.point];
    let critical = (condition.point + 1 == history.points.len()).then_some(history.kind);
    let what = what_happens(scene, condition.function, (critical, condition.about));
    if condition.point + 1 == history.points.len() {
        return format!("{what} at the {kind}");
    }
    if point.closing == PointClosing::StageBegin {
        return format!("{what} where stage \"{}\" begins", scene.stages[point.stage].name);
    }
    let (count, all) = changes_before(history, condition.point);
    format!("{what} at change {count} of the {all} by which the path comes to the {kind}")
}

/// What is told where two changes of contact meet.
pub(super) fn describe_meeting(scene: &Scene, meeting: &MeetingChanges) -> String {
    let [first, second] = meeting.events.map(|function| what_happens(scene, function, (None, ConditionSide::Arriving)));
    let value = in_words(meeting.value);
    format!("{first} and {second} at the same place: these two changes of contact meet at {value} and vanish")
}

/// What is told where the event function of a change of contact touches zero without passing it.
pub(super) fn describe_grazing(scene: &Scene, history: &ContactHistory) -> String {
    let closing = history.points.last().map(|point| point.closing);
    let Some(PointClosing::Event(function)) = closing else { return "the curve turns back".to_owned() };
    let what = what_happens(scene, function, (None, ConditionSide::Arriving));
    format!("{what} by touching the bound only (grazing): past it, this contact does not change here")
}

/// What happens where a function is zero. `critical`: the kind of the critical point, where it is one of its conditions.
fn what_happens(
    scene: &Scene,
    function: EventFunction,
    (critical, about): (Option<PointKind>, ConditionSide),
) -> String {
    let pair = |contact: usize| {
        let (node, obstacle) = &scene.contact_names[contact];
        (node.to_string(), obstacle.to_string())
    };
    let of_corner = |corner: usize| {
        let first = scene.corners.get(corner).and_then(|corner| corner.contacts.first());
        first.map_or_else(String::new, |contact| pair(*contact).0)
    };
    match function {
        EventFunction::Gap(contact) => {
            let (node, obstacle) = pair(contact);
            format!("{node} touches {obstacle}")
        }
        EventFunction::Normal(contact) => {
            let (node, obstacle) = pair(contact);
            format!("{node} leaves {obstacle}")
        }
        EventFunction::Cone { contact, .. } => {
            let (node, obstacle) = pair(contact);
            format!("{node} begins to slip on {obstacle}")
        }
        EventFunction::Sliding(contact) => {
            let (node, obstacle) = pair(contact);
            format!("{node} stops slipping on {obstacle}")
        }
        EventFunction::SurfaceEnd(contact) => {
            let (node, surface) = pair(contact);
            format!("{node} comes to the end of {surface}")
        }
        EventFunction::Facet { corner, .. }
        | EventFunction::Slide { corner }
        | EventFunction::Hold { corner }
        | EventFunction::Return { corner } => format!("{} begins to slip in its corner", of_corner(corner)),
        EventFunction::LoadRate { .. } => of_load_rate(critical, about).to_owned(),
        EventFunction::End(_) => "the stage ends".to_owned(),
    }
}

/// What happens where the load rate is zero at a critical point of this kind, or at a change before it.
fn of_load_rate(critical: Option<PointKind>, about: ConditionSide) -> &'static str {
    match (critical, about) {
        (None, _) => "the load rate changes its sign",
        (Some(PointKind::SmoothBifurcation), _) => "the load turns",
        (Some(PointKind::ContactChange), ConditionSide::Leaving) => "the load turns from here on",
        (Some(_), ConditionSide::Leaving) => "the load no longer turns",
        (Some(_), _) => "the load turns before the contact changes",
    }
}
