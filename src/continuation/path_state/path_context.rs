//! A path being traced: the scene, the present point and the data from which the next step starts.

use crate::branching::directions::feasible_direction::{DirectionChoice, Rules};
use crate::branching::selection::selection_rule::Decision;
use crate::branching::stability::{self, AssessedState};
use crate::complementarity::rate_search::branch_and_bound::Effort;
use crate::continuation::path_state::contact_search::{self, FarContacts, Near};
use crate::continuation::path_state::event_descriptions::describe_motion;
use crate::continuation::path_state::motion::JumpCause;
use crate::continuation::path_state::passed_points::PassedPoint;
use crate::continuation::path_state::resumable_state::{Arriving, Listed, Phase, Progress};
use crate::continuation::path_state::row_conversion::{self, RowSource};
use crate::continuation::path_state::visited_states::{ClosedContact, Visited};
use crate::continuation::scene::Scene;
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::multi_contact::changeable_contacts::{Standing, standings};
use crate::mechanics::multi_contact::moving_planes::Carried;
use crate::mechanics::multi_contact::spatial::taken_over;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::{is_in_plane, taken_apart, total_force};
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::NEGLIGIBLE_FORCE;
use crate::mechanics::structure::Structure;
use crate::model::request::{OnPathEnd, StageControl};
use crate::resources::budget::Breach;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{Increment, Point, PointKind, Stability};
use crate::result::program_iterate::ProgramIterate;
use crate::result::stop_reason::{Outcome, StopReason};
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use crate::step::event_functions::EventFunction;
use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

/// Owner of everything that changes from increment to increment.
pub(crate) struct PathTrace<'a> {
    pub scene: &'a Scene,
    pub cancel: CancelFlag,
    began: Instant,
    /// Solver time before this process resumed the path.
    pub elapsed_before: f64,
    /// Strain energy of the undeformed structure (prestress).
    pub initial_strain: f64,
    pub at: Progress,
    /// The scene's structure; where nodes turn in space, with references of its own that follow the path.
    pub structure: Cow<'a, Structure>,
    pub near: Near,
    pub far: FarContacts,
    /// Factorisation for the next step.
    pub cached: CachedFactorisation,
    /// Iterates of the programs of the last increment, where they are kept.
    pub iterates: Option<Vec<ProgramIterate>>,
    /// The points passed so far at which something happened, where they are kept.
    pub passed: Option<Vec<PassedPoint>>,
}

impl<'a> PathTrace<'a> {
    /// A path at a point that fits the scene; `elapsed_before`: solver time spent up to this point.
    pub fn at(scene: &'a Scene, mut at: Progress, elapsed_before: f64, cancel: CancelFlag) -> Self {
        let undeformed = vec![0.0; scene.structure.freedoms()];
        let initial_strain = scene.structure.strain_energy(&undeformed);
        at.hold(scene);
        let mut structure = Cow::Borrowed(&scene.structure);
        if !at.references.is_empty() {
            structure.to_mut().refer_to(&at.references);
        }
        let near = Near::of(scene, &at);
        let far = contact_search::far_contacts(scene, &at);
        Self {
            scene,
            cancel,
            began: Instant::now(),
            elapsed_before,
            initial_strain,
            at,
            structure,
            near,
            far,
            cached: CachedFactorisation::default(),
            iterates: None,
            passed: None,
        }
    }

    pub(crate) fn elapsed_s(&self) -> f64 {
        self.elapsed_before + self.began.elapsed().as_secs_f64()
    }

    pub(crate) fn loading(&self) -> Loading<'_> {
        Loading { structure: &self.structure, ..self.near.loading(self.scene) }
    }

    pub(crate) fn rules(&self) -> Rules<'_> {
        let analysis = &self.scene.analysis;
        let loads = || self.scene.stages[self.at.stage].pattern.forces.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let so_far = self.at.totals.force_scale;
        let force_scale = if so_far > NEGLIGIBLE_FORCE { so_far } else { loads().max(NEGLIGIBLE_FORCE) };
        let effort = Effort { most_modes: analysis.max_modes, certify: !analysis.keep_all, cancel: &self.cancel };
        let load_rises = self.scene.stages[self.at.stage].control == StageControl::Load;
        Rules { selection: analysis.selection, load_rises, effort, force_scale }
    }

    /// Why the structure jumps from a point at which the load can only fall, or the path has this reason to end.
    pub(crate) fn cause_of_jump(&self, cannot_rise: bool, stop: Option<StopReason>) -> Option<JumpCause> {
        let rises = self.scene.stages[self.at.stage].control == StageControl::Load;
        let goes_on = rises || self.scene.analysis.on_path_end == OnPathEnd::Jump;
        match stop {
            None if rises && cannot_rise => Some(JumpCause::LoadCannotRise),
            Some(StopReason::NoDirection) if goes_on => Some(JumpCause::NoDirection),
            Some(StopReason::Mechanism) if goes_on => Some(JumpCause::Mechanism),
            _ => None,
        }
    }

    pub(crate) fn end(&mut self, reason: StopReason) {
        // A cancelled enumeration leaves its point without a direction.
        let broken_off = self.cancel.is_cancelled() && reason.outcome() == Outcome::Stopped;
        let reason = if broken_off { StopReason::Cancelled } else { reason };
        self.at.phase = Phase::Ended;
        self.at.totals.end(reason, self.elapsed_s());
    }

    /// Ends the path at a point with these directions; of a mechanism the report says what moves.
    pub(crate) fn end_at(&mut self, reason: StopReason, options: &[DirectionChoice]) {
        self.end(reason);
        let motion = options.iter().find(|option| option.mechanism);
        if let Some(motion) = motion.filter(|_| self.at.totals.report.stop_reason == StopReason::Mechanism) {
            let moved = describe_motion(self.scene, &motion.rate.displacement);
            self.at.totals.report.sentence = format!("{}; it moves {moved}", reason.sentence());
        }
    }

    /// Ends the path within an increment, which is discarded.
    pub(crate) fn break_off(&mut self, breach: Breach, index: u64) {
        self.at.phase = Phase::Ended;
        self.at.totals.index = index;
        let elapsed_s = self.elapsed_s();
        self.at.totals.break_off(breach, elapsed_s);
        // The factorisation for the next step occupies memory.
        self.cached = CachedFactorisation::default();
    }

    pub(crate) fn standings(&self, state: &State) -> Vec<Standing> {
        let scale = self.rules().force_scale;
        standings(self.loading(), state, scale)
    }

    pub(crate) fn take(&mut self, decision: &mut Decision) {
        if let Some(index) = decision.taken {
            self.go(&decision.options[index]);
            self.cached = std::mem::take(&mut decision.options[index].cached);
            self.at.here.is_factorised = self.cached.is_one();
        }
    }

    pub(crate) fn go(&mut self, choice: &DirectionChoice) {
        self.at.here.modes.clone_from(&choice.modes);
        (self.at.here.signature, self.at.here.is_factorised) = (None, false);
        (self.at.here.before, self.at.here.is_singular) = (None, choice.is_singular);
        self.at.here.beside.clone_from(&choice.beside);
        self.at.here.load_sign = choice.load_sign;
        self.at.here.rate = Some(choice.rate.clone());
        // A node that leaves a corner along one of its obstacles, or slides along an edge, transfers its whole force
        // there.
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

    pub(crate) fn emit(&mut self, mut emitted: Emitted<'_>) -> Increment {
        // The path does not continue from here along the other directions.
        emitted.options.iter_mut().for_each(|option| option.cached = CachedFactorisation::default());
        let stability = self.stability(&emitted);
        let mut state = Cow::Borrowed(&self.at.here.state);
        if let Some(reactions) = emitted.reactions {
            state.to_mut().reactions = reactions;
        }
        let row = RowSource {
            stage: self.at.stage,
            stability,
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
        let row = row_conversion::increment(self.scene, &self.at.totals, &row);
        self.at.totals.note(&row, self.near.rows());
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

    /// Keeps the present point, at which a step has arrived along `rate` in `modes`, if something happens there; without a rate
    /// nothing is kept.
    pub(crate) fn note_passed(
        &mut self,
        rate: Option<Rate>,
        modes: &[Mode],
        event: Option<EventFunction>,
        kind: PointKind,
        stage_ends: bool,
    ) {
        let Some(rate) = rate.filter(|_| event.is_some() || stage_ends || kind != PointKind::Regular) else { return };
        let point = PassedPoint::at(self.scene, &self.at, rate, modes, event, kind, stage_ends);
        self.passed.iter_mut().for_each(|passed| passed.push(point.clone()));
    }

    /// Whether the present state is stable, where this is asked for; nothing is said of a state that moves.
    fn stability(&mut self, emitted: &Emitted<'_>) -> Option<Stability> {
        let is_asked = self.scene.analysis.record.as_ref().is_some_and(|record| record.stability);
        if !is_asked || emitted.point.kind == PointKind::Motion {
            return None;
        }
        let (state, mut work) = (&self.at.here.state, self.at.totals.work);
        let standings = self.standings(state);
        let is_critical = matches!(emitted.point.kind, PointKind::SmoothLimit | PointKind::SmoothBifurcation);
        let at =
            AssessedState { loading: self.loading(), state, modes: emitted.modes, standings: &standings, is_critical };
        let stability = stability::assess(at, &self.cancel, &mut work);
        self.at.totals.work = work;
        Some(stability)
    }

    /// The loading of all contacts, including those out of reach.
    pub(crate) fn whole_loading(&self) -> Loading<'_> {
        Loading { structure: &self.structure, ..contact_search::whole(self.scene, &self.at) }
    }

    /// Places the references of nodes that turn in space at the present point, and expresses there what a step starts
    /// from. A factorisation of before does not serve for it.
    pub(crate) fn refer(&mut self) {
        if !self.structure.turning.are_there() {
            return;
        }
        let before = self.structure.turning.clone();
        self.structure.to_mut().refer(&self.at.here.state.displacement);
        self.at.express(&before, &self.structure.turning);
        (self.cached, self.at.here.is_factorised) = (CachedFactorisation::default(), false);
    }

    /// Adds every contact that could close within a few steps of this arc length to those in reach.
    pub(crate) fn look_ahead(&mut self, step: f64) {
        let reached = contact_search::reached_within(self.scene, &self.at, &mut self.far, step);
        if !reached.is_empty() {
            self.at.admit(&reached);
            self.near = Near::of(self.scene, &self.at);
            (self.cached, self.at.here.is_factorised) = (CachedFactorisation::default(), false);
        }
    }

    /// Sets up the loading of the running stage, after a change of stage.
    pub(crate) fn load_anew(&mut self) {
        (self.cached, self.at.here.is_factorised) = (CachedFactorisation::default(), false);
        self.near = Near::of(self.scene, &self.at);
    }

    /// Names of the nodes and obstacles of the contacts in reach.
    pub(crate) fn names(&self) -> impl Iterator<Item = &(Arc<str>, Arc<str>)> {
        self.at.near.iter().map(|contact| &self.scene.contact_names[*contact])
    }

    /// The present state as recorded to detect a cycle: free contacts have no reaction and are omitted.
    pub(crate) fn visit(&self) -> Visited {
        let State { displacement, load, reactions, .. } = &self.at.here.state;
        let held = self.at.near.iter().zip(&self.at.here.modes).zip(reactions);
        let held = held.filter(|((_, mode), _)| mode.is_active());
        let held = held.map(|((contact, mode), reaction)| ClosedContact {
            contact: *contact,
            mode: *mode,
            reaction: *reaction,
        });
        let mut all = Vec::with_capacity(self.at.near.len());
        all.extend(held);
        let displacement = self.structure.turning.totals(displacement).into_owned();
        Visited { stage: self.at.stage, displacement, load: *load, held: all }
    }
}

/// The data for [`PathTrace::emit`] that are not in the trace itself.
pub(crate) struct Emitted<'a> {
    pub before: &'a State,
    /// Reactions at the end of the increment, where they differ from those with which the path continues.
    pub reactions: Option<Vec<Reaction>>,
    pub modes: &'a [Mode],
    pub step: f64,
    pub point: Point,
    pub options: Vec<DirectionChoice>,
    pub taken: Option<usize>,
    pub residual: f64,
    pub error_estimate: f64,
    pub mode_named: Option<bool>,
    /// `None` at a start.
    pub arriving: Option<Arriving>,
}
