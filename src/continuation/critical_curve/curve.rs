//! The curve of critical points, from one value of the parameter to the next.

use crate::algebra::scalar_root::find_root;
use crate::continuation::critical_curve::contact_history::{ContactHistory, PointGuess};
use crate::continuation::critical_curve::critical_point::{self, CurvePoint, PointNote};
use crate::continuation::critical_curve::solved_history::{PathCondition, SolvedHistory, StateScales};
use crate::continuation::critical_curve::tolerances::{
    CLEAR_OF_CHANGE, FOUND_ZERO, LARGEST_DEVIATION, MODEL_STEP, ON_PATH, PASSED, PAST_CHANGE, SAME_POINT,
    SHORTEST_CHORD, SHORTEST_STEP, STEP_GROWTH, TURNING_STEP,
};
use crate::continuation::critical_curve::traced_history::{self, CurveRefusal, CurveStart};
use crate::continuation::critical_curve::turning_point::{self, TurningPoint};
use crate::continuation::path_state::passed_points::PassedPoint;
use crate::continuation::scene::Scene;
use crate::mechanics::problem::state::State;
use crate::model::InputErrors;
use crate::model::input::limits::MAX_CURVE_POINTS;
use crate::resources::cancel::CancelFlag;
use crate::step::corrector::cost_counters::Work;
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// Paths that are traced past a change are at most this many times as long as the first one, in increments ...
const MOST_PATH_FACTOR: u64 = 8;
/// ... and at least this long.
const LEAST_PATH: u64 = 200;
/// Changes that are found in one step, each before the other, until one has no other before.
const MOST_CHANGES: usize = 6;
/// Critical points of such a path that are tried.
const MOST_CANDIDATES: usize = 4;
/// Points that are kept to be compared with a path.
const MOST_KEPT: usize = 256;
/// Most points of a curve: five times as many as the range may have steps, for what comes in addition.
const MOST_POINTS: u64 = 5 * MAX_CURVE_POINTS;

/// The values of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveRange {
    /// Least value.
    pub from: f64,
    /// Largest value.
    pub to: f64,
    /// The value in the model, at which the curve starts; between the others.
    pub start: f64,
    /// Longest step between two values.
    pub step: f64,
}

/// How a curve ended in one direction of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum DirectionEnd {
    /// At the end of the range.
    Range,
    /// The critical point is lost past this value: the path traced there has none that continues the curve.
    Lost {
        /// The last value at which it is.
        value: f64,
        /// What happens there, in words.
        why: String,
    },
    /// The curve ended so, but points of it are on no path: one that the equations between its changes do not see came before.
    OffPath {
        /// The value of the first such point, as far as points were kept.
        value: f64,
        /// The last value before it at which the point is on a path; `None` where none is known.
        last: Option<f64>,
        /// How the curve ended.
        end: Box<DirectionEnd>,
    },
    /// The curve comes back to its start.
    Closed,
    /// The curve has as many points as one may have; the last is at this value.
    Long {
        /// The value.
        value: f64,
    },
    /// The model is refused from this value on.
    Model {
        /// The value.
        value: f64,
        /// The mistakes.
        errors: InputErrors,
    },
}

/// How a curve ended.
#[derive(Debug, Clone, PartialEq)]
pub enum CurveEnd {
    /// In both directions.
    Complete {
        /// Towards smaller values.
        below: DirectionEnd,
        /// Towards larger values.
        above: DirectionEnd,
    },
    /// By the flag, or by the receiver of the points.
    Cancelled,
}

/// A curve's end and its work.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveReport {
    /// How it ended.
    pub end: CurveEnd,
    /// Points of the curve.
    pub points: u64,
    /// Paths traced for it, the first one included.
    pub paths: u64,
    /// Newton iterations, without those of the paths.
    pub newton_iterations: u64,
}

/// A scene for each value of a parameter.
pub type SceneFamily<'a> = &'a dyn Fn(f64) -> Result<Scene, InputErrors>;

/// Receives the points of a curve in the order in which they are found; breaks to end it.
pub type AcceptPoint<'a> = &'a mut dyn FnMut(CurvePoint) -> ControlFlow<()>;

/// A curve of critical points.
pub struct CriticalCurve<'a> {
    family: SceneFamily<'a>,
    range: CurveRange,
    cancel: CancelFlag,
    work: Work,
    points: u64,
    /// Place along the curve of the next point, and the sense in which it is followed.
    place: i64,
    sense: f64,
    paths: u64,
    /// Most increments of a path that is traced past a change.
    longest_path: u64,
    /// The last points of the direction that is followed.
    passed: VecDeque<PassedLimit>,
    /// The last value at which the curve changed.
    change: Option<f64>,
}

/// Why a direction, or the curve, goes no further.
enum Stopped {
    Cancelled,
    Ended(DirectionEnd),
}

/// The curve at its last point.
#[derive(Clone)]
pub(super) struct CurvePosition {
    pub history: ContactHistory,
    pub here: SolvedHistory,
    pub before: Option<SolvedHistory>,
}

/// A point of the curve that may be compared with a path.
#[derive(Clone)]
struct PassedLimit {
    parameter: f64,
    stage: usize,
    state: State,
    scales: StateScales,
    /// No change of the curve lies close by.
    is_clear: bool,
}

/// What a path has past a change.
struct FoundOnPath {
    /// The curve at its critical point, if one continues it.
    place: Option<CurvePosition>,
    /// Whether it has any in this stage.
    has_limits: bool,
}

/// The curve as it is followed in one direction.
struct Walk {
    place: CurvePosition,
    /// Sense of the parameter, 1 or -1.
    sense: f64,
    /// The next step of the parameter.
    step: f64,
    has_turned: bool,
}

impl Walk {
    /// The end of the range in front.
    fn target(&self, range: &CurveRange) -> f64 {
        if self.sense < 0.0 { range.from } else { range.to }
    }

    fn shorten(&mut self) -> ControlFlow<Stopped> {
        self.step *= 0.5;
        ControlFlow::Continue(())
    }
}

impl<'a> CriticalCurve<'a> {
    /// A curve that has not begun.
    pub fn new(family: SceneFamily<'a>, range: CurveRange, cancel: CancelFlag) -> Self {
        let (work, longest_path) = (Work::default(), LEAST_PATH);
        Self {
            family,
            range,
            cancel,
            work,
            points: 0,
            place: 0,
            sense: 1.0,
            paths: 0,
            longest_path,
            passed: VecDeque::new(),
            change: None,
        }
    }

    /// Follows the curve from a critical point of the path to larger, then to smaller values.
    ///
    /// # Errors
    /// There is no such point, or it cannot be followed; mistakes of the model at the first value.
    pub fn follow(mut self, start: CurveStart, accept: AcceptPoint<'_>) -> Result<CurveReport, CurveFailure> {
        let scene = (self.family)(self.range.start).map_err(CurveFailure::Model)?;
        self.paths += 1;
        let (history, guesses) = traced_history::start(&scene, start, &self.cancel)?;
        let solved = SolvedHistory::of(&history, &scene, self.range.start, &guesses, &mut self.work);
        let here = solved.ok_or(CurveRefusal::NotSolved)?;
        let begin = CurvePosition { history, here, before: None };
        let mut ends = Vec::new();
        let note = PointNote { event: None, codimension_two: false, from_path: true };
        let mut end = self.emit(&scene, &begin, note, accept).err();
        if end.is_none() {
            for sense in [1.0, -1.0] {
                (self.sense, self.place) = (sense, if sense < 0.0 { -1 } else { 1 });
                if ends.first() == Some(&DirectionEnd::Closed) {
                    // The other direction goes through the same points.
                    ends.push(DirectionEnd::Closed);
                    break;
                }
                self.passed.clear();
                self.change = None;
                match self.towards(begin.clone(), sense, accept) {
                    Stopped::Ended(direction) => ends.push(self.checked(direction)),
                    Stopped::Cancelled => {
                        end = Some(Stopped::Cancelled);
                        break;
                    }
                }
            }
        }
        let end = match (end, ends.pop(), ends.pop()) {
            (None, Some(below), Some(above)) => CurveEnd::Complete { below, above },
            _ => CurveEnd::Cancelled,
        };
        let (points, paths, newton_iterations) = (self.points, self.paths, self.work.newton_iterations);
        Ok(CurveReport { end, points, paths, newton_iterations })
    }

    /// The end of a direction, after one of its last points has been compared with a path of its own: between two changes of
    /// contact the path is not looked at. Where they differ, the first point that is on no path is sought by bisection.
    fn checked(&mut self, end: DirectionEnd) -> DirectionEnd {
        // Close to changes two limit points, or a limit point and a change, are too close for the steps of a path.
        let lost = match &end {
            DirectionEnd::Lost { value, .. } | DirectionEnd::Model { value, .. } => Some(*value),
            _ => None,
        };
        let close = CLEAR_OF_CHANGE * self.range.step;
        let is_apart = |one: &&PassedLimit| lost.is_none_or(|lost| (one.parameter - lost).abs() >= close);
        let clear: Vec<PassedLimit> = self.passed.iter().filter(|one| one.is_clear).filter(is_apart).cloned().collect();
        let Some(last) = clear.last() else { return end };
        if self.is_on_path(last) {
            return end;
        }
        let (mut on, mut off) = (None, clear.len() - 1);
        while on.map_or(0, |on: usize| on + 1) < off {
            let middle = (on.map_or(0, |on| on + 1) + off) / 2;
            if self.is_on_path(&clear[middle]) { on = Some(middle) } else { off = middle }
        }
        DirectionEnd::OffPath {
            value: clear[off].parameter,
            last: on.map(|on| clear[on].parameter),
            end: Box::new(end),
        }
    }

    /// Whether a path traced at the value of a point has this limit point.
    fn is_on_path(&mut self, point: &PassedLimit) -> bool {
        let Ok(scene) = (self.family)(point.parameter) else { return true };
        self.paths += 1;
        let most = self.longest_path.max(MOST_PATH_FACTOR * LEAST_PATH);
        let state = point.scales.express(&point.state, point.stage, &scene);
        let limits = traced_history::near(&scene, &state, point.stage, most, &self.cancel);
        let nearest = limits.first().and_then(|points| points.last());
        nearest.is_some_and(|found| found.state.distance(&state) <= ON_PATH * (1.0 + size_of(&state)))
    }

    /// Follows the curve in one sense of the parameter, to an end of the range.
    fn towards(&mut self, begin: CurvePosition, sense: f64, accept: AcceptPoint<'_>) -> Stopped {
        let first = begin.here.critical().clone();
        let mut walk = Walk { place: begin, sense, step: self.range.step, has_turned: false };
        loop {
            if walk.place.here.parameter == walk.target(&self.range) {
                return Stopped::Ended(DirectionEnd::Range);
            }
            if let ControlFlow::Break(stopped) = self.step(&mut walk, accept) {
                return stopped;
            }
            let is_start = walk.has_turned && walk.place.here.parameter == self.range.start;
            if is_start && walk.place.here.critical().distance(&first) <= SAME_POINT * (1.0 + size_of(&first)) {
                return Stopped::Ended(DirectionEnd::Closed);
            }
            if self.points >= MOST_POINTS {
                return Stopped::Ended(DirectionEnd::Long { value: walk.place.here.parameter });
            }
        }
    }

    /// One step of the parameter; a shorter one is tried next where it fails.
    fn step(&mut self, walk: &mut Walk, accept: AcceptPoint<'_>) -> ControlFlow<Stopped> {
        if self.cancel.is_cancelled() {
            return ControlFlow::Break(Stopped::Cancelled);
        }
        let here = walk.place.here.parameter;
        let value = self.next_value(here, walk.sense, walk.step, walk.target(&self.range));
        let is_shortest = walk.step <= self.shortest();
        let scene = match (self.family)(value) {
            Ok(scene) => scene,
            Err(errors) if walk.step <= MODEL_STEP * self.range.step => {
                return ControlFlow::Break(Stopped::Ended(DirectionEnd::Model { value, errors }));
            }
            Err(_) => return walk.shorten(),
        };
        if walk.place.history.gets_friction(&scene) {
            let from = walk.place.here.clone();
            return self.go_on_past(walk, &from, accept, || "friction begins there".to_owned());
        }
        let Some(solved) = self.near(&walk.place, &scene, value) else {
            if walk.step <= TURNING_STEP * self.range.step
                && let Some(turn) = turning_point::turn(self.family, &walk.place, walk.sense, &mut self.work)
            {
                return self.turn_back(walk, turn, accept);
            }
            if !is_shortest {
                return walk.shorten();
            }
            let from = walk.place.here.clone();
            let lost = || "steps became too short, and no solution of its equations was found near by".to_owned();
            return self.go_on_past(walk, &from, accept, lost);
        };
        let broken = solved.broken();
        if broken.is_empty() {
            walk.step = (walk.step * STEP_GROWTH).min(self.range.step);
            return self.send(&scene, &mut walk.place, solved, accept);
        }
        let Some((scene, change, condition)) = self.change_before(&walk.place, value, &solved, &broken) else {
            if !is_shortest {
                return walk.shorten();
            }
            let why = "a condition of the path ends there, and the place is not found".to_owned();
            return ControlFlow::Break(Stopped::Ended(DirectionEnd::Lost { value: here, why }));
        };
        let what = critical_point::describe(&scene, &walk.place.history, &condition);
        let note = PointNote { event: Some(what.clone()), codimension_two: true, from_path: false };
        let at_change = CurvePosition { here: change.clone(), history: walk.place.history.clone(), before: None };
        flow(self.emit(&scene, &at_change, note, accept))?;
        walk.step = self.range.step;
        if change.parameter == walk.target(&self.range) {
            return ControlFlow::Break(Stopped::Ended(DirectionEnd::Range));
        }
        self.go_on_past(walk, &change, accept, || what)
    }

    /// Goes round a point where the curve turns back in the parameter.
    fn turn_back(&mut self, walk: &mut Walk, turn: TurningPoint, accept: AcceptPoint<'_>) -> ControlFlow<Stopped> {
        let TurningPoint { at: (scene, at), past: (scene_past, past) } = turn;
        let event = Some("a load maximum and a load minimum meet and vanish; the curve turns back".to_owned());
        walk.place.here = at.clone();
        flow(self.emit(&scene, &walk.place, PointNote { event, codimension_two: true, from_path: false }, accept))?;
        if !past.broken().is_empty() {
            let why = "a condition of the path ends where the curve turns back".to_owned();
            return ControlFlow::Break(Stopped::Ended(DirectionEnd::Lost { value: at.parameter, why }));
        }
        walk.sense = -walk.sense;
        walk.has_turned = true;
        walk.step = (past.parameter - at.parameter).abs().max(self.shortest());
        self.send(&scene_past, &mut walk.place, past, accept)?;
        // The chord from the turning point is no direction of the curve, which begins there at a right angle.
        walk.place.before = None;
        ControlFlow::Continue(())
    }

    /// The critical point at a value, found from the last ones of the curve; `None` where it is not the same one.
    fn near(&mut self, place: &CurvePosition, scene: &Scene, value: f64) -> Option<SolvedHistory> {
        let guesses = extrapolated(place, scene, value);
        let solved = SolvedHistory::of(&place.history, scene, value, &guesses, &mut self.work)?;
        let stage = place.history.points.last()?.stage;
        let critical = guesses.last()?;
        let before = place.here.scales.express(place.here.critical(), stage, scene);
        let chord = before.distance(solved.critical()).max(SHORTEST_CHORD);
        let off = critical.state.distance(solved.critical());
        // Before the second point there is no direction of the curve.
        let most = if place.before.is_some() { LARGEST_DEVIATION * chord } else { 0.1 * (1.0 + chord) };
        (off <= most).then_some(solved)
    }

    /// The first value at which one of these conditions ends, between the last point and a value past it; `None` where none of
    /// them is found to be zero, as at a pole.
    fn change_before(
        &mut self,
        place: &CurvePosition,
        value: f64,
        past: &SolvedHistory,
        broken: &[PathCondition],
    ) -> Option<(Scene, SolvedHistory, PathCondition)> {
        let (mut value, mut past, mut broken) = (value, past.clone(), broken.to_vec());
        for _ in 0..MOST_CHANGES {
            let (scene, solved) = self.root(place, value, &past, &broken)?;
            let (condition, off) = solved.least_of(&broken)?;
            if off.abs() > FOUND_ZERO {
                return None;
            }
            let before = solved.broken();
            if before.is_empty() {
                return Some((scene, solved, condition));
            }
            // Another condition has ended before.
            (value, past, broken) = (solved.parameter, solved, before);
        }
        None
    }

    /// A value at which the least of these conditions is zero, between the last point and a value past it.
    fn root(
        &mut self,
        place: &CurvePosition,
        value: f64,
        past: &SolvedHistory,
        broken: &[PathCondition],
    ) -> Option<(Scene, SolvedHistory)> {
        let (_, at_value) = past.least_of(broken)?;
        let (_, at_here) = place.here.least_of(broken)?;
        let mut solved_at = |parameter: f64| {
            let scene = (self.family)(parameter).ok()?;
            let solved = self.near(place, &scene, parameter)?;
            Some((scene, solved))
        };
        if at_here <= 0.0 {
            return solved_at(place.here.parameter);
        }
        let least = |parameter: f64| Some(solved_at(parameter)?.1.least_of(broken)?.1);
        let root = find_root(least, (place.here.parameter, at_here), (value, at_value), 0.1 * PASSED * PASSED)?;
        solved_at(root)
    }

    /// Goes on past a change, by a path traced there: its critical point must come from the same state. Where another change
    /// comes in between, the path is traced closer to this one.
    fn go_on_past(
        &mut self,
        walk: &mut Walk,
        change: &SolvedHistory,
        accept: AcceptPoint<'_>,
        why: impl FnOnce() -> String,
    ) -> ControlFlow<Stopped> {
        let mut has_limits = false;
        let mut tried = change.parameter;
        for part in PAST_CHANGE {
            let value = stepped(change.parameter, walk.sense * part * self.range.step, walk.target(&self.range));
            let Ok(scene) = (self.family)(value) else { continue };
            let is_last = part == PAST_CHANGE[PAST_CHANGE.len() - 1];
            let found = self.critical_on_path(&walk.place, change, &scene, value, is_last);
            if self.cancel.is_cancelled() {
                return ControlFlow::Break(Stopped::Cancelled);
            }
            if let Some(place) = found.place {
                walk.place = place;
                let note = PointNote { event: None, codimension_two: false, from_path: true };
                return flow(self.emit(&scene, &walk.place, note, accept));
            }
            (has_limits, tried) = (found.has_limits, value);
        }
        let what = if has_limits { "has limit points, and none that comes from there" } else { "has no limit point" };
        let why = format!("{}; the path at {} {what}", why(), critical_point::in_words(tried));
        ControlFlow::Break(Stopped::Ended(DirectionEnd::Lost { value: change.parameter, why }))
    }

    /// The critical point that continues the curve, on a path at a value past a change. Unless `any`, no other change lies
    /// between them.
    fn critical_on_path(
        &mut self,
        place: &CurvePosition,
        change: &SolvedHistory,
        scene: &Scene,
        value: f64,
        any: bool,
    ) -> FoundOnPath {
        let stage = place.history.points.last().map_or(0, |point| point.stage);
        let expected = change.scales.express(change.critical(), stage, scene);
        self.paths += 1;
        let candidates = traced_history::near(scene, &expected, stage, self.longest_path, &self.cancel);
        if let Some(nearest) = candidates.first().and_then(|points| points.last()) {
            self.longest_path = self.longest_path.max(MOST_PATH_FACTOR * nearest.index);
        }
        let mut continues = |passed: &Vec<PassedPoint>| {
            let (history, guesses) = ContactHistory::of(scene, passed).ok()?;
            let here = SolvedHistory::of(&history, scene, value, &guesses, &mut self.work)?;
            let begin = CurvePosition { history, here, before: None };
            if !begin.here.broken().is_empty() {
                return None;
            }
            let (scene_at_change, back) = self.back_to(&begin, change.parameter, any)?;
            let at_change = back.scales.express(back.critical(), stage, &scene_at_change);
            let expected = change.scales.express(change.critical(), stage, &scene_at_change);
            let is_same = at_change.distance(&expected) <= SAME_POINT * (1.0 + size_of(&expected));
            is_same.then_some(CurvePosition { before: Some(back), ..begin })
        };
        let place = candidates.iter().take(MOST_CANDIDATES).find_map(&mut continues);
        FoundOnPath { place, has_limits: !candidates.is_empty() }
    }

    /// The critical point of a history at the change that it comes from, by a few steps, with the scene there; unless `any`,
    /// the conditions of its path hold on the way.
    fn back_to(&mut self, begin: &CurvePosition, value: f64, any: bool) -> Option<(Scene, SolvedHistory)> {
        let mut place = begin.clone();
        for part in [0.5, 0.75, 0.9375, 1.0] {
            // The last value is the given one without round-off.
            let parameter =
                if part < 1.0 { begin.here.parameter + part * (value - begin.here.parameter) } else { value };
            let scene = (self.family)(parameter).ok()?;
            let guesses = extrapolated(&place, &scene, parameter);
            let next = SolvedHistory::of(&place.history, &scene, parameter, &guesses, &mut self.work)?;
            if part == 1.0 {
                return Some((scene, next));
            }
            if !any && !next.broken().is_empty() {
                return None;
            }
            place.before = Some(std::mem::replace(&mut place.here, next));
        }
        None
    }

    /// Makes a point the last one of the curve.
    fn send(
        &mut self,
        scene: &Scene,
        place: &mut CurvePosition,
        solved: SolvedHistory,
        accept: AcceptPoint<'_>,
    ) -> ControlFlow<Stopped> {
        place.before = Some(std::mem::replace(&mut place.here, solved));
        flow(self.emit(scene, place, PointNote { event: None, codimension_two: false, from_path: false }, accept))
    }

    fn emit(
        &mut self,
        scene: &Scene,
        place: &CurvePosition,
        note: PointNote,
        accept: AcceptPoint<'_>,
    ) -> Result<(), Stopped> {
        self.pass(place, &note);
        let mut point = critical_point::point(scene, &place.history, &place.here, note, self.work);
        point.increment.index = self.points;
        point.place = self.place;
        self.points += 1;
        self.place += if self.sense < 0.0 { -1 } else { 1 };
        if accept(point).is_break() { Err(Stopped::Cancelled) } else { Ok(()) }
    }

    /// Keeps a point to compare it with a path at the end, the last ones of many.
    fn pass(&mut self, place: &CurvePosition, note: &PointNote) {
        let parameter = place.here.parameter;
        let close = CLEAR_OF_CHANGE * self.range.step;
        if note.codimension_two {
            let crowded = self.passed.iter_mut().rev().take_while(|one| (one.parameter - parameter).abs() < close);
            crowded.for_each(|one| one.is_clear = false);
        }
        let is_close = self.change.is_some_and(|change| (change - parameter).abs() < close);
        if note.codimension_two {
            self.change = Some(parameter);
        }
        if self.passed.len() == MOST_KEPT {
            self.passed.pop_front();
        }
        self.passed.push_back(PassedLimit {
            parameter,
            stage: place.history.points.last().map_or(0, |point| point.stage),
            state: place.here.critical().clone(),
            scales: place.here.scales.clone(),
            is_clear: !note.codimension_two && !is_close,
        });
    }

    /// The value after a step at most this long: where it can be, a whole number of longest steps from the first value.
    fn next_value(&self, from: f64, sense: f64, step: f64, target: f64) -> f64 {
        let CurveRange { start, step: longest, .. } = self.range;
        let count = sense * (from - start) / longest;
        let ahead = start + sense * (count + 1e-9).floor() * longest + sense * longest;
        let value = if (ahead - from).abs() <= step * (1.0 + 1e-9) { ahead } else { from + sense * step };
        if sense * (target - value) <= 1e-9 * longest { target } else { value }
    }

    fn shortest(&self) -> f64 {
        SHORTEST_STEP * (self.range.to - self.range.from)
    }
}

fn flow(sent: Result<(), Stopped>) -> ControlFlow<Stopped> {
    sent.map_or_else(ControlFlow::Break, ControlFlow::Continue)
}

/// The value after a step, at most the target; a remainder that is round-off is not left.
fn stepped(from: f64, step: f64, target: f64) -> f64 {
    if (target - from).abs() <= step.abs() * (1.0 + 1e-9) { target } else { from + step }
}

fn size_of(state: &State) -> f64 {
    state.displacement.iter().map(|value| value * value).sum::<f64>().sqrt().hypot(state.load)
}

/// Guesses at a value by the line through the last two points of the curve.
pub(super) fn extrapolated(place: &CurvePosition, scene: &Scene, value: f64) -> Vec<PointGuess> {
    let CurvePosition { history, here, before } = place;
    let ratio = before.as_ref().map_or(0.0, |before| {
        let width = here.parameter - before.parameter;
        if width == 0.0 { 0.0 } else { (value - here.parameter) / width }
    });
    let guess = |(index, point): (usize, &PointGuess)| {
        let stage = history.points[index].stage;
        let last = here.scales.express(&point.state, stage, scene);
        let state = match before {
            Some(before) => {
                let first = before.scales.express(&before.points[index].state, stage, scene);
                last.advanced(&first.chord(&last), ratio)
            }
            None => last.clone(),
        };
        PointGuess { state, from: last, ..point.clone() }
    };
    here.points.iter().enumerate().map(guess).collect()
}

/// Why a curve was not followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CurveFailure {
    /// Mistakes of the model at the first value.
    #[error("the model is refused: {0}")]
    Model(InputErrors),
    /// There is no critical point to follow.
    #[error(transparent)]
    Refused(#[from] CurveRefusal),
}
