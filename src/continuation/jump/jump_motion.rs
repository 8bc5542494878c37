//! The motion of a jump: its beginning, the lengths of its time steps, its end at rest.

use crate::continuation::jump::held_structure::{Springs, is_damped, length};
use crate::continuation::jump::time_step::{Moved, NotMoved, TimeStep, TimeStepScene, unbalanced};
use crate::continuation::jump::tolerances::{
    ACCEPTED_MULTIPLE, BALANCED, DISTANCE_AT_REST, FARTHEST, LARGEST_GROWTH, LARGEST_REDUCTION, LEAST_LENGTH,
    LENGTH_BY_FORCE, PUSH, RAISED_LOAD, SAFETY, SHORT_WAY, SHORTEST_TIME_STEP, SPEED_AT_REST, SPEED_STOPPED,
    WAY_TO_LOWER,
};
use crate::continuation::path_state::contact_search;
use crate::continuation::path_state::motion::JumpProgress;
use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::resumable_state::{Phase, Progress};
use crate::continuation::path_state::step_factor_rounding::quantised;
use crate::mechanics::structure::Structure;
use crate::model::request::{JumpMotion, JumpMotionKind};
use crate::result::stop_reason::StopReason;

/// What a time step led to.
pub(super) enum Advance {
    Moving,
    AtRest,
    /// The time step is to be shorter, or the state at rest is not there yet.
    Again,
}

/// Why a path ends within a jump.
pub(super) struct JumpEnd(pub StopReason, pub Option<NoRest>);

impl From<StopReason> for JumpEnd {
    fn from(reason: StopReason) -> Self {
        Self(reason, None)
    }
}

impl From<NoRest> for JumpEnd {
    fn from(why: NoRest) -> Self {
        Self(StopReason::NoEquilibrium, Some(why))
    }
}

/// Why a motion comes to rest in no stable state.
#[derive(Clone, Copy)]
pub(super) enum NoRest {
    MovesAway,
    MaxSteps,
    Unstable,
    /// No time step is taken, however short.
    NoWay,
}

impl NoRest {
    pub fn sentence(self) -> &'static str {
        match self {
            Self::MovesAway => "it moves away without end",
            Self::MaxSteps => "it still moves after jump_motion.max_steps time steps",
            Self::Unstable => "it stops in a state that is not stable",
            Self::NoWay => "its motion cannot begin; obstacles or supports that the load moves may leave it no way",
        }
    }
}

/// Takes a time step, or comes to rest.
pub(super) fn advance(
    trace: &mut PathTrace<'_>,
    motion: JumpProgress,
    settings: &JumpMotion,
    scene: &mut TimeStepScene,
) -> Result<Advance, JumpEnd> {
    if trace.cancel.is_cancelled() {
        return Err(StopReason::Cancelled.into());
    }
    trace.refer();
    let structure = &trace.scene.structure;
    let speed = length(structure, &motion.velocity);
    let slows = motion.largest_speed > 0.0 && speed <= SPEED_AT_REST * motion.largest_speed;
    if slows
        && speed <= motion.rests_below
        && let Some(advance) = rest(trace, &motion, speed, settings, scene)?
    {
        return Ok(advance);
    }
    if motion.travelled > FARTHEST {
        return Err(NoRest::MovesAway.into());
    }
    if motion.steps >= settings.max_steps {
        return Err(NoRest::MaxSteps.into());
    }
    let (stiffness, places) = springs(trace, &motion, settings);
    let load_change = match motion.steps {
        0 => RAISED_LOAD,
        _ if motion.travelled > WAY_TO_LOWER && !motion.is_unresisted => -motion.raised,
        _ => 0.0,
    };
    let expected = expected_length(trace, &motion, speed, (stiffness, load_change));
    let springs = Some(Springs { stiffness, places: &places });
    let moved = match scene.take(trace, &TimeStep { springs, raised: motion.raised, load_change, expected }) {
        Ok(moved) if moved.is_stable != Some(false) => moved,
        Ok(_) | Err(NotMoved::TooLong) => return shorten(trace, 0.25),
        Err(NotMoved::Cancelled) => return Err(StopReason::Cancelled.into()),
    };
    let mut velocity = velocity(structure, trace, &moved, motion.time_step);
    let way = motion.travelled + length(structure, &velocity) * motion.time_step;
    let pushed = !motion.push.is_empty() && motion.steps == 0;
    let starts = motion.velocity.is_empty() && (pushed || settings.kind == JumpMotionKind::Overdamped);
    let change: Vec<f64> = velocity
        .iter()
        .enumerate()
        .map(|(freedom, value)| value - motion.velocity.get(freedom).copied().unwrap_or(0.0))
        .collect();
    let error = if starts { 0.0 } else { 0.5 * motion.time_step * length(structure, &change) };
    let ratio = error / (settings.tolerance * way.max(SHORT_WAY));
    let factor = quantised((SAFETY / ratio.max(1e-3).sqrt()).clamp(LARGEST_REDUCTION, LARGEST_GROWTH));
    if ratio > ACCEPTED_MULTIPLE {
        return shorten(trace, factor.min(0.5));
    }
    if pushed && settings.kind == JumpMotionKind::Inertial {
        // It is set beside its state and starts from rest there.
        velocity.fill(0.0);
    }
    let after = JumpProgress {
        steps: motion.steps + 1,
        time_step: motion.time_step * factor,
        // The push is no motion of the structure's own.
        largest_speed: if pushed { 0.0 } else { motion.largest_speed.max(length(structure, &velocity)) },
        velocity,
        travelled: way,
        raised: motion.raised + load_change,
        ..motion
    };
    accept(trace, moved, after);
    Ok(Advance::Moving)
}

/// Lets the next time step be shorter.
fn shorten(trace: &mut PathTrace<'_>, factor: f64) -> Result<Advance, JumpEnd> {
    let Some(motion) = &mut trace.at.motion else { return Err(StopReason::NoEquilibrium.into()) };
    motion.time_step *= factor;
    match motion.steps {
        _ if motion.time_step >= SHORTEST_TIME_STEP => Ok(Advance::Again),
        0 => Err(NoRest::NoWay.into()),
        _ => Err(StopReason::StepUnderflow.into()),
    }
}

/// The length of the motion that is expected of a time step.
fn expected_length(trace: &PathTrace<'_>, motion: &JumpProgress, speed: f64, step: (f64, f64)) -> f64 {
    let (stiffness, load_change) = step;
    let by_load = load_change.abs() * size_of_load(trace) / (stiffness + 1.0);
    let by_push = if motion.steps == 0 && !motion.push.is_empty() { PUSH } else { 0.0 };
    // Mass that has been stopped is accelerated by what is out of balance.
    let is_stopped = motion.steps > 0 && speed <= SPEED_STOPPED * motion.largest_speed;
    let by_force = if is_stopped { LENGTH_BY_FORCE * out_of_balance(trace) } else { 0.0 };
    (speed * motion.time_step).max(by_load).max(by_push).max(by_force).max(LEAST_LENGTH)
}

/// Seeks the state at rest from a motion that has slowed down: first at the raised load, then at the load itself; `None`
/// where the motion goes on, as mass that obstacles have stopped is pushed off again.
fn rest(
    trace: &mut PathTrace<'_>,
    motion: &JumpProgress,
    speed: f64,
    settings: &JumpMotion,
    scene: &mut TimeStepScene,
) -> Result<Option<Advance>, JumpEnd> {
    let settled = settle(trace, scene, (motion.raised, 0.0), speed)?;
    let structure = &trace.scene.structure;
    let is_near = |moved: &Moved| {
        length(structure, &velocity(structure, trace, moved, 1.0)) <= DISTANCE_AT_REST * motion.travelled
    };
    if let Some(settled) = settled.filter(is_near) {
        let raised = motion.raised;
        accept(trace, settled, motion.clone());
        if raised == 0.0 {
            return Ok(Some(Advance::AtRest));
        }
        if let Some(moved) = settle(trace, scene, (raised, -raised), raised)? {
            accept(trace, moved, JumpProgress { raised: 0.0, ..motion.clone() });
            return Ok(Some(Advance::AtRest));
        }
    }
    if speed <= SPEED_STOPPED * motion.largest_speed {
        if settings.kind == JumpMotionKind::Inertial && is_accelerated(trace) {
            return Ok(None);
        }
        return Err(NoRest::Unstable.into());
    }
    if let Some(motion) = &mut trace.at.motion {
        motion.rests_below = 0.3 * speed;
    }
    Ok(Some(Advance::Again))
}

/// Whether forces out of balance accelerate the mass of the structure.
fn is_accelerated(trace: &PathTrace<'_>) -> bool {
    out_of_balance(trace) > BALANCED * trace.rules().force_scale
}

/// The size of the force that is out of balance.
fn out_of_balance(trace: &PathTrace<'_>) -> f64 {
    length(&trace.scene.structure, &unbalanced(trace.loading(), &trace.at.here.state))
}

/// The stable state of equilibrium near the present one, at the raised load or with a change of it.
fn settle(
    trace: &PathTrace<'_>,
    scene: &mut TimeStepScene,
    (raised, load_change): (f64, f64),
    expected: f64,
) -> Result<Option<Moved>, JumpEnd> {
    let expected = expected.max(out_of_balance(trace)).max(LEAST_LENGTH);
    let still = TimeStep { springs: None, raised, load_change, expected };
    match scene.take(trace, &still) {
        Ok(moved) => Ok(Some(moved).filter(|moved| moved.is_stable != Some(false))),
        Err(NotMoved::TooLong) => Ok(None),
        Err(NotMoved::Cancelled) => Err(StopReason::Cancelled.into()),
    }
}

/// Stiffness and places of the springs that stand for damping and inertia.
fn springs(trace: &PathTrace<'_>, motion: &JumpProgress, settings: &JumpMotion) -> (f64, Vec<f64>) {
    let (step, mut places) = (motion.time_step, trace.at.here.state.displacement.clone());
    if motion.steps == 0 {
        let size = length(&trace.scene.structure, &motion.push).max(f64::MIN_POSITIVE);
        places.iter_mut().zip(&motion.push).for_each(|(place, push)| *place += PUSH * push / size);
    }
    match settings.kind {
        JumpMotionKind::Overdamped => (1.0 / step, places),
        JumpMotionKind::Inertial => {
            let stiffness = (1.0 / step + 2.0 * settings.damping_ratio.unwrap_or(1.0)) / step;
            places.iter_mut().zip(&motion.velocity).for_each(|(place, speed)| *place += speed / step / stiffness);
            (stiffness, places)
        }
    }
}

/// The size of the load per load factor, dimensionless; at least a small part of the scales.
fn size_of_load(trace: &PathTrace<'_>) -> f64 {
    let pattern = &trace.scene.stages[trace.at.stage].pattern;
    let all = pattern.forces.iter().chain(&pattern.supports).chain(pattern.shifts.iter().flatten());
    all.fold(0.0_f64, |most, value| value.abs().max(most)).max(1e-3)
}

/// The displacements of a time step over its length, along the degrees of freedom that are damped.
fn velocity(structure: &Structure, trace: &PathTrace<'_>, moved: &Moved, time_step: f64) -> Vec<f64> {
    let before = &trace.at.here.state.displacement;
    let change =
        moved.at.here.state.displacement.iter().zip(before).map(|(after, before)| (after - before) / time_step);
    change.enumerate().map(|(freedom, value)| if is_damped(structure, freedom) { value } else { 0.0 }).collect()
}

/// Makes the end of a time step the present point.
fn accept(trace: &mut PathTrace<'_>, moved: Moved, motion: JumpProgress) {
    let Moved { at, external_work, dissipated, damped, strain, .. } = moved;
    let before = &mut trace.at;
    let mut totals = before.totals.clone();
    (totals.work, totals.force_scale) = (at.totals.work, totals.force_scale.max(at.totals.force_scale));
    totals.add_motion(external_work, dissipated, damped, strain);
    // Contacts may have come within reach; the state from which the structure jumped has them, too.
    let (from, row) =
        at.motion.as_ref().map_or((motion.from.clone(), motion.row.clone()), |own| (own.from.clone(), own.row.clone()));
    let mut after = Progress {
        phase: Phase::Running,
        stage_over: false,
        step: before.step,
        waiting: before.waiting,
        visited: std::mem::take(&mut before.visited),
        counts: before.counts,
        begun: None,
        free_motion: None,
        listed: None,
        followed: None,
        totals,
        ..at
    };
    after.here.state.set_load(motion.from.load + motion.raised);
    (after.here.rate, after.here.signature, after.here.before, after.here.apart) = (None, None, None, None);
    (after.here.drift, after.here.beside) = (None, None);
    (after.here.is_singular, after.here.is_factorised) = (false, false);
    after.hold(trace.scene);
    after.motion = Some(JumpProgress { from, row, ..motion });
    trace.at = after;
    if !trace.at.references.is_empty() {
        trace.structure.to_mut().refer_to(&trace.at.references);
    }
    trace.load_anew();
    trace.far = contact_search::far_contacts(trace.scene, &trace.at);
}
