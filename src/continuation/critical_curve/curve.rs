//! The curve of critical points, from one value of the parameter to the next.

use crate::algebra::scalar_root::find_root;
use crate::continuation::critical_curve::critical_point::{self, PointNote};
use crate::continuation::critical_curve::curve_outcome::{
    AcceptPoint, CurveBreak, CurveEnd, CurveFailure, CurveReport, DirectionEnd,
};
use crate::continuation::critical_curve::curve_position::{CurvePosition, SceneFamily, extrapolated};
use crate::continuation::critical_curve::cusp::Cusp;
use crate::continuation::critical_curve::history::solved_history::{PathCondition, SolvedHistory};
use crate::continuation::critical_curve::history::taken_directions::TakenDirections;
use crate::continuation::critical_curve::history::tolerances::{FOUND_ZERO, PASSED, UNFOLDED};
use crate::continuation::critical_curve::history::traced_history::{self, CurveRefusal, CurveStart};
use crate::continuation::critical_curve::last_points::LastPoints;
use crate::continuation::critical_curve::meeting_changes;
use crate::continuation::critical_curve::tolerances::{
    FIRST_DEVIATION, LARGEST_DEVIATION, MODEL_STEP, PAST_CHANGE, PREFERENCE_WIDTH, SAME_POINT, SHORTEST_CHORD,
    SHORTEST_STEP, STEP_GROWTH, STEP_ROUND_OFF, TURNING_REACH, TURNING_STEP, UNLOCATED_STEPS,
};
use crate::continuation::critical_curve::traced_paths::TracedPaths;
use crate::continuation::critical_curve::turning_point::{self, MeetingBifurcations, TurningPoint};
use crate::continuation::scene::Scene;
use crate::model::input::limits::MAX_CURVE_POINTS;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::PointKind;
use crate::step::corrector::cost_counters::Work;
use std::ops::ControlFlow;

/// Changes that are found in one step, each before the other, until one has no other before.
const MOST_CHANGES: usize = 6;
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
    /// The last points of the direction that is followed.
    last: LastPoints,
}

/// Why a direction, or the curve, goes no further.
enum Stopped {
    Cancelled,
    Ended(DirectionEnd),
}

/// Where a path comes to take another direction at a point of the history than it took before.
struct OtherDirection {
    scene: Scene,
    at: SolvedHistory,
    taken: TakenDirections,
    /// Place of the point in the history.
    point: usize,
}

/// The curve as it is followed in one direction.
struct Walk {
    place: CurvePosition,
    /// Sense of the parameter, 1 or -1.
    sense: f64,
    /// The next step of the parameter.
    step: f64,
    has_turned: bool,
    /// The directions that the path takes at the points of the history; `None` until they have been looked at.
    taken: Option<TakenDirections>,
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
        Self {
            family,
            range,
            cancel,
            work: Work::default(),
            points: 0,
            place: 0,
            sense: 1.0,
            last: LastPoints::none(range.step),
        }
    }

    /// Follows the curve from a critical point of the path to larger, then to smaller values.
    ///
    /// # Errors
    /// There is no such point, or it cannot be followed; mistakes of the model at the first value.
    pub fn follow(mut self, start: CurveStart, accept: AcceptPoint<'_>) -> Result<CurveReport, CurveFailure> {
        let scene = (self.family)(self.range.start).map_err(CurveFailure::Model)?;
        let first = traced_history::start(&scene, start, &self.cancel)?;
        let mut paths = TracedPaths::new(self.family, self.cancel.clone(), first.kind, first.index);
        let here = SolvedHistory::of(&first.history, &scene, self.range.start, &first.guesses, &mut self.work);
        let begin = CurvePosition { history: first.history, here: here.ok_or(CurveRefusal::NotSolved)?, before: None };
        let note = PointNote { event: None, codimension_two: false, from_path: true };
        let end = match self.emit(&scene, &begin, note, accept) {
            Ok(()) => self.both_ways(&begin, &mut paths, accept),
            Err(Stopped::Ended(end)) => CurveEnd::Complete { below: end.clone(), above: end },
            Err(Stopped::Cancelled) => CurveEnd::Cancelled,
        };
        let (points, newton_iterations) = (self.points, self.work.newton_iterations);
        Ok(CurveReport { end, points, paths: paths.count, newton_iterations })
    }

    /// Follows the curve from its start to larger, then to smaller values.
    fn both_ways(&mut self, begin: &CurvePosition, paths: &mut TracedPaths<'_>, accept: AcceptPoint<'_>) -> CurveEnd {
        let Some(above) = self.one_way(begin, 1.0, paths, accept) else { return CurveEnd::Cancelled };
        if above == DirectionEnd::Closed {
            // The other direction goes through the same points.
            return CurveEnd::Complete { below: DirectionEnd::Closed, above };
        }
        let Some(below) = self.one_way(begin, -1.0, paths, accept) else { return CurveEnd::Cancelled };
        CurveEnd::Complete { below, above }
    }

    /// Follows the curve from its start in one sense of the parameter; `None` where it was cancelled.
    fn one_way(
        &mut self,
        begin: &CurvePosition,
        sense: f64,
        paths: &mut TracedPaths<'_>,
        accept: AcceptPoint<'_>,
    ) -> Option<DirectionEnd> {
        (self.sense, self.place) = (sense, if sense < 0.0 { -1 } else { 1 });
        self.last = LastPoints::none(self.range.step);
        let Stopped::Ended(end) = self.towards(begin.clone(), sense, paths, accept) else { return None };
        let end = self.last.compared(end, paths);
        // A path that was cancelled says nothing.
        (!self.cancel.is_cancelled()).then_some(end)
    }

    /// Follows the curve in one sense of the parameter, to an end of the range.
    fn towards(
        &mut self,
        begin: CurvePosition,
        sense: f64,
        paths: &mut TracedPaths<'_>,
        accept: AcceptPoint<'_>,
    ) -> Stopped {
        let first = begin.here.critical().clone();
        let mut walk = Walk { place: begin, sense, step: self.range.step, has_turned: false, taken: None };
        loop {
            if walk.place.here.parameter == walk.target(&self.range) {
                return Stopped::Ended(DirectionEnd::Range);
            }
            if let ControlFlow::Break(stopped) = self.step(&mut walk, paths, accept) {
                return stopped;
            }
            let is_start = walk.has_turned && walk.place.here.parameter == self.range.start;
            if is_start && walk.place.here.critical().distance(&first) <= SAME_POINT * (1.0 + first.size()) {
                return Stopped::Ended(DirectionEnd::Closed);
            }
            if self.points >= MOST_POINTS {
                return Stopped::Ended(DirectionEnd::Long { value: walk.place.here.parameter });
            }
        }
    }

    /// One step of the parameter; a shorter one is tried next where it fails.
    fn step(&mut self, walk: &mut Walk, paths: &mut TracedPaths<'_>, accept: AcceptPoint<'_>) -> ControlFlow<Stopped> {
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
            return self.go_on_past(walk, (&from, 0.0), paths, accept, || "friction begins there".to_owned());
        }
        let Some(solved) = self.near(&walk.place, &scene, value) else {
            if walk.step <= TURNING_STEP * self.range.step
                && let Some(turn) = turning_point::turn(self.family, &walk.place, walk.sense, &mut self.work)
                && (self.range.from..=self.range.to).contains(&turn.at.1.parameter)
                && (turn.at.1.parameter - here).abs() <= TURNING_REACH * walk.step
            {
                return self.at_turning_point(walk, turn, paths, accept);
            }
            if let Some(cusp) = self.cusp_ahead(walk) {
                return self.pass_cusp(walk, cusp, paths, accept);
            }
            if let Some(meeting) = self.meeting_ahead(walk) {
                return self.turn_back_at_meeting(walk, meeting, accept);
            }
            if !is_shortest {
                return walk.shorten();
            }
            let from = walk.place.here.clone();
            let meeting = meeting_changes::ahead(&walk.place, (walk.sense, UNLOCATED_STEPS * self.shortest()));
            let lost = || match &meeting {
                Some(meeting) => critical_point::describe_meeting(&scene, meeting),
                None => "steps became too short, and no solution of its equations was found near by".to_owned(),
            };
            let slack = self.slack(&walk.place);
            return self.go_on_past(walk, (&from, slack), paths, accept, lost);
        };
        if solved.unfolding > UNFOLDED {
            let why =
                "the bifurcation point is one of this value alone: past it the branches no longer meet".to_owned();
            return ControlFlow::Break(Stopped::Ended(DirectionEnd::Lost { value: here, why }));
        }
        let broken = solved.ended_since(&walk.place.here);
        if broken.is_empty() {
            if let Some(other) = self.other_direction(walk, &solved, &scene) {
                return self.go_on_beside(walk, other, paths, accept);
            }
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
        self.go_on_past(walk, (&change, 0.0), paths, accept, || what)
    }

    /// Where the path comes to take another direction at a point of the history, between the last point of the curve and a
    /// solved one; the directions at the solved one are kept where it does not.
    fn other_direction(&mut self, walk: &mut Walk, solved: &SolvedHistory, scene: &Scene) -> Option<OtherDirection> {
        let CurvePosition { history, here, .. } = &walk.place;
        let at = |scene: &Scene, solved: &SolvedHistory| TakenDirections::of(history, scene, solved, &self.cancel);
        let before = match walk.taken.take() {
            Some(taken) => taken,
            None => at(&(self.family)(here.parameter).ok()?, here),
        };
        let after = at(scene, solved);
        if before.first_difference(&after).is_none() || self.cancel.is_cancelled() {
            walk.taken = Some(after);
            return None;
        }
        let (mut low, mut high) = (here.parameter, solved.parameter);
        let mut found = (scene.clone(), solved.clone(), after);
        while (high - low).abs() > PREFERENCE_WIDTH * (self.range.to - self.range.from) && !self.cancel.is_cancelled() {
            let middle = low.midpoint(high);
            let Ok(scene) = (self.family)(middle) else { break };
            let guesses = extrapolated(&walk.place, &scene, middle);
            let Some(solved) = SolvedHistory::of(history, &scene, middle, &guesses, &mut self.work) else { break };
            let taken = at(&scene, &solved);
            if before.first_difference(&taken).is_none() {
                low = middle;
            } else {
                (high, found) = (middle, (scene, solved, taken));
            }
        }
        // A search that was cut short says nothing of the directions.
        if self.cancel.is_cancelled() {
            return None;
        }
        let (scene, at, taken) = found;
        let point = before.first_difference(&taken)?;
        Some(OtherDirection { scene, at, taken, point })
    }

    /// Tells where the path takes another direction from here on. Where that is at the critical point the curve goes on;
    /// where it is before, the path comes to the critical point no more, unless one that is traced past the change does.
    fn go_on_beside(
        &mut self,
        walk: &mut Walk,
        OtherDirection { scene, at, taken, point }: OtherDirection,
        paths: &mut TracedPaths<'_>,
        accept: AcceptPoint<'_>,
    ) -> ControlFlow<Stopped> {
        let what = critical_point::describe_direction(&walk.place.history, point, taken.is_taken_at(point));
        let at_change = CurvePosition { here: at.clone(), history: walk.place.history.clone(), before: None };
        let note = PointNote { event: Some(what.clone()), codimension_two: true, from_path: false };
        if point + 1 < walk.place.history.points.len() && !taken.is_taken_at(point) {
            // Where a change of contact is about to vanish, the direction before it is in doubt a little earlier.
            let slack = self.slack(&walk.place);
            let past = self.go_on_past(walk, (&at, slack), paths, accept, || what);
            if let ControlFlow::Break(Stopped::Ended(_)) = past {
                flow(self.emit(&scene, &at_change, note, accept))?;
            }
            return past;
        }
        flow(self.emit(&scene, &at_change, note, accept))?;
        (walk.place.before, walk.taken) = (Some(std::mem::replace(&mut walk.place.here, at)), Some(taken));
        ControlFlow::Continue(())
    }

    /// Goes round a turning point of limit points; a change of contact whose event function touches zero ends there.
    fn at_turning_point(
        &mut self,
        walk: &mut Walk,
        turn: TurningPoint,
        paths: &mut TracedPaths<'_>,
        accept: AcceptPoint<'_>,
    ) -> ControlFlow<Stopped> {
        if walk.place.history.kind == PointKind::SmoothLimit {
            return self.turn_back(walk, turn, accept);
        }
        let (scene, at) = turn.at;
        let what = critical_point::describe_grazing(&scene, &walk.place.history);
        let grazing = CurvePosition { here: at.clone(), history: walk.place.history.clone(), before: None };
        let note = PointNote { event: Some(what.clone()), codimension_two: true, from_path: false };
        flow(self.emit(&scene, &grazing, note, accept))?;
        self.go_on_past(walk, (&at, 0.0), paths, accept, || what)
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

    /// The bifurcation point that the curve passes through in the step that failed, if there is one.
    fn cusp_ahead(&mut self, walk: &Walk) -> Option<Cusp> {
        if walk.step > TURNING_STEP * self.range.step {
            return None;
        }
        let left = (walk.target(&self.range) - walk.place.here.parameter).abs();
        Cusp::ahead(self.family, &walk.place, (walk.sense, left.min(2.0 * walk.step)), &mut self.work)
    }

    /// Tells of the bifurcation point, and goes on along the limit points past it.
    fn pass_cusp(
        &mut self,
        walk: &mut Walk,
        cusp: Cusp,
        paths: &mut TracedPaths<'_>,
        accept: AcceptPoint<'_>,
    ) -> ControlFlow<Stopped> {
        let event = "the limit point comes to a bifurcation point; its load has a cusp over the parameter";
        let note = PointNote { event: Some(event.to_owned()), codimension_two: true, from_path: false };
        flow(self.emit(&cusp.scene, &cusp.at, note, accept))?;
        let (at, target) = (cusp.at.here.parameter, walk.target(&self.range));
        if at == target {
            return ControlFlow::Break(Stopped::Ended(DirectionEnd::Range));
        }
        for part in PAST_CHANGE {
            let value = stepped(at, walk.sense * part * self.range.step, target);
            let Ok(scene) = (self.family)(value) else { continue };
            let found = paths.past_cusp(&cusp, (&scene, value), &mut self.work);
            if self.cancel.is_cancelled() {
                return ControlFlow::Break(Stopped::Cancelled);
            }
            if let Some(position) = found {
                (walk.place, walk.step, walk.taken) = (position, self.range.step, None);
                let note = PointNote { event: None, codimension_two: false, from_path: true };
                return flow(self.emit(&scene, &walk.place, note, accept));
            }
        }
        let why = format!("{event}, and the paths past it have no limit point that comes from there");
        ControlFlow::Break(Stopped::Ended(DirectionEnd::Lost { value: at, why }))
    }

    /// The bifurcation point that the last one of the curve meets in the step that failed, if there is one.
    fn meeting_ahead(&mut self, walk: &Walk) -> Option<MeetingBifurcations> {
        let is_close = walk.step <= TURNING_STEP * self.range.step;
        let ahead = (walk.sense, 2.0 * walk.step);
        is_close.then(|| turning_point::meeting(self.family, &walk.place, ahead, &mut self.work))?
    }

    /// Goes on along the other one of two bifurcation points that meet.
    fn turn_back_at_meeting(
        &mut self,
        walk: &mut Walk,
        MeetingBifurcations { value, other: (scene, other) }: MeetingBifurcations,
        accept: AcceptPoint<'_>,
    ) -> ControlFlow<Stopped> {
        let at = critical_point::in_words(value);
        if !other.broken().is_empty() {
            let why = format!("two bifurcation points meet at {at}, and a condition of the path ends there");
            return ControlFlow::Break(Stopped::Ended(DirectionEnd::Lost { value: walk.place.here.parameter, why }));
        }
        walk.step = (value - other.parameter).abs().max(self.shortest());
        (walk.sense, walk.has_turned, walk.taken) = (-walk.sense, true, None);
        (walk.place.here, walk.place.before) = (other, None);
        let event = format!("two bifurcation points meet at {at} and vanish; the curve turns back along the other one");
        flow(self.emit(
            &scene,
            &walk.place,
            PointNote { event: Some(event), codimension_two: true, from_path: false },
            accept,
        ))
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
        let most = if place.before.is_some() { LARGEST_DEVIATION * chord } else { FIRST_DEVIATION * (1.0 + chord) };
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
        if at_value >= -PASSED {
            return solved_at(value);
        }
        let least = |parameter: f64| Some(solved_at(parameter)?.1.least_of(broken)?.1);
        let root = find_root(least, (place.here.parameter, at_here), (value, at_value), 0.1 * PASSED * PASSED)?;
        solved_at(root)
    }

    /// Goes on past a change, by a path traced there: its critical point must come from the same state, but for `slack`. Where
    /// another change comes in between, the path is traced closer to this one.
    fn go_on_past(
        &mut self,
        walk: &mut Walk,
        (change, slack): (&SolvedHistory, f64),
        paths: &mut TracedPaths<'_>,
        accept: AcceptPoint<'_>,
        why: impl FnOnce() -> String,
    ) -> ControlFlow<Stopped> {
        let mut has_any = false;
        let mut tried = change.parameter;
        for part in PAST_CHANGE {
            let value = stepped(change.parameter, walk.sense * part * self.range.step, walk.target(&self.range));
            let Ok(scene) = (self.family)(value) else { continue };
            let is_last = part == PAST_CHANGE[PAST_CHANGE.len() - 1];
            let found = paths.past_change(&walk.place, (change, slack), (&scene, value), is_last, &mut self.work);
            if self.cancel.is_cancelled() {
                return ControlFlow::Break(Stopped::Cancelled);
            }
            if let Some(position) = found.position {
                if slack > 0.0 && position.history.kind != walk.place.history.kind {
                    self.tell_change_of_kind(walk, change, &position, accept)?;
                }
                (walk.place, walk.step, walk.taken) = (position, self.range.step, None);
                let note = PointNote { event: None, codimension_two: false, from_path: true };
                return flow(self.emit(&scene, &walk.place, note, accept));
            }
            (has_any, tried) = (found.has_any, value);
        }
        let kind = critical_point::plural_name(paths.kind);
        let what =
            if has_any { format!("has {kind}, and none that comes from there") } else { format!("has no {kind}") };
        let why = format!("{}; the path at {} {what}", why(), critical_point::in_words(tried));
        ControlFlow::Break(Stopped::Ended(DirectionEnd::Lost { value: change.parameter, why }))
    }

    /// How far the critical point moves, by its last two points, over the steps within which a change is not located.
    fn slack(&self, place: &CurvePosition) -> f64 {
        let Some(before) = &place.before else { return SAME_POINT };
        let chord = before.critical().distance(place.here.critical());
        SAME_POINT + UNLOCATED_STEPS * self.shortest() * chord / (place.here.parameter - before.parameter).abs()
    }

    /// A row at the last point before a change that is not an event of its own: a change of contact before the critical point
    /// vanishes or arises, and with it the kind of the point.
    fn tell_change_of_kind(
        &mut self,
        walk: &Walk,
        change: &SolvedHistory,
        past: &CurvePosition,
        accept: AcceptPoint<'_>,
    ) -> ControlFlow<Stopped> {
        let Ok(scene) = (self.family)(change.parameter) else { return ControlFlow::Continue(()) };
        let [before, after] =
            [&walk.place.history, &past.history].map(|history| critical_point::kind_name(history.kind));
        let event =
            format!("the changes of contact on the way are others from here on: the {before} becomes a {after}");
        let at_change = CurvePosition { here: change.clone(), history: walk.place.history.clone(), before: None };
        let note = PointNote { event: Some(event), codimension_two: true, from_path: false };
        flow(self.emit(&scene, &at_change, note, accept))
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
        let changes = note.codimension_two;
        let mut point = critical_point::point(scene, &place.history, &place.here, note, self.work);
        point.increment.index = self.points;
        point.place = self.place;
        match accept(point) {
            ControlFlow::Continue(()) => {}
            ControlFlow::Break(CurveBreak::Curve) => return Err(Stopped::Cancelled),
            ControlFlow::Break(CurveBreak::Direction(why)) => {
                let value = self.last.value().unwrap_or(self.range.start);
                return Err(Stopped::Ended(DirectionEnd::Lost { value, why }));
            }
        }
        self.last.keep(place, self.place, changes);
        self.points += 1;
        self.place += if self.sense < 0.0 { -1 } else { 1 };
        Ok(())
    }

    /// The value after a step at most this long: where it can be, a whole number of longest steps from the first value.
    fn next_value(&self, from: f64, sense: f64, step: f64, target: f64) -> f64 {
        let CurveRange { start, step: longest, .. } = self.range;
        let count = sense * (from - start) / longest;
        let ahead = start + sense * (count + STEP_ROUND_OFF).floor() * longest + sense * longest;
        let value = if (ahead - from).abs() <= step * (1.0 + STEP_ROUND_OFF) { ahead } else { from + sense * step };
        if sense * (target - value) <= STEP_ROUND_OFF * longest { target } else { value }
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
    if (target - from).abs() <= step.abs() * (1.0 + STEP_ROUND_OFF) { target } else { from + step }
}
