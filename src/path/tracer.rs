//! The path as an iterator of increments.
//!
//! Between events the path keeps its contact mode and is followed by arc-length steps; where the mode ends, the
//! directions are listed and one is taken. The step follows the turn of the path and the work of Newton's method.

use super::advance::{Reached, Refused, Start, Work};
use super::decide::{self, Before, Choice, Decision, Rules};
use super::energy;
use super::increment::{Energy, Increment, Point, PointKind};
use super::mode_system::Loading;
use super::name_event::{describe_change, describe_start};
use super::record::{self, Row};
use super::report::Report;
use super::scene::{End, Scene};
use super::standing::{Standing, standings};
use super::state::{Rate, State};
use super::stop::StopReason;
use super::watch::Watch;
use crate::cancel::CancelFlag;
use crate::contact::{Mode, Reaction};
use std::time::Instant;

/// The turn of the path (radians) that a step aims at.
const TURN_SOUGHT: f64 = 0.08;
/// Newton iterations that a step aims at.
const ITERATIONS_SOUGHT: f64 = 5.0;

/// Energy imbalance of an increment, over the largest energy so far, that a step aims at.
const IMBALANCE_SOUGHT: f64 = 5e-9;
/// A step after which the next would have to be shorter than this fraction of it is taken again, shorter.
const REJECTED: f64 = 0.55;

/// A path being traced.
pub struct Path<'a> {
    scene: &'a Scene,
    cancel: CancelFlag,
    began: Instant,
    phase: Phase,
    stage: usize,
    held: Vec<f64>,
    here: Here,
    /// Arc length that the next step tries.
    step: f64,
    index: u64,
    arc_length: f64,
    energy: Energy,
    /// Strain energy of the undeformed structure (prestress).
    initial_strain: f64,
    largest_energy: f64,
    force_scale: f64,
    counts: StageCounts,
    work: Work,
    report: Report,
    /// States at which a direction was taken, for telling a cycle.
    visited: Vec<Visited>,
}

/// The present point and how the path goes on.
struct Here {
    state: State,
    modes: Vec<Mode>,
    /// Direction in `modes`; `None` before the stage's first decision.
    rate: Option<Rate>,
    load_sign: f64,
}

struct Visited {
    stage: usize,
    state: State,
    modes: Vec<Mode>,
}

#[derive(Default)]
struct StageCounts {
    increments: u64,
    limit_points: u64,
    contact_changes: u64,
}

enum Phase {
    NotStarted,
    Running,
    Ended,
}

/// States closer than this are one.
const SAME_STATE: f64 = 1e-9;

impl<'a> Path<'a> {
    pub fn new(scene: &'a Scene, cancel: CancelFlag) -> Self {
        let state = State::at_rest(&scene.structure, scene.contacts.len());
        let step = scene.analysis.arc_length.initial;
        Self {
            cancel,
            began: Instant::now(),
            phase: Phase::NotStarted,
            stage: 0,
            held: vec![0.0; scene.structure.freedoms()],
            here: Here { state: state.clone(), modes: vec![Mode::Free; scene.contacts.len()], rate: None, load_sign: 0.0 },
            step,
            index: 0,
            arc_length: 0.0,
            energy: Energy::default(),
            initial_strain: scene.structure.strain_energy(&state.displacement),
            largest_energy: 0.0,
            force_scale: 0.0,
            counts: StageCounts::default(),
            work: Work::default(),
            report: Report {
                stop_reason: StopReason::Cancelled,
                sentence: String::new(),
                increments: 0,
                elapsed_s: 0.0,
                largest_residual: 0.0,
                largest_complementarity: 0.0,
                largest_energy_error: 0.0,
                factorisations: 0,
                newton_iterations: 0,
                qp_solves: 0,
                mpec_solves: 0,
            },
            visited: Vec::new(),
            scene,
        }
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        matches!(self.phase, Phase::Ended).then(|| self.report.clone())
    }

    fn loading(&self) -> Loading<'_> {
        Loading {
            structure: &self.scene.structure,
            contacts: &self.scene.contacts,
            pattern: &self.scene.stages[self.stage].pattern,
            held: &self.held,
        }
    }

    fn rules(&self) -> Rules {
        let analysis = &self.scene.analysis;
        let loads = self.scene.stages[self.stage].pattern.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let force_scale = if self.force_scale > 0.0 { self.force_scale } else { loads };
        Rules { selection: analysis.selection, most_modes: analysis.max_modes, force_scale }
    }

    fn end(&mut self, reason: StopReason) {
        self.phase = Phase::Ended;
        self.report.stop_reason = reason;
        self.report.sentence = reason.sentence().to_owned();
        self.report.elapsed_s = self.began.elapsed().as_secs_f64();
        self.report.factorisations = self.work.factorisations;
        self.report.newton_iterations = self.work.newton_iterations;
        self.report.qp_solves = self.work.qp_solves;
        self.report.mpec_solves = self.work.mpec_solves;
    }

    fn standings(&self, state: &State) -> Vec<Standing> {
        let scale = self.rules().force_scale;
        standings(&self.scene.structure, &self.scene.contacts, state, scale)
    }

    /// Decides how the stage begins and takes its first direction.
    fn begin_stage(&mut self) -> Decision {
        let standings = self.standings(&self.here.state);
        let decision =
            decide::decide(self.loading(), &self.here.state, &standings, Before::StageStart, self.rules());
        self.take(&decision);
        self.step = self.step.min(self.scene.analysis.arc_length.initial);
        decision
    }

    fn take(&mut self, decision: &Decision) {
        let Some(choice) = decision.taken.map(|index| &decision.options[index]) else { return };
        self.here.modes.clone_from(&choice.modes);
        self.here.load_sign = choice.load_sign;
        self.here.rate = Some(choice.rate.clone());
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
            options: &decision.options,
            taken: decision.taken,
            residual: 0.0,
            error_estimate: 0.0,
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
        self.scene.stages[self.stage].ends.iter().any(|end| {
            Watch::End(*end).value(self.loading(), &self.here.modes, &self.here.state, &still) <= 0.0
        })
    }

    /// Holds what the stage reached and goes to the next; `false` where there is none.
    fn next_stage(&mut self) -> bool {
        if self.stage + 1 == self.scene.stages.len() {
            self.end(StopReason::StagesCompleted);
            return false;
        }
        for (held, pattern) in self.held.iter_mut().zip(&self.scene.stages[self.stage].pattern) {
            *held += self.here.state.load * pattern;
        }
        self.stage += 1;
        self.here.state.load = 0.0;
        self.here.rate = None;
        self.counts = StageCounts::default();
        self.visited.clear();
        true
    }

    /// Steps until a point is accepted.
    fn step(&mut self) -> Result<Accepted, StopReason> {
        let (least, most) = (self.scene.analysis.arc_length.min, self.scene.analysis.arc_length.max);
        let mut step = self.step.min(most);
        let mut changes_here = 0;
        loop {
            if self.cancel.is_cancelled() {
                return Err(StopReason::Cancelled);
            }
            let Some(rate) = self.here.rate.clone() else { return Err(StopReason::NoDirection) };
            let start = Start {
                loading: self.loading(),
                state: &self.here.state,
                rate: &rate,
                modes: &self.here.modes,
                force_scale: self.force_scale,
            };
            let mut work = self.work;
            let ends = &self.scene.stages[self.stage].ends;
            let outcome = start.advance(step, ends, self.here.load_sign, &mut work);
            self.work = work;
            match outcome {
                Ok(reached) => {
                    let accepted = self.balance(&rate, reached);
                    let factor = self.next_step_factor(&rate, &accepted, step);
                    if factor > REJECTED || step * factor < least {
                        self.step = (step * factor).clamp(least, most);
                        return Ok(accepted);
                    }
                    step *= factor;
                }
                Err(Refused::AtStart(watch)) if watch.is_of_contact() && changes_here <= self.scene.contacts.len() => {
                    // Two changes at one point, the second too close to be a point of its own.
                    changes_here += 1;
                    let standings = self.standings(&self.here.state);
                    let before = Before::Incoming(&rate);
                    let rules = self.rules();
                    let decision = decide::decide(self.loading(), &self.here.state, &standings, before, rules);
                    if let Some(reason) = decision.stop {
                        return Err(reason);
                    }
                    self.take(&decision);
                }
                Err(refused) => {
                    step *= match refused {
                        Refused::Turned(angle) => (0.5 * TURN_SOUGHT / angle).clamp(0.1, 0.5),
                        Refused::Newton(_) => 0.5,
                        Refused::AtStart(_) => 0.25,
                    };
                    if step < least {
                        return Err(StopReason::StepUnderflow);
                    }
                }
            }
        }
    }

    /// Work, dissipation and strain energy of a point reached.
    fn balance(&self, rate: &Rate, reached: Reached) -> Accepted {
        let start = (&self.here.state, rate);
        let end = (&reached.corrected.state, &reached.rate);
        let (work, dissipation) = energy::work_and_dissipation(self.loading(), &self.here.modes, start, end);
        let strain = self.scene.structure.strain_energy(&reached.corrected.state.displacement) - self.initial_strain;
        Accepted { reached, work, dissipation, strain }
    }

    /// How the next step should compare with this one: by the path's turn, Newton's work and the energy balance.
    fn next_step_factor(&self, rate: &Rate, accepted: &Accepted, tried: f64) -> f64 {
        let reached = &accepted.reached;
        let done = (reached.step / tried).clamp(0.1, 1.0);
        let turn = rate.product(&reached.rate).clamp(-1.0, 1.0).acos() / done;
        let by_turn = TURN_SOUGHT / turn.max(1e-3 * TURN_SOUGHT);
        let by_work = ITERATIONS_SOUGHT / reached.corrected.iterations.max(1) as f64;
        let imbalance = (accepted.work - accepted.dissipation - (accepted.strain - self.energy.strain)).abs();
        let size = self.largest_energy.max(accepted.work.abs()).max(accepted.strain.abs()).max(f64::MIN_POSITIVE);
        // The balance of one increment has an error of fifth order in its arc length.
        let by_energy = (IMBALANCE_SOUGHT / (imbalance / size).max(1e-3 * IMBALANCE_SOUGHT)).powf(0.2);
        by_turn.min(by_work).min(by_energy).clamp(0.2, 1.8)
    }

    /// Makes a reached point the present one and says what it is.
    fn accept(&mut self, accepted: Accepted) -> Increment {
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
        let arrival = self.classify(reached.event, &reached.rate);
        let mut point = arrival.point;
        if let Some(reason) = arrival.stop {
            point.kind = PointKind::End;
            self.end(reason);
        } else if arrival.stage_ends || self.count_ends_stage() {
            if point.kind == PointKind::Regular {
                point.kind = PointKind::End;
            }
            let what = format!("stage \"{}\" ends", self.scene.stages[self.stage].name);
            point.event = Some(point.event.map_or(what.clone(), |event| format!("{event}; {what}")));
        }
        let stage_ends = arrival.stage_ends || self.count_ends_stage();
        let row = self.emit(Emitted {
            before: &before,
            modes: &modes,
            step: reached.step,
            point,
            options: &arrival.options,
            taken: arrival.taken,
            residual: reached.corrected.residual,
            error_estimate: reached.corrected.last_correction,
        });
        if matches!(self.phase, Phase::Running) && stage_ends {
            self.next_stage();
        }
        row
    }

    fn count_ends_stage(&self) -> bool {
        self.scene.stages[self.stage].ends.iter().any(|end| match end {
            End::LimitPoints(count) => self.counts.limit_points >= *count,
            End::ContactChanges(count) => self.counts.contact_changes >= *count,
            End::Increments(count) => self.counts.increments >= *count,
            End::Load { .. } | End::Displacement { .. } => false,
        })
    }

    /// What kind of point this is, and how the path goes on.
    fn classify(&mut self, event: Option<Watch>, incoming: &Rate) -> Arrival {
        match event {
            None | Some(Watch::End(_)) => {
                self.here.rate = Some(incoming.clone());
                let stage_ends = event.is_some();
                self.look_around(incoming, PointKind::Regular, None, None, stage_ends)
            }
            Some(Watch::LoadRate { sign }) => {
                self.here.rate = Some(incoming.clone());
                self.here.load_sign = -sign;
                self.counts.limit_points += 1;
                let what = if sign > 0.0 { "load maximum" } else { "load minimum" };
                self.look_around(incoming, PointKind::SmoothLimit, Some(what.to_owned()), Some(-sign), false)
            }
            Some(Watch::Gap(_) | Watch::Normal(_) | Watch::Cone { .. } | Watch::Sliding(_)) => {
                self.contact_change(incoming)
            }
        }
    }

    /// Directions at a point where the mode goes on.
    fn look_around(
        &self,
        incoming: &Rate,
        kind: PointKind,
        event: Option<String>,
        sign: Option<f64>,
        stage_ends: bool,
    ) -> Arrival {
        let standings = self.standings(&self.here.state);
        let mut point = Point {
            kind,
            bifurcation: false,
            event,
            better_direction: false,
            unexplored_modes: 0,
            degenerate: false,
        };
        let settled = standings.iter().all(|standing| matches!(standing, Standing::Settled(_)));
        if settled {
            return Arrival { point, options: Vec::new(), taken: None, stop: None, stage_ends };
        }
        let rules = self.rules();
        let before = Before::Incoming(incoming);
        let (options, found) = decide::list(self.loading(), &self.here.state, &standings, before, rules);
        let taken = options.iter().position(|option| option.rate.product(incoming) > 1.0 - 1e-9);
        point.bifurcation = decide::is_bifurcation(&options, taken, sign);
        point.unexplored_modes = found.unexplored;
        point.degenerate = found.degenerate || options.len() % 2 == 1 || taken.is_none();
        if let Some(taken) = taken {
            let kept = options[taken].dissipation;
            let tolerance = 1e-8 * rules.force_scale;
            point.better_direction =
                options.iter().any(|option| !option.retrace && option.dissipation > kept + tolerance);
        }
        Arrival { point, options, taken, stop: None, stage_ends }
    }

    /// A contact has reached the end of its mode: list the directions and take one.
    fn contact_change(&mut self, incoming: &Rate) -> Arrival {
        self.counts.contact_changes += 1;
        let standings = self.standings(&self.here.state);
        let decision =
            decide::decide(self.loading(), &self.here.state, &standings, Before::Incoming(incoming), self.rules());
        let old_modes = self.here.modes.clone();
        let old_sign = self.here.load_sign;
        let mut stop = decision.stop;
        self.take(&decision);
        let outgoing = decision.taken.map(|index| &decision.options[index]);
        let mut kind = PointKind::ContactChange;
        if let Some(choice) = outgoing
            && choice.load_sign * old_sign < 0.0
        {
            kind = PointKind::NonsmoothLimit;
            self.counts.limit_points += 1;
        }
        if stop.is_none() && self.is_cycle() {
            stop = Some(StopReason::Cycle);
        }
        let point = Point {
            kind,
            bifurcation: decide::is_bifurcation(&decision.options, decision.taken, None),
            event: Some(describe_change(self.scene, &old_modes, outgoing.map(|choice| &choice.modes[..]), &standings)),
            better_direction: false,
            unexplored_modes: decision.unexplored,
            degenerate: decision.degenerate,
        };
        Arrival { point, options: decision.options, taken: decision.taken, stop, stage_ends: false }
    }

    /// Whether the path has left this very state in these modes before; remembers it if not.
    fn is_cycle(&mut self) -> bool {
        let here = &self.here;
        let known = self.visited.iter().any(|visited| {
            visited.stage == self.stage
                && visited.modes == here.modes
                && visited.state.distance(&here.state) < SAME_STATE
                && visited.state.reactions.iter().zip(&here.state.reactions).all(|(a, b)| {
                    let tolerance = SAME_STATE * self.force_scale;
                    (a.normal - b.normal).abs() < tolerance
                        && (a.tangential[0] - b.tangential[0]).abs() < tolerance
                        && (a.tangential[1] - b.tangential[1]).abs() < tolerance
                })
        });
        let (state, modes) = (here.state.clone(), here.modes.clone());
        self.visited.push(Visited { stage: self.stage, state, modes });
        known
    }

    fn emit(&mut self, emitted: Emitted<'_>) -> Increment {
        let energy = self.energy;
        for value in [energy.external_work, energy.strain, energy.dissipated] {
            self.largest_energy = self.largest_energy.max(value.abs());
        }
        let imbalance = (energy.external_work - energy.strain - energy.dissipated).abs();
        let energy_error = if self.largest_energy > 0.0 { imbalance / self.largest_energy } else { 0.0 };
        let row = record::increment(
            self.scene,
            &Row {
                index: self.index,
                stage: self.stage,
                state: &self.here.state,
                before: emitted.before,
                modes: emitted.modes,
                arc_length: self.arc_length,
                step: emitted.step,
                point: emitted.point,
                options: emitted.options,
                taken: emitted.taken,
                list_directions: decide::is_worth_listing(emitted.options),
                energy,
                residual: emitted.residual,
                error_estimate: emitted.error_estimate,
                energy_error,
                force_scale: self.force_scale,
                elapsed_s: self.began.elapsed().as_secs_f64(),
                work: self.work,
            },
        );
        self.report.increments = self.index;
        self.report.largest_residual = self.report.largest_residual.max(row.diagnostics.residual);
        self.report.largest_complementarity =
            self.report.largest_complementarity.max(row.diagnostics.complementarity);
        self.report.largest_energy_error = self.report.largest_energy_error.max(energy_error);
        row
    }
}

/// A point reached, with the energies of the way there.
struct Accepted {
    reached: Reached,
    work: f64,
    dissipation: f64,
    /// Total at the point, from the start of the path.
    strain: f64,
}

/// What a point turned out to be.
struct Arrival {
    point: Point,
    options: Vec<Choice>,
    taken: Option<usize>,
    stop: Option<StopReason>,
    stage_ends: bool,
}

/// What [`Path::emit`] cannot see in the path itself.
struct Emitted<'a> {
    before: &'a State,
    modes: &'a [Mode],
    step: f64,
    point: Point,
    options: &'a [Choice],
    taken: Option<usize>,
    residual: f64,
    error_estimate: f64,
}


impl Iterator for Path<'_> {
    type Item = Increment;

    fn next(&mut self) -> Option<Increment> {
        match self.phase {
            Phase::Ended => return None,
            Phase::NotStarted => {
                let row = self.start_row();
                self.report.elapsed_s = self.began.elapsed().as_secs_f64();
                return Some(row);
            }
            Phase::Running => {}
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
            Ok(accepted) => Some(self.accept(accepted)),
            Err(reason) => {
                self.end(reason);
                None
            }
        }
    }
}
