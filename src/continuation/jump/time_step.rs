//! One implicit time step as an equilibrium path.

use crate::branching::bifurcation::singularity::test_functions::negative_eigenvalues;
use crate::continuation::increment::{acceptance, stages, step_control};
use crate::continuation::jump::held_structure::Springs;
use crate::continuation::jump::tolerances::{MOST_INCREMENTS, SHORTEST_SHARE, STORED_SHARE};
use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::resumable_state::{Phase, Progress, StageCounts};
use crate::continuation::path_state::totals::Totals;
use crate::continuation::path_state::visited_states::VisitedStates;
use crate::continuation::scene::{Scene, StageLoad};
use crate::mechanics::contact::ContactPair;
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::problem::loading::{LoadPattern, Loading};
use crate::mechanics::problem::node_contact_forces;
use crate::mechanics::problem::state::{State, dot};
use crate::model::request::{Events, Method, StageControl};
use crate::result::stop_reason::StopReason;
use std::sync::Arc;

/// A time step to be taken from the present point of a path.
pub(super) struct TimeStep<'a> {
    /// The springs of the step; `None`: the step leads to rest.
    pub springs: Option<Springs<'a>>,
    /// Part by which the load is raised before the step.
    pub raised: f64,
    /// Change of the load in the step.
    pub load_change: f64,
    /// The length of the motion that is expected.
    pub expected: f64,
}

/// A time step taken.
pub(super) struct Moved {
    /// The path at the end of the step, in the stage of before.
    pub at: Progress,
    /// Work of loads and moving supports on the structure.
    pub external_work: f64,
    pub dissipated: f64,
    /// Energy that the structure gave to damping and mass.
    pub damped: f64,
    /// Strain energy at the end, from that of the undeformed structure.
    pub strain: f64,
    /// Whether the structure, with its springs, is stable at the end in the modes there, contacts at rest; `None` where
    /// this is not known.
    pub is_stable: Option<bool>,
}

/// Why a time step was not taken.
pub(super) enum NotMoved {
    /// Its path does not lead to its end: a shorter step may.
    TooLong,
    Cancelled,
}

/// The scenes of time steps from one path: what they share is made once.
pub(super) struct TimeStepScene {
    scene: Scene,
    /// Number of stages before those of the time step.
    stages: usize,
}

impl TimeStepScene {
    pub fn of(trace: &PathTrace<'_>) -> Self {
        let mut scene = trace.scene.clone();
        scene.stages.truncate(trace.at.stage + 1);
        scene.jumps = false;
        scene.analysis.method = Method::Auto;
        scene.analysis.events = Events::All;
        scene.analysis.max_increments = u64::MAX;
        scene.analysis.record = None;
        scene.analysis.arc_length.max = f64::MAX;
        let stages = scene.stages.len();
        Self { scene, stages }
    }

    /// Takes a time step from the present point.
    pub fn take(&mut self, trace: &PathTrace<'_>, step: &TimeStep<'_>) -> Result<Moved, NotMoved> {
        let held = step.springs.as_ref().map(|springs| springs.holding(&trace.scene.structure));
        self.scene.structure = held.unwrap_or_else(|| trace.scene.structure.clone());
        let mut structure = self.scene.structure.clone();
        if !trace.at.references.is_empty() {
            structure.refer_to(&trace.at.references);
        }
        let loading = Loading { structure: &structure, ..trace.loading() };
        let unbalanced = unbalanced(loading, &trace.at.here.state);
        self.set_stages(trace, step, &unbalanced);
        let mut inner = PathTrace::at(&self.scene, begin(trace), 0.0, trace.cancel.clone());
        let start = trace.at.here.state.displacement.clone();
        inner.initial_strain = inner.structure.strain_energy(&start);
        inner.at.step = 1.5 * step.expected;
        let [released, driven] = follow(&mut inner)?;
        let end = &inner.at.here.state;
        let motion: Vec<f64> = end.displacement.iter().zip(&start).map(|(end, start)| end - start).collect();
        let stored = |displacement: &[f64]| {
            step.springs.as_ref().map_or(0.0, |springs| springs.energy(&trace.scene.structure, displacement))
        };
        let held_back = dot(&unbalanced, &motion);
        let energy = &inner.at.totals.energy;
        let spring_energy = stored(&end.displacement) - stored(&start);
        // The part by which the load is raised does no work of its own: what it does sets the structure in motion.
        let raising = step.raised * dot(&trace.scene.stages[trace.at.stage].pattern.forces, &motion) + driven;
        let (external_work, dissipated) = (energy.external_work - released + held_back - raising, energy.dissipated);
        let damped = spring_energy + held_back - released - raising;
        let strain =
            inner.structure.strain_energy(&end.displacement) - stored(&end.displacement) - trace.initial_strain;
        let is_stable = is_stable(&inner);
        let at = Progress { stage: trace.at.stage, reached: trace.at.reached.clone(), ..inner.at };
        Ok(Moved { at, external_work, dissipated, damped, strain, is_stable })
    }

    /// The stages of the step: what is out of balance is held back, then released.
    fn set_stages(&mut self, trace: &PathTrace<'_>, step: &TimeStep<'_>, unbalanced: &[f64]) {
        let present = &trace.scene.stages[trace.at.stage];
        self.scene.stages.truncate(self.stages);
        let of = |pattern: LoadPattern, ends: Vec<End>| {
            // Where the rule does not decide between directions, the one along which the forces rise is taken.
            let (pattern, control) = (Arc::new(pattern), StageControl::Load);
            StageLoad { of_stage: Arc::clone(&pattern), sense: 1.0, pattern, ends, control, ..present.clone() }
        };
        let mut held_back = present.pattern.zeroed();
        held_back.forces.copy_from_slice(unbalanced);
        let mut released = held_back.clone();
        released.add(step.load_change, &present.pattern);
        let mut pattern = present.pattern.zeroed();
        pattern.add(1.0 / step.expected, &released);
        self.scene.stages.push(of(held_back, Vec::new()));
        self.scene.stages.push(of(pattern, vec![End::Load { bound: step.expected, sign: 1.0 }, End::LimitPoints(1)]));
        self.scene.analysis.arc_length.min = SHORTEST_SHARE * step.expected;
        self.scene.analysis.arc_length.initial = 1.5 * step.expected;
    }
}

/// The present point as the beginning of the time step's path.
fn begin(trace: &PathTrace<'_>) -> Progress {
    let before = &trace.at;
    let mut at = Progress {
        phase: Phase::Running,
        stage: before.stage + 2,
        stage_over: false,
        visited: VisitedStates::default(),
        begun: None,
        free_motion: None,
        listed: None,
        followed: None,
        counts: StageCounts::default(),
        creeping: 0,
        ..before.clone()
    };
    at.reached.extend([before.here.state.load, -1.0]);
    at.here.state.set_load(0.0);
    (at.here.rate, at.here.signature, at.here.before, at.here.apart) = (None, None, None, None);
    (at.here.drift, at.here.beside, at.here.is_singular) = (None, None, false);
    let Totals { index, arc_length, force_scale, work, .. } = before.totals;
    // What the structure stores, not what it has given off so far, is what the energies of a time step are compared with.
    let largest_energy = before.totals.energy.strain.abs().max(STORED_SHARE * before.totals.largest_energy);
    at.totals = Totals { index, arc_length, largest_energy, force_scale, work, ..Totals::begun() };
    at
}

/// Follows the path of a time step to its end; returns the work of the forces that are released, and that of supports and
/// obstacles that a change of the load moves.
fn follow(inner: &mut PathTrace<'_>) -> Result<[f64; 2], NotMoved> {
    let mut of_pattern = [0.0; 2];
    stages::begin_stage(inner);
    for _ in 0..MOST_INCREMENTS {
        if inner.cancel.is_cancelled() {
            return Err(NotMoved::Cancelled);
        }
        if inner.at.phase == Phase::Ended || inner.at.here.rate.is_none() {
            break;
        }
        inner.refer();
        let (end, balance) = match step_control::step(inner) {
            Ok(accepted) => accepted,
            Err(StopReason::Cancelled) => return Err(NotMoved::Cancelled),
            Err(_) => break,
        };
        of_pattern.iter_mut().zip(balance.added.work_of_pattern).for_each(|(sum, part)| *sum += part);
        if acceptance::accept(inner, end, balance).is_none() {
            break;
        }
        if inner.at.stage_over {
            let is_whole = inner.at.here.state.load == bound(inner);
            return if is_whole { Ok(of_pattern) } else { Err(NotMoved::TooLong) };
        }
    }
    Err(if inner.cancel.is_cancelled() { NotMoved::Cancelled } else { NotMoved::TooLong })
}

fn bound(inner: &PathTrace<'_>) -> f64 {
    let ends = &inner.scene.stages[inner.at.stage].ends;
    let bound = ends.iter().find_map(|end| if let End::Load { bound, .. } = end { Some(*bound) } else { None });
    bound.unwrap_or(f64::INFINITY)
}

/// The force that is out of balance at a state, over all degrees of freedom; none along supported ones.
pub(super) fn unbalanced(loading: Loading<'_>, state: &State) -> Vec<f64> {
    let structure = loading.structure;
    let mut force = vec![0.0; structure.freedoms()];
    node_contact_forces::write_out_of_balance(loading, state, &mut force);
    force.iter_mut().zip(&structure.unknown_of).for_each(|(force, unknown)| {
        *force = if unknown.is_some() { -*force } else { 0.0 };
    });
    force
}

/// Whether a structure is stable in the modes at the end of a step, contacts that slip with friction held; `None` where
/// this is not known.
fn is_stable(inner: &PathTrace<'_>) -> Option<bool> {
    let (loading, here) = (inner.loading(), &inner.at.here);
    if !loading.structure.allows_dense() {
        return None;
    }
    let held = |(mode, contact): (&Mode, &ContactPair)| {
        if mode.is_active() && contact.tangents() > 0 { Mode::Stick } else { *mode }
    };
    let modes: Vec<Mode> = here.modes.iter().zip(loading.contacts).map(held).collect();
    let mut work = inner.at.totals.work;
    negative_eigenvalues(loading, &modes, &here.state, &here.state, &mut work).map(|negative| negative == 0)
}
