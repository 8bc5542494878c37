//! The path as an iterator of increments.
//!
//! Between events the path keeps its contact mode and is followed by arc-length steps; where the mode ends, the
//! directions are listed and one is taken. The step follows the turn of the path and the work of Newton's method.

use super::arrival::{Came, ROUND_OFF};
use super::at_hand::AtHand;
use super::by_program::ProgramIterate;
use super::carried::Carried;
use super::contact_law;
use super::corner::{is_in_plane, taken_apart, total_force};
use super::decide::{Choice, Decision, Rules};
use super::follow::{Arriving, Listed};
use super::increment::{Increment, Point, PointKind};
use super::interpolation::Placed;
use super::loading::Loading;
use super::near::{self, FarContacts, Near};
use super::newton::NO_FORCE;
use super::pocket::taken_over;
use super::progress::{Phase, Progress};
use super::rates::Effort;
use super::record::{self, Row};
use super::report::Report;
use super::scene::Scene;
use super::standing::{Standing, standings};
use super::state::State;
use super::stepping::Accepted;
use super::stop::{Outcome, StopReason};
use super::watch::Watch;
use crate::budget::{self, Breach, Budget};
use crate::cancel::CancelFlag;
use crate::contact::{Mode, Reaction, all_continue};
use std::borrow::Cow;
use std::time::Instant;

/// A path being traced.
pub struct Path<'a> {
    pub(super) scene: &'a Scene,
    pub(super) cancel: CancelFlag,
    budget: Budget,
    began: Instant,
    /// Solver time before this process took the path up.
    pub(super) elapsed_before: f64,
    /// Strain energy of the undeformed structure (prestress).
    pub(super) initial_strain: f64,
    pub(super) at: Progress,
    pub(super) near: Near,
    pub(super) far: FarContacts,
    /// For the next step.
    pub(super) at_hand: AtHand,
    /// Of the programs of the last increment, where they are kept.
    pub(super) iterates: Option<Vec<ProgramIterate>>,
}

impl<'a> Path<'a> {
    pub fn new(scene: &'a Scene, cancel: CancelFlag) -> Self {
        Self::at(scene, Progress::new(scene), 0.0, cancel)
    }

    /// At a point that fits the scene; `elapsed_before`: solver time that led there.
    pub(super) fn at(scene: &'a Scene, mut at: Progress, elapsed_before: f64, cancel: CancelFlag) -> Self {
        let undeformed = vec![0.0; scene.structure.freedoms()];
        let initial_strain = scene.structure.strain_energy(&undeformed);
        at.hold(scene);
        let near = Near::of(scene, &at);
        let far = near::far_contacts(scene, &at);
        Self {
            scene,
            budget: Budget::under_way(cancel.clone()),
            cancel,
            began: Instant::now(),
            elapsed_before,
            initial_strain,
            at,
            near,
            far,
            at_hand: AtHand::default(),
            iterates: None,
        }
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        (self.at.phase == Phase::Ended).then(|| self.at.totals.report.clone())
    }

    /// Makes the next step no longer than this (arc length, dimensionless), so that a point can be put where it is wanted.
    /// `analysis.arc_length.min` stays the shortest.
    pub fn shorten_next(&mut self, longest: f64) {
        let least = self.scene.analysis.arc_length.min;
        self.at.step = self.at.step.min(longest.max(least));
    }

    pub(super) fn elapsed_s(&self) -> f64 {
        self.elapsed_before + self.began.elapsed().as_secs_f64()
    }

    pub(super) fn loading(&self) -> Loading<'_> {
        self.near.loading(self.scene)
    }

    pub(super) fn rules(&self) -> Rules<'_> {
        let analysis = &self.scene.analysis;
        let loads = || self.scene.stages[self.at.stage].pattern.forces.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let so_far = self.at.totals.force_scale;
        let force_scale = if so_far > NO_FORCE { so_far } else { loads().max(NO_FORCE) };
        let effort = Effort { most_modes: analysis.max_modes, certify: !analysis.keep_all, cancel: &self.cancel };
        Rules { selection: analysis.selection, effort, force_scale }
    }

    pub(super) fn end(&mut self, reason: StopReason) {
        // A cancelled enumeration leaves its point without a direction.
        let broken_off = self.cancel.is_cancelled() && reason.outcome() == Outcome::Stopped;
        let reason = if broken_off { StopReason::Cancelled } else { reason };
        self.at.phase = Phase::Ended;
        self.at.totals.end(reason, self.elapsed_s());
    }

    /// Ends the path within an increment, which is lost.
    fn break_off(&mut self, breach: Breach, index: u64) {
        self.at.phase = Phase::Ended;
        self.at.totals.index = index;
        let elapsed_s = self.elapsed_s();
        self.at.totals.break_off(breach, elapsed_s);
        // What was left over for the next step holds memory.
        self.at_hand = AtHand::default();
    }

    pub(super) fn standings(&self, state: &State) -> Vec<Standing> {
        let scale = self.rules().force_scale;
        standings(self.loading(), state, scale)
    }

    pub(super) fn take(&mut self, decision: &mut Decision) {
        if let Some(index) = decision.taken {
            self.go(&decision.options[index]);
            self.at_hand = std::mem::take(&mut decision.options[index].at_hand);
            self.at.here.is_factorised = self.at_hand.is_one();
        }
    }

    pub(super) fn go(&mut self, choice: &Choice) {
        self.at.here.modes.clone_from(&choice.modes);
        (self.at.here.signature, self.at.here.is_factorised) = (None, false);
        (self.at.here.before, self.at.here.is_singular) = (None, choice.is_singular);
        self.at.here.beside.clone_from(&choice.beside);
        self.at.here.load_sign = choice.load_sign;
        self.at.here.rate = Some(choice.rate.clone());
        // A node that leaves a corner along one of its obstacles, or slides along an edge, takes the whole force there.
        let (loading, state) = (self.loading(), &self.at.here.state);
        let mut moved: Vec<(usize, Reaction)> = Vec::new();
        for corner in loading.corners {
            if !is_in_plane(loading, corner) {
                moved.extend(taken_over(loading, corner, &choice.modes, state));
                continue;
            }
            let closed = corner.closed(loading, state);
            if let Some(carried) = Carried::of(loading, &closed, state) {
                let force = total_force(loading, closed.iter().copied(), state);
                moved.extend(closed.into_iter().zip(carried.reactions(loading, &choice.modes, &force, state)));
                continue;
            }
            let mut active = corner.contacts.iter().copied().filter(|contact| choice.modes[*contact].is_active());
            if let (Some(only), None) = (active.next(), active.next()) {
                let force = total_force(loading, corner.contacts.iter().copied(), state);
                let frame = loading.frame(only, state);
                moved.push((only, taken_apart(&force, &frame, loading.contacts[only].friction)));
            }
        }
        for (contact, reaction) in moved {
            self.at.here.state.reactions[contact] = reaction;
        }
        for (reaction, mode) in self.at.here.state.reactions.iter_mut().zip(&choice.modes) {
            if *mode == Mode::Free {
                *reaction = Reaction::default();
            }
        }
    }

    /// Makes a reached point the present one and says what it is; none where the way on would break the laws of contact.
    fn accept(&mut self, accepted: Accepted) -> Option<Increment> {
        let reached = accepted.reached;
        self.at.totals.add(&accepted.added);
        self.at.counts.increments += 1;
        let here = &mut self.at.here;
        let before = std::mem::replace(&mut here.state, reached.corrected.state);
        let begun = here.rate.take().filter(|_| accepted.joined == 0);
        let changes = reached.event.is_some_and(Watch::is_of_contact);
        here.apart = (changes && here.before.is_none()).then_some(reached.step);
        (here.before, here.is_factorised) = (None, false);
        let mut modes = std::mem::replace(&mut here.modes, reached.corrected.modes);
        here.drift = reached.drift;
        // Past its bend the path is like any other, and what is foreseen of it does not go back beyond.
        let bends = here.beside.take().is_some();
        here.is_singular &= !bends;
        let begun = begun.filter(|_| !bends);
        here.signature = accepted.signature;
        let arriving = Arriving { modes: here.modes.clone(), load_sign: here.load_sign, counts: self.at.counts };
        let at_bound = self.at_bound(&reached.rate);
        let (step, joins) = (reached.step, accepted.joined > 0);
        let arrived = changes.then(|| self.at.here.state.reactions.clone());
        let mut arrival = if accepted.joined > 0 {
            self.at.here.is_singular = false;
            let arrival = self.joined_changes(&modes, accepted.joined, reached.rate);
            modes.clone_from(&self.at.here.modes);
            arrival
        } else {
            let came = Came {
                rate: reached.rate,
                step: reached.step,
                stopped: reached.stopped,
                nearby: reached.nearby,
                motions: reached.motions,
            };
            self.classify(reached.event, accepted.crossing, came)
        };
        if accepted.returned {
            arrival.stop = Some(StopReason::Cycle);
        }
        let changed = joins || !all_continue(&self.at.here.modes, &modes);
        arrival.stop = arrival.stop.or(self.reason_of_creep(step, changed || at_bound || arrival.stage_ends));
        // A change may have moved reactions.
        if changes && !contact_law::holds(self.loading(), &self.at.here.state, self.at.totals.force_scale) {
            self.at.totals.index -= 1;
            self.end(StopReason::ContactViolated);
            return None;
        }
        let stage = &self.scene.stages[self.at.stage];
        let stage_ends = arrival.stage_ends || at_bound || self.at.counts.end_stage(&stage.ends);
        let mut point = arrival.point;
        if let Some(reason) = arrival.stop {
            point.kind = PointKind::End;
            self.end(reason);
        } else if stage_ends {
            if point.kind == PointKind::Regular {
                point.kind = PointKind::End;
            }
            let what = format!("stage \"{}\" ends", stage.name);
            point.event = Some(point.event.map_or(what.clone(), |event| format!("{event}; {what}")));
        }
        // Where contacts of a node share its force in another way as the path goes on, they do not yet where it arrives.
        let round_off = ROUND_OFF * self.at.totals.force_scale;
        let is_anew = |arrived: &Vec<Reaction>| {
            let now = self.at.here.state.reactions.iter();
            now.zip(arrived).any(|(now, arrived)| now.difference(arrived) > round_off)
        };
        let row = self.emit(Emitted {
            before: &before,
            reactions: arrived.filter(is_anew),
            modes: &modes,
            step: reached.step,
            point,
            options: arrival.options,
            taken: arrival.taken,
            residual: reached.corrected.residual,
            error_estimate: reached.error_estimate,
            mode_named: accepted.mode_named.map(|named| named && !arrival.unconfirmed),
            arriving: Some(arriving),
        });
        if !changes && let Some(rate) = begun {
            self.at.here.before = Placed::before(before, rate, &self.at.here.state);
        }
        self.at.stage_over = stage_ends && self.at.phase == Phase::Running;
        Some(row)
    }

    pub(super) fn emit(&mut self, mut emitted: Emitted<'_>) -> Increment {
        // Nobody goes on from here along the others.
        emitted.options.iter_mut().for_each(|option| option.at_hand = AtHand::default());
        let mut state = Cow::Borrowed(&self.at.here.state);
        if let Some(reactions) = emitted.reactions {
            state.to_mut().reactions = reactions;
        }
        let row = Row {
            stage: self.at.stage,
            loading: self.loading(),
            whole: self.whole_loading(),
            places: self.near.places(),
            rows: self.near.rows(),
            state: &state,
            before: emitted.before,
            modes: emitted.modes,
            step: emitted.step,
            point: &emitted.point,
            options: &emitted.options,
            taken: emitted.taken,
            residual: emitted.residual,
            error_estimate: emitted.error_estimate,
            elapsed_s: self.elapsed_s(),
            mode_named: emitted.mode_named,
        };
        let row = record::increment(self.scene, &self.at.totals, &row);
        self.at.totals.note(&row);
        self.at.listed = row.directions.is_some().then_some(Listed {
            options: emitted.options,
            taken: emitted.taken,
            arriving: emitted.arriving,
            point: emitted.point,
            residual: emitted.residual,
            error_estimate: emitted.error_estimate,
        });
        row
    }
}

/// What [`Path::emit`] cannot see in the path itself.
pub(super) struct Emitted<'a> {
    pub before: &'a State,
    /// Reactions at the end of the increment, where they are others than those with which the path goes on.
    pub reactions: Option<Vec<Reaction>>,
    pub modes: &'a [Mode],
    pub step: f64,
    pub point: Point,
    pub options: Vec<Choice>,
    pub taken: Option<usize>,
    pub residual: f64,
    pub error_estimate: f64,
    pub mode_named: Option<bool>,
    /// `None` at a start.
    pub arriving: Option<Arriving>,
}

impl Iterator for Path<'_> {
    type Item = Increment;

    fn next(&mut self) -> Option<Increment> {
        let (budget, index) = (self.budget.clone(), self.at.totals.index);
        budget.during(|| self.increment()).unwrap_or_else(|breach| {
            self.break_off(breach, index);
            None
        })
    }
}

impl Path<'_> {
    /// The next increment; `None` where the path has ended.
    fn increment(&mut self) -> Option<Increment> {
        match self.at.phase {
            Phase::Ended => return None,
            Phase::NotStarted => {
                budget::spend(0);
                return Some(match self.at.followed.take() {
                    Some(followed) => self.followed_row(followed),
                    None => self.begin_stage(),
                });
            }
            Phase::Running => {}
        }
        if std::mem::take(&mut self.at.stage_over) && !self.next_stage() {
            return None;
        }
        if self.cancel.is_cancelled() {
            self.end(StopReason::Cancelled);
            return None;
        }
        if self.at.totals.index >= self.scene.analysis.max_increments {
            self.end(StopReason::MaxIncrements);
            return None;
        }
        if self.at.here.rate.is_none() {
            return Some(self.begin_stage());
        }
        match self.step() {
            Ok(accepted) => self.accept(accepted),
            Err(reason) => {
                self.end(reason);
                None
            }
        }
    }
}
