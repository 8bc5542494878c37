//! The path as an iterator of increments.
//!
//! Between events the path keeps its contact mode and is followed by arc-length steps; where the mode ends, the
//! directions are listed and one is taken. The step follows the turn of the path and the work of Newton's method.

use super::advance::{AT_END, Work};
use super::contact_law;
use super::corner::{taken_apart, total_force};
use super::decide::{self, Before, Choice, Decision, Rules};
use super::follow::{Arriving, Followed, Listed};
use super::increment::{Energy, Increment, Point, PointKind};
use super::loading::{LoadPattern, Loading};
use super::name_event::describe_start;
use super::record::{self, Row};
use super::report::Report;
use super::scene::{End, Scene};
use super::singular::Signature;
use super::standing::{Standing, standings};
use super::state::{Rate, State};
use super::stepping::{Accepted, NO_ENERGY};
use super::stop::{Outcome, StopReason};
use super::watch::Watch;
use crate::cancel::CancelFlag;
use crate::contact::{Mode, Reaction};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Instant;

/// A path being traced.
pub struct Path<'a> {
    pub(super) scene: &'a Scene,
    pub(super) cancel: CancelFlag,
    pub(super) began: Instant,
    /// Solver time before this process took the path up.
    pub(super) elapsed_before: f64,
    pub(super) phase: Phase,
    pub(super) stage: usize,
    /// The stage ended at the present point; the next one begins with the next increment.
    pub(super) stage_over: bool,
    pub(super) held: LoadPattern,
    pub(super) here: Here,
    /// Arc length that the next step tries.
    pub(super) step: f64,
    pub(super) index: u64,
    pub(super) arc_length: f64,
    pub(super) energy: Energy,
    /// Strain energy of the undeformed structure (prestress).
    pub(super) initial_strain: f64,
    pub(super) largest_energy: f64,
    pub(super) force_scale: f64,
    pub(super) counts: StageCounts,
    pub(super) work: Work,
    pub(super) report: Report,
    /// States at which a direction was taken, for telling a cycle.
    pub(super) visited: Vec<Arc<Visited>>,
    /// Where the stage began and the direction it took.
    pub(super) begun: Option<(State, Rate)>,
    /// Directions listed with the present point.
    pub(super) listed: Option<Listed>,
    /// Where a path that follows another's direction begins.
    pub(super) followed: Option<Followed>,
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
    /// Signs that tell smooth bifurcations; `None` until known in these modes.
    pub signature: Option<Signature>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Visited {
    pub stage: usize,
    pub state: State,
    pub modes: Vec<Mode>,
}

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

impl<'a> Path<'a> {
    pub fn new(scene: &'a Scene, cancel: CancelFlag) -> Self {
        let state = State::at_rest(&scene.structure, scene.contacts.len());
        let step = scene.analysis.arc_length.initial;
        Self {
            cancel,
            began: Instant::now(),
            elapsed_before: 0.0,
            phase: Phase::NotStarted,
            stage: 0,
            stage_over: false,
            held: scene.stages[0].pattern.zeroed(),
            here: Here {
                state: state.clone(),
                modes: vec![Mode::Free; scene.contacts.len()],
                rate: None,
                load_sign: 0.0,
                drift: None,
                signature: None,
            },
            step,
            index: 0,
            arc_length: 0.0,
            energy: Energy::default(),
            initial_strain: scene.structure.strain_energy(&state.displacement),
            largest_energy: 0.0,
            force_scale: 0.0,
            counts: StageCounts::default(),
            work: Work::default(),
            report: Report::begun(),
            visited: Vec::new(),
            begun: None,
            listed: None,
            followed: None,
            scene,
        }
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        matches!(self.phase, Phase::Ended).then(|| self.report.clone())
    }

    pub(super) fn elapsed_s(&self) -> f64 {
        self.elapsed_before + self.began.elapsed().as_secs_f64()
    }

    pub(super) fn loading(&self) -> Loading<'_> {
        Loading {
            structure: &self.scene.structure,
            contacts: &self.scene.contacts,
            corners: &self.scene.corners,
            pattern: &self.scene.stages[self.stage].pattern,
            held: &self.held,
        }
    }

    pub(super) fn rules(&self) -> Rules<'_> {
        let analysis = &self.scene.analysis;
        let loads = self.scene.stages[self.stage].pattern.forces.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let force_scale = if self.force_scale > 0.0 { self.force_scale } else { loads.max(f64::MIN_POSITIVE) };
        Rules { selection: analysis.selection, most_modes: analysis.max_modes, force_scale, cancel: &self.cancel }
    }

    fn end(&mut self, reason: StopReason) {
        // A cancelled enumeration leaves its point without a direction.
        let broken_off = self.cancel.is_cancelled() && reason.outcome() == Outcome::Stopped;
        let reason = if broken_off { StopReason::Cancelled } else { reason };
        self.phase = Phase::Ended;
        self.report.stop_reason = reason;
        self.report.sentence = reason.sentence().to_owned();
        self.report.elapsed_s = self.elapsed_s();
        self.report.factorisations = self.work.factorisations;
        self.report.newton_iterations = self.work.newton_iterations;
        self.report.qp_solves = self.work.qp_solves;
        self.report.mpec_solves = self.work.mpec_solves;
    }

    pub(super) fn standings(&self, state: &State) -> Vec<Standing> {
        let scale = self.rules().force_scale;
        standings(self.loading(), state, scale)
    }

    /// Decides how the stage begins and takes its first direction.
    fn begin_stage(&mut self) -> Decision {
        let standings = self.standings(&self.here.state);
        let decision = decide::decide(self.loading(), &self.here.state, &standings, Before::StageStart, self.rules());
        self.take(&decision);
        self.begun = self.here.rate.clone().map(|rate| (self.here.state.clone(), rate));
        self.step = self.step.min(self.scene.analysis.arc_length.initial);
        decision
    }

    pub(super) fn take(&mut self, decision: &Decision) {
        if let Some(index) = decision.taken {
            self.go(&decision.options[index]);
        }
    }

    pub(super) fn go(&mut self, choice: &Choice) {
        self.here.modes.clone_from(&choice.modes);
        self.here.signature = None;
        self.here.load_sign = choice.load_sign;
        self.here.rate = Some(choice.rate.clone());
        // A node that leaves a corner along one of its obstacles takes the whole force there.
        let (loading, state) = (self.loading(), &self.here.state);
        let mut moved: Vec<(usize, Reaction)> = Vec::new();
        for corner in loading.corners {
            let mut active = corner.contacts.iter().copied().filter(|contact| choice.modes[*contact].is_active());
            if let (Some(only), None) = (active.next(), active.next()) {
                let force = total_force(loading, corner.contacts.iter().copied(), state);
                let frame = loading.frame(only, state);
                moved.push((only, taken_apart(&force, &frame, loading.contacts[only].friction)));
            }
        }
        for (contact, reaction) in moved {
            self.here.state.reactions[contact] = reaction;
        }
        for (reaction, mode) in self.here.state.reactions.iter_mut().zip(&choice.modes) {
            if *mode == Mode::Free {
                *reaction = Reaction::default();
            }
        }
    }

    fn start_row(&mut self) -> Increment {
        let decision = self.begin_stage();
        let point = Point {
            kind: PointKind::Start,
            bifurcation: decide::is_bifurcation(&decision.options, decision.taken, None),
            event: Some(describe_start(self.scene)),
            better_direction: false,
            unexplored_modes: decision.unexplored,
            degenerate: decision.degenerate,
        };
        if let Some(reason) = decision.stop {
            self.end(reason);
        } else {
            self.phase = Phase::Running;
        }
        let state = self.here.state.clone();
        let modes = self.here.modes.clone();
        self.emit(Emitted {
            before: &state,
            modes: &modes,
            step: 0.0,
            point,
            options: decision.options,
            taken: decision.taken,
            residual: 0.0,
            error_estimate: 0.0,
            mode_named: None,
            arriving: None,
        })
    }

    /// Starts stages until one has a way to go; ends the path where none has.
    fn enter_stage(&mut self) -> bool {
        loop {
            if self.here.rate.is_some() {
                return true;
            }
            if self.here_ends_stage() {
                if !self.next_stage() {
                    return false;
                }
                continue;
            }
            let decision = self.begin_stage();
            if let Some(reason) = decision.stop {
                self.end(reason);
                return false;
            }
        }
    }

    /// Whether an end of the stage is met before it begins.
    fn here_ends_stage(&self) -> bool {
        let still = Rate {
            displacement: vec![0.0; self.here.state.displacement.len()],
            load: 0.0,
            reactions: self.here.state.reactions.clone(),
        };
        self.scene.stages[self.stage]
            .ends
            .iter()
            .any(|end| Watch::End(*end).value(self.loading(), &self.here.modes, &self.here.state, &still) <= 0.0)
    }

    /// Holds what the stage reached and goes to the next; `false` where there is none.
    fn next_stage(&mut self) -> bool {
        if self.stage + 1 == self.scene.stages.len() {
            self.end(StopReason::StagesCompleted);
            return false;
        }
        self.held.add(self.here.state.load, &self.scene.stages[self.stage].pattern);
        self.stage += 1;
        self.here.state.load = 0.0;
        self.here.rate = None;
        self.here.signature = None;
        self.counts = StageCounts::default();
        self.visited.clear();
        true
    }

    /// Makes a reached point the present one and says what it is; none where the way on would break the laws of contact.
    fn accept(&mut self, accepted: Accepted) -> Option<Increment> {
        let reached = accepted.reached;
        let before = self.here.state.clone();
        let modes = self.here.modes.clone();
        self.force_scale = self.force_scale.max(reached.corrected.force_scale);
        self.energy.external_work += accepted.work;
        self.energy.dissipated += accepted.dissipation;
        self.energy.strain = accepted.strain;
        self.arc_length += reached.step;
        self.index += 1;
        self.counts.increments += 1;
        self.here.state = reached.corrected.state;
        self.here.modes = reached.corrected.modes;
        self.here.drift = reached.drift;
        self.here.signature = accepted.signature;
        let arriving = Arriving { modes: self.here.modes.clone(), load_sign: self.here.load_sign, counts: self.counts };
        let at_bound = self.at_bound(&reached.rate);
        let mut arrival = self.classify(reached.event, accepted.crossing, &reached.rate);
        if accepted.returned {
            arrival.stop = Some(StopReason::Cycle);
        }
        if !contact_law::holds(self.loading(), &self.here.state, self.force_scale) {
            self.index -= 1;
            self.end(StopReason::ContactViolated);
            return None;
        }
        let stage_ends = arrival.stage_ends || at_bound || self.counts_end_stage(&self.counts);
        let mut point = arrival.point;
        if let Some(reason) = arrival.stop {
            point.kind = PointKind::End;
            self.end(reason);
        } else if stage_ends {
            if point.kind == PointKind::Regular {
                point.kind = PointKind::End;
            }
            let what = format!("stage \"{}\" ends", self.scene.stages[self.stage].name);
            point.event = Some(point.event.map_or(what.clone(), |event| format!("{event}; {what}")));
        }
        let row = self.emit(Emitted {
            before: &before,
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
        self.stage_over = stage_ends && self.phase == Phase::Running;
        Some(row)
    }

    /// Whether a load or displacement at which the stage ends is reached here, whatever else happens here; it is then
    /// made exact.
    fn at_bound(&mut self, rate: &Rate) -> bool {
        let ends = &self.scene.stages[self.stage].ends;
        let met = ends
            .iter()
            .find(|end| Watch::End(**end).value(self.loading(), &self.here.modes, &self.here.state, rate) <= AT_END);
        if let Some(End::Load { bound, .. }) = met {
            self.here.state.load = *bound;
        }
        met.is_some()
    }

    pub(super) fn counts_end_stage(&self, counts: &StageCounts) -> bool {
        self.scene.stages[self.stage].ends.iter().any(|end| match end {
            End::LimitPoints(count) => counts.limit_points >= *count,
            End::ContactChanges(count) => counts.contact_changes >= *count,
            End::Increments(count) => counts.increments >= *count,
            End::Load { .. } | End::Displacement { .. } => false,
        })
    }

    pub(super) fn emit(&mut self, emitted: Emitted<'_>) -> Increment {
        let energy = self.energy;
        for value in [energy.external_work, energy.strain, energy.dissipated] {
            self.largest_energy = self.largest_energy.max(value.abs());
        }
        let imbalance = (energy.external_work - energy.strain - energy.dissipated).abs();
        let size = self.largest_energy.max(NO_ENERGY * self.force_scale);
        let energy_error = if size > 0.0 { imbalance / size } else { 0.0 };
        let row = record::increment(
            self.scene,
            &Row {
                index: self.index,
                stage: self.stage,
                loading: self.loading(),
                state: &self.here.state,
                before: emitted.before,
                modes: emitted.modes,
                arc_length: self.arc_length,
                step: emitted.step,
                point: emitted.point.clone(),
                options: &emitted.options,
                taken: emitted.taken,
                list_directions: decide::is_worth_listing(&emitted.options),
                energy,
                residual: emitted.residual,
                error_estimate: emitted.error_estimate,
                energy_error,
                force_scale: self.force_scale,
                elapsed_s: self.elapsed_s(),
                work: self.work,
                mode_named: emitted.mode_named,
            },
        );
        self.listed = row.directions.is_some().then_some(Listed {
            options: emitted.options,
            taken: emitted.taken,
            arriving: emitted.arriving,
            point: emitted.point,
            residual: emitted.residual,
            error_estimate: emitted.error_estimate,
        });
        self.report.increments = self.index;
        self.report.largest_residual = self.report.largest_residual.max(row.diagnostics.residual);
        self.report.largest_complementarity = self.report.largest_complementarity.max(row.diagnostics.complementarity);
        self.report.largest_energy_error = self.report.largest_energy_error.max(energy_error);
        row
    }
}

/// What [`Path::emit`] cannot see in the path itself.
pub(super) struct Emitted<'a> {
    pub before: &'a State,
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
        match self.phase {
            Phase::Ended => return None,
            Phase::NotStarted => {
                let row = match self.followed.take() {
                    Some(followed) => self.followed_row(followed),
                    None => self.start_row(),
                };
                self.report.elapsed_s = self.elapsed_s();
                return Some(row);
            }
            Phase::Running => {}
        }
        if std::mem::take(&mut self.stage_over) && !self.next_stage() {
            return None;
        }
        if self.cancel.is_cancelled() {
            self.end(StopReason::Cancelled);
            return None;
        }
        if self.index >= self.scene.analysis.max_increments {
            self.end(StopReason::MaxIncrements);
            return None;
        }
        if !self.enter_stage() {
            return None;
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
