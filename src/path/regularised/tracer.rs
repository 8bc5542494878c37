//! The path as an iterator: points accepted, stages, rows.

use super::increment::Change;
use super::law::Penalties;
use super::record::{give, modes, work_and_dissipation};
use super::stepping::Accepted;
use super::system::{Point, System};
use crate::cancel::CancelFlag;
use crate::linear_algebra::Factorisation;
use crate::model::request::Regularised;
use crate::path::advance::Work;
use crate::path::increment::{Energy, Increment, PointKind};
use crate::path::loading::{LoadPattern, Loading};
use crate::path::name_event::{describe_change, describe_start};
use crate::path::record::{self, Row};
use crate::path::report::Report;
use crate::path::scene::{End, Scene};
use crate::path::state::State;
use crate::path::stepping::NO_ENERGY;
use crate::path::stop::StopReason;
use std::time::Instant;

/// A path being traced by the regularised method.
pub struct RegularisedPath<'a> {
    pub(super) scene: &'a Scene,
    pub(super) settings: Regularised,
    pub(super) cancel: CancelFlag,
    began: Instant,
    phase: Phase,
    pub(super) stage: usize,
    held: LoadPattern,
    pub(super) here: Point,
    /// Tangent at the present point; `None` where it is singular.
    pub(super) tangent: Option<Factorisation>,
    /// The increment that led here, within the stage.
    pub(super) previous: Option<Change>,
    /// Sign of the load rate here; a stage's load rises at first.
    load_sign: f64,
    /// Arc length that the next step tries.
    pub(super) step: f64,
    index: u64,
    arc_length: f64,
    energy: Energy,
    initial_strain: f64,
    largest_energy: f64,
    pub(super) force_scale: f64,
    counts: Counts,
    pub(super) work: Work,
    report: Report,
}

#[derive(Default)]
struct Counts {
    increments: u64,
    limit_points: u64,
    contact_changes: u64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    NotStarted,
    Running,
    Ended,
}

impl<'a> RegularisedPath<'a> {
    pub fn new(scene: &'a Scene, cancel: CancelFlag) -> Self {
        let state = State::at_rest(&scene.structure, scene.contacts.len());
        let contacts = vec![super::law::Response::default(); scene.contacts.len()];
        Self {
            settings: scene.analysis.regularised.unwrap_or_default(),
            cancel,
            began: Instant::now(),
            phase: Phase::NotStarted,
            stage: 0,
            held: scene.stages.first().map(|stage| stage.pattern.zeroed()).unwrap_or_default(),
            tangent: None,
            previous: None,
            load_sign: 1.0,
            step: scene.analysis.arc_length.initial,
            index: 0,
            arc_length: 0.0,
            energy: Energy::default(),
            initial_strain: scene.structure.strain_energy(&state.displacement),
            here: Point { state, contacts },
            largest_energy: 0.0,
            force_scale: 0.0,
            counts: Counts::default(),
            work: Work::default(),
            report: Report::begun(),
            scene,
        }
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        (self.phase == Phase::Ended).then(|| self.report.clone())
    }

    fn end(&mut self, reason: StopReason) {
        self.phase = Phase::Ended;
        self.report.stop_reason = reason;
        self.report.sentence = reason.sentence().to_owned();
        self.report.elapsed_s = self.began.elapsed().as_secs_f64();
        self.report.factorisations = self.work.factorisations;
        self.report.newton_iterations = self.work.newton_iterations;
    }

    pub(super) fn system(&self) -> System<'_> {
        System {
            loading: Loading {
                structure: &self.scene.structure,
                contacts: &self.scene.contacts,
                corners: &self.scene.corners,
                pattern: &self.scene.stages[self.stage].pattern,
                held: &self.held,
            },
            penalties: Penalties { normal: self.settings.normal_penalty, tangential: self.settings.tangential_penalty },
        }
    }

    fn start_row(&mut self) -> Increment {
        let evaluation = self.system().evaluate(&self.here, &self.here.state);
        self.work.factorisations += 1;
        self.tangent = Factorisation::new(evaluation.tangent);
        self.here = self.system().point(self.here.state.clone(), evaluation.contacts);
        self.phase = Phase::Running;
        let before = self.here.clone();
        self.emit(&before, PointKind::Start, Some(describe_start(self.scene)), 0.0, 0.0)
    }

    /// Makes a converged increment the present point and says what changed within it.
    fn accept(&mut self, accepted: Accepted) -> Increment {
        let Accepted { converged, stage_ends } = accepted;
        let before = std::mem::replace(&mut self.here, converged.point);
        let (work, dissipated) = work_and_dissipation(&self.system(), &before, &self.here);
        self.energy.external_work += work;
        self.energy.dissipated += dissipated;
        self.energy.strain = self.scene.structure.strain_energy(&self.here.state.displacement) - self.initial_strain;
        self.force_scale = self.force_scale.max(converged.force_scale);
        let step = self.here.state.distance(&before.state);
        self.arc_length += step;
        self.index += 1;
        self.counts.increments += 1;
        self.tangent = converged.tangent;
        self.previous = Some(converged.change);
        let (mut kind, mut events) = (PointKind::Regular, Vec::new());
        if self.direction().is_some_and(|(_, sign)| self.load_turns(sign)) {
            kind = PointKind::SmoothLimit;
            let extremum = if self.load_sign < 0.0 { "maximum" } else { "minimum" };
            events.push(format!("load {extremum} within the step"));
            self.counts.limit_points += 1;
        }
        let (old, new) = (modes(&before), modes(&self.here));
        if old != new {
            kind = PointKind::ContactChange;
            events.push(format!("{} within the step", describe_change(self.scene, &old, Some(&new), &[])));
            self.counts.contact_changes += 1;
        }
        let stage_ends = stage_ends || self.count_ends_stage();
        if stage_ends {
            if kind == PointKind::Regular {
                kind = PointKind::End;
            }
            events.push(format!("stage \"{}\" ends", self.scene.stages[self.stage].name));
        }
        let event = (!events.is_empty()).then(|| events.join("; "));
        let row = self.emit(&before, kind, event, step, converged.residual);
        if stage_ends {
            self.next_stage();
        }
        row
    }

    /// Takes the sign of the load rate at a new point and says whether it has changed.
    fn load_turns(&mut self, sign: f64) -> bool {
        let before = std::mem::replace(&mut self.load_sign, sign);
        before * sign < 0.0
    }

    fn count_ends_stage(&self) -> bool {
        self.scene.stages[self.stage].ends.iter().any(|end| match end {
            End::LimitPoints(count) => self.counts.limit_points >= *count,
            End::ContactChanges(count) => self.counts.contact_changes >= *count,
            End::Increments(count) => self.counts.increments >= *count,
            End::Load { .. } | End::Displacement { .. } => false,
        })
    }

    /// Holds what the stage reached and goes to the next whose end is not met already.
    fn next_stage(&mut self) {
        loop {
            if self.stage + 1 == self.scene.stages.len() {
                return self.end(StopReason::StagesCompleted);
            }
            self.held.add(self.here.state.load, &self.scene.stages[self.stage].pattern);
            self.stage += 1;
            self.here.state.load = 0.0;
            self.previous = None;
            self.load_sign = 1.0;
            self.counts = Counts::default();
            self.step = self.step.min(self.scene.analysis.arc_length.initial);
            let ends = &self.scene.stages[self.stage].ends;
            if !ends.iter().any(|end| end.left(&self.here).is_some_and(|left| left <= 0.0)) {
                return;
            }
        }
    }

    fn emit(&mut self, before: &Point, kind: PointKind, event: Option<String>, step: f64, residual: f64) -> Increment {
        let energy = self.energy;
        for value in [energy.external_work, energy.strain, energy.dissipated] {
            self.largest_energy = self.largest_energy.max(value.abs());
        }
        let imbalance = (energy.external_work - energy.strain - energy.dissipated).abs();
        let size = self.largest_energy.max(NO_ENERGY * self.force_scale);
        let energy_error = if size > 0.0 { imbalance / size } else { 0.0 };
        let system = self.system();
        let row = record::increment(
            self.scene,
            &Row {
                index: self.index,
                stage: self.stage,
                loading: system.loading,
                state: &self.here.state,
                before: &before.state,
                modes: &modes(&self.here),
                arc_length: self.arc_length,
                step,
                point: crate::path::increment::Point {
                    kind,
                    bifurcation: false,
                    event,
                    better_direction: false,
                    unexplored_modes: 0,
                    degenerate: false,
                },
                options: &[],
                taken: None,
                list_directions: false,
                energy,
                residual,
                error_estimate: give(&system, &self.here),
                energy_error,
                force_scale: self.force_scale,
                elapsed_s: self.began.elapsed().as_secs_f64(),
                work: self.work,
                mode_named: None,
            },
        );
        self.report.increments = self.index;
        self.report.largest_residual = self.report.largest_residual.max(row.diagnostics.residual);
        self.report.largest_complementarity = self.report.largest_complementarity.max(row.diagnostics.complementarity);
        self.report.largest_energy_error = self.report.largest_energy_error.max(energy_error);
        row
    }
}

impl Iterator for RegularisedPath<'_> {
    type Item = Increment;

    fn next(&mut self) -> Option<Increment> {
        match self.phase {
            Phase::Ended => return None,
            Phase::NotStarted => return Some(self.start_row()),
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
        match self.step() {
            Ok(accepted) => Some(self.accept(accepted)),
            Err(reason) => {
                self.end(reason);
                None
            }
        }
    }
}
