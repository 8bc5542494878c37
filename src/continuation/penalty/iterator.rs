//! The path as an iterator: points accepted, stages, rows.

use crate::algebra::Factorisation;
use crate::continuation::path_state::event_descriptions::{describe_change, describe_start};
use crate::continuation::path_state::resumable_state::{Phase, StageCounts};
use crate::continuation::path_state::row_conversion::{self, RowSource};
use crate::continuation::path_state::totals::{Added, Totals};
use crate::continuation::penalty::increment::PenaltyIncrement;
use crate::continuation::penalty::law::Penalties;
use crate::continuation::penalty::penalty_equations::{PenaltyPoint, PenaltySystem};
use crate::continuation::penalty::penalty_work::{give, modes, work_and_dissipation};
use crate::continuation::penalty::step_control;
use crate::continuation::penalty::step_control::AcceptedPenaltyStep;
use crate::continuation::scene::Scene;
use crate::mechanics::problem::loading::{LoadPattern, Loading};
use crate::mechanics::problem::state::State;
use crate::mechanics::structure::Structure;
use crate::model::request::Regularised;
use crate::resources::budget::{self, Budget};
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{self, Increment, PointKind};
use crate::result::report::Report;
use crate::result::stop_reason::StopReason;
use std::borrow::Cow;
use std::time::Instant;

/// A path being traced by the regularised method.
pub struct RegularisedPath<'a> {
    pub(super) scene: &'a Scene,
    /// The scene's structure; where nodes turn in space, with references of its own that follow the path.
    pub(super) structure: Cow<'a, Structure>,
    pub(super) settings: Regularised,
    pub(super) cancel: CancelFlag,
    budget: Budget,
    began: Instant,
    phase: Phase,
    pub(super) stage: usize,
    /// The first row of the running stage has been emitted.
    begun: bool,
    /// The stage ended at the present point; the next one begins with the next increment.
    stage_over: bool,
    held: LoadPattern,
    pub(super) here: PenaltyPoint,
    /// Tangent at the present point; `None` where it is singular.
    pub(super) tangent: Option<Factorisation>,
    /// The increment that led here, within the stage.
    pub(super) previous: Option<PenaltyIncrement>,
    /// Sign of the load rate at the present point; a stage's load rises at first.
    load_sign: f64,
    /// Arc length of the next attempted step.
    pub(super) step: f64,
    initial_strain: f64,
    pub(super) totals: Totals,
    counts: StageCounts,
}

impl<'a> RegularisedPath<'a> {
    pub fn new(scene: &'a Scene, cancel: CancelFlag) -> Self {
        let state = State::at_rest(&scene.structure, scene.contacts.len());
        let contacts = vec![crate::continuation::penalty::law::PenaltyResponse::default(); scene.contacts.len()];
        Self {
            settings: scene.analysis.regularised.unwrap_or_default(),
            budget: Budget::under_way(cancel.clone()),
            cancel,
            began: Instant::now(),
            phase: Phase::NotStarted,
            stage: 0,
            begun: false,
            stage_over: false,
            held: scene.stages.first().map(|stage| stage.pattern.zeroed()).unwrap_or_default(),
            tangent: None,
            previous: None,
            load_sign: 1.0,
            step: scene.analysis.arc_length.initial,
            initial_strain: scene.structure.strain_energy(&state.displacement),
            here: PenaltyPoint { state, contacts },
            totals: Totals::begun(),
            counts: StageCounts::default(),
            structure: Cow::Borrowed(&scene.structure),
            scene,
        }
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        (self.phase == Phase::Ended).then(|| self.totals.report.clone())
    }

    fn end(&mut self, reason: StopReason) {
        self.phase = Phase::Ended;
        self.totals.end(reason, self.began.elapsed().as_secs_f64());
    }

    pub(super) fn system(&self) -> PenaltySystem<'_> {
        PenaltySystem {
            loading: Loading {
                structure: &self.structure,
                contacts: &self.scene.contacts,
                corners: &self.scene.corners,
                pattern: &self.scene.stages[self.stage].pattern,
                held: &self.held,
            },
            penalties: Penalties { normal: self.settings.normal_penalty, tangential: self.settings.tangential_penalty },
        }
    }

    /// Places the references of nodes that turn in space at the present point. The increment that led here is the same
    /// by both references; the tangent is formed anew.
    fn refer(&mut self) {
        if !self.structure.turning.are_there() {
            return;
        }
        let before = self.structure.turning.clone();
        self.structure.to_mut().refer(&self.here.state.displacement);
        self.here.state.displacement = before.totals(&self.here.state.displacement).into_owned();
        let evaluation = self.system().evaluate(&self.here, &self.here.state);
        self.totals.work.factorisations += 1;
        self.tangent = Factorisation::new(evaluation.tangent);
    }

    /// The row with which a stage begins. Where a bound of the stage is already met, the stage ends there too.
    fn begin_stage(&mut self) -> Increment {
        let evaluation = self.system().evaluate(&self.here, &self.here.state);
        let residual = self.system().relative_residual(&evaluation, self.totals.force_scale);
        if self.phase == Phase::NotStarted {
            self.totals.work.factorisations += 1;
            self.tangent = Factorisation::new(evaluation.tangent);
            self.here = self.system().point(self.here.state.clone(), evaluation.contacts);
        } else {
            self.totals.index += 1;
        }
        self.phase = Phase::Running;
        self.begun = true;
        let ends = &self.scene.stages[self.stage].ends;
        self.stage_over = ends.iter().any(|end| step_control::left_to(end, &self.here).is_some_and(|left| left <= 0.0));
        let event = describe_start(self.scene, self.stage, self.stage_over);
        let before = self.here.clone();
        self.emit(&before, PointKind::Start, Some(event), 0.0, residual)
    }

    /// Makes a converged increment the present point and describes the changes within it.
    fn accept(&mut self, accepted: AcceptedPenaltyStep) -> Increment {
        let AcceptedPenaltyStep { converged, stage_ends } = accepted;
        let before = std::mem::replace(&mut self.here, converged.point);
        let (external_work, dissipated) = work_and_dissipation(&self.system(), &before, &self.here);
        let step = self.scene.arc_length(&before.state, &self.here.state, self.here.state.distance(&before.state));
        self.totals.add(&Added {
            step,
            external_work,
            largest_work: external_work.abs(),
            work_of_pattern: [external_work, 0.0],
            dissipated,
            strain: self.structure.strain_energy(&self.here.state.displacement) - self.initial_strain,
            force_scale: converged.force_scale,
        });
        self.counts.increments += 1;
        self.tangent = converged.tangent;
        self.previous = Some(converged.change);
        let (mut kind, mut events) = (PointKind::Regular, Vec::new());
        if step_control::direction(self).is_some_and(|(_, sign)| self.load_turns(sign)) {
            kind = PointKind::SmoothLimit;
            let extremum = if self.load_sign < 0.0 { "maximum" } else { "minimum" };
            events.push(format!("load {extremum} within the step"));
            self.counts.limit_points += 1;
        }
        let (old, new) = (modes(&before), modes(&self.here));
        if old != new {
            kind = PointKind::ContactChange;
            events.push(format!(
                "{} within the step",
                describe_change(self.scene.contact_names.iter(), &old, Some(&new), &[])
            ));
            self.counts.contact_changes += 1;
        }
        let stage_ends = stage_ends || self.counts.end_stage(&self.scene.stages[self.stage].ends);
        if stage_ends {
            if kind == PointKind::Regular {
                kind = PointKind::End;
            }
            events.push(format!("stage \"{}\" ends", self.scene.stages[self.stage].name));
        }
        let event = (!events.is_empty()).then(|| events.join("; "));
        self.stage_over = stage_ends;
        self.emit(&before, kind, event, step, converged.residual)
    }

    /// Sets the sign of the load rate at a new point and returns whether it has changed.
    fn load_turns(&mut self, sign: f64) -> bool {
        let before = std::mem::replace(&mut self.load_sign, sign);
        before * sign < 0.0
    }

    /// Keeps the load that the stage reached and begins the next stage; `false` where there is none.
    fn next_stage(&mut self) -> bool {
        if self.stage + 1 == self.scene.stages.len() {
            self.end(StopReason::StagesCompleted);
            return false;
        }
        self.held.add(self.here.state.load, &self.scene.stages[self.stage].pattern);
        self.stage += 1;
        self.begun = false;
        self.here.state.load = 0.0;
        self.previous = None;
        self.load_sign = 1.0;
        self.counts = StageCounts::default();
        self.step = self.step.min(self.scene.analysis.arc_length.initial);
        true
    }

    fn emit(
        &mut self,
        before: &PenaltyPoint,
        kind: PointKind,
        event: Option<String>,
        step: f64,
        residual: f64,
    ) -> Increment {
        let system = self.system();
        let places: Vec<Option<usize>> = (0..self.scene.contacts.len()).map(Some).collect();
        let rows: Vec<usize> = (0..self.scene.reported.len()).collect();
        let row = RowSource {
            stability: None,
            stage: self.stage,
            loading: system.loading,
            whole: system.loading,
            places: &places,
            rows: &rows,
            state: &self.here.state,
            before: &before.state,
            modes: &modes(&self.here),
            step,
            point: &increment::Point::plain(kind, event),
            options: &[],
            taken: None,
            residual,
            error_estimate: give(&system, &self.here),
            elapsed_s: self.began.elapsed().as_secs_f64(),
            mode_named: None,
        };
        let row = row_conversion::increment(self.scene, &self.totals, &row);
        self.totals.note(&row, &rows);
        row
    }
}

impl Iterator for RegularisedPath<'_> {
    type Item = Increment;

    fn next(&mut self) -> Option<Increment> {
        let (budget, index) = (self.budget.clone(), self.totals.index);
        budget.during(|| self.increment()).unwrap_or_else(|breach| {
            self.phase = Phase::Ended;
            self.totals.index = index;
            self.totals.break_off(breach, self.began.elapsed().as_secs_f64());
            self.tangent = None;
            None
        })
    }
}

impl RegularisedPath<'_> {
    /// The next increment; `None` where the path has ended.
    fn increment(&mut self) -> Option<Increment> {
        match self.phase {
            Phase::Ended => return None,
            Phase::NotStarted => {
                budget::spend(0);
                return Some(self.begin_stage());
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
        if self.totals.index >= self.scene.analysis.max_increments {
            self.end(StopReason::MaxIncrements);
            return None;
        }
        self.refer();
        if !self.begun {
            return Some(self.begin_stage());
        }
        match step_control::step(self) {
            Ok(accepted) => Some(self.accept(accepted)),
            Err(reason) => {
                self.end(reason);
                None
            }
        }
    }
}
