//! The path as an iterator: step lengths, stages and their ends.

use super::increment::{Change, Control, Converged, Failure, Limits};
use super::law::Penalties;
use super::record::{give, modes, work_and_dissipation};
use super::system::{Point, System};
use crate::cancel::CancelFlag;
use crate::linear_algebra::Factorisation;
use crate::model::request::{LoadSign, Regularised};
use crate::path::advance::{AT_END, Work};
use crate::path::increment::{Energy, Increment, PointKind};
use crate::path::loading::{LoadPattern, Loading};
use crate::path::name_event::{describe_change, describe_start};
use crate::path::record::{self, Row};
use crate::path::report::Report;
use crate::path::scene::{End, Scene};
use crate::path::state::State;
use crate::path::stepping::{COLLAPSED, NO_ENERGY};
use crate::path::stop::StopReason;
use std::time::Instant;

/// A step may grow by this factor from one increment to the next.
const MOST_GROWTH: f64 = 2.0;
/// Iterations tried, over those desired.
const PATIENCE: u64 = 4;

/// A path being traced by the regularised method.
pub struct RegularisedPath<'a> {
    scene: &'a Scene,
    settings: Regularised,
    cancel: CancelFlag,
    began: Instant,
    phase: Phase,
    stage: usize,
    held: LoadPattern,
    here: Point,
    /// Tangent at the present point; `None` where it is singular.
    tangent: Option<Factorisation>,
    /// The increment that led here, within the stage.
    previous: Option<Change>,
    /// Sign of the load rate here; a stage's load rises at first.
    load_sign: f64,
    /// Arc length that the next step tries.
    step: f64,
    index: u64,
    arc_length: f64,
    energy: Energy,
    initial_strain: f64,
    largest_energy: f64,
    force_scale: f64,
    counts: Counts,
    work: Work,
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

    fn system(&self) -> System<'_> {
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

    /// The direction `K⁻¹f` and the sign of the load along the path.
    fn direction(&self) -> Option<(nalgebra::DVector<f64>, f64)> {
        let tangent = self.tangent.as_ref()?;
        let mut by_load = self.system().load_vector(&self.here.state, &self.here.contacts);
        if !tangent.solve(&mut by_load) {
            return None;
        }
        let sign = match (&self.previous, self.settings.load_sign) {
            (None, _) => 1.0,
            (Some(_), LoadSign::Determinant) => tangent.determinant_sign(),
            (Some(previous), LoadSign::PreviousIncrement) => {
                1.0_f64.copysign(previous.displacement.dot(&by_load) + 0.0)
            }
        };
        Some((by_load, sign))
    }

    /// Increments are tried, shorter and shorter, until one converges.
    fn step(&mut self) -> Result<Accepted, StopReason> {
        let bounds = &self.scene.analysis.arc_length;
        let (least, most) = (bounds.min, bounds.max);
        let Some((by_load, sign)) = self.direction() else { return Err(self.reason_of_failure()) };
        let load_weight = self.settings.load_weight;
        let tangent = Change { displacement: by_load * sign, load: sign };
        let length = tangent.size(load_weight);
        let mut size = self.step.min(most);
        loop {
            let predictor = tangent.scaled(size / length);
            let found = self.correct(predictor, Control::ArcLength { size, load_weight });
            match found.and_then(|converged| self.end_stage_if_passed(converged, size)) {
                Ok(accepted) => {
                    let needed = accepted.converged.iterations.max(1) as f64;
                    let factor = (self.settings.desired_iterations as f64 / needed).sqrt().min(MOST_GROWTH);
                    self.step = (size * factor).clamp(least, most);
                    return Ok(accepted);
                }
                Err(Failure::Cancelled) => return Err(StopReason::Cancelled),
                Err(Failure::Singular | Failure::NoRoot | Failure::NotConverged) => {
                    size *= 0.5;
                    if size < least {
                        return Err(self.reason_of_failure());
                    }
                }
            }
        }
    }

    fn correct(&mut self, predictor: Change, control: Control) -> Result<Converged, Failure> {
        let mut work = self.work;
        let limits = Limits {
            tolerance: self.settings.tolerance,
            most_iterations: PATIENCE * self.settings.desired_iterations,
            force_scale: self.force_scale,
            cancel: &self.cancel,
        };
        let converged = self.system().correct(&self.here, predictor, control, &limits, &mut work);
        self.work = work;
        converged
    }

    /// Solves once more under control of the load or displacement at which the stage ends, if the increment passed it.
    fn end_stage_if_passed(&mut self, converged: Converged, size: f64) -> Result<Accepted, Failure> {
        let fraction = |end: &End| {
            let left = end.left(&converged.point)?;
            if left > AT_END {
                return None;
            }
            let before = end.left(&self.here)?;
            Some(if before > left { (before / (before - left)).clamp(0.0, 1.0) } else { 1.0 })
        };
        let passed = self.scene.stages[self.stage].ends.iter().filter_map(|end| Some((*end, fraction(end)?)));
        let Some((end, fraction)) = passed.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Ok(Accepted { converged, stage_ends: false });
        };
        let control = match end {
            End::Load { bound, .. } => Control::Load(bound),
            End::Displacement { freedom, bound, .. } => Control::Displacement { freedom, value: bound },
            End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_) => {
                return Ok(Accepted { converged, stage_ends: false });
            }
        };
        let last = self.correct(converged.change.scaled(fraction), control)?;
        // Another branch may have that load, too, further away.
        if last.change.size(self.settings.load_weight) > size * (1.0 + AT_END) {
            return Err(Failure::NotConverged);
        }
        Ok(Accepted { converged: last, stage_ends: true })
    }

    /// Why steps became too short.
    fn reason_of_failure(&self) -> StopReason {
        let stretch = self.scene.structure.smallest_stretch(&self.here.state.displacement);
        if self.system().is_mechanism(&self.here) {
            StopReason::Mechanism
        } else if stretch < COLLAPSED {
            StopReason::CollapsedBar
        } else {
            StopReason::StepUnderflow
        }
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

struct Accepted {
    converged: Converged,
    /// It lies exactly at a load or displacement at which the stage ends.
    stage_ends: bool,
}

impl End {
    /// How far a point is from a load or displacement bound; negative beyond it.
    fn left(&self, point: &Point) -> Option<f64> {
        match *self {
            Self::Load { bound, sign } => Some(sign * (bound - point.state.load)),
            Self::Displacement { freedom, bound, sign } => Some(sign * (bound - point.state.displacement[freedom])),
            Self::LimitPoints(_) | Self::ContactChanges(_) | Self::Increments(_) => None,
        }
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
