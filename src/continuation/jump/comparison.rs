//! The other kind of motion from the state in which a jump begins: what the choice of the motion decides.

use crate::continuation::jump::jump_motion::{self, Advance, JumpEnd};
use crate::continuation::jump::time_step::TimeStepScene;
use crate::continuation::path_state::motion::{JumpProgress, OtherMotionEnd};
use crate::continuation::path_state::path_context::PathTrace;
use crate::mechanics::contact::vector::{add, size};
use crate::model::request::JumpMotion;
use crate::result::increment::{JumpMotionKind, OtherMotion};
use crate::result::stop_reason::StopReason;

/// Follows the other kind of motion to its end and keeps where it leads, before the first time step of a jump; `false`
/// where it is cancelled.
pub(super) fn follow_other_motion(trace: &mut PathTrace<'_>, settings: &JumpMotion) -> bool {
    let is_known = |motion: &JumpProgress| motion.steps > 0 || motion.other.is_some();
    if trace.at.motion.as_ref().is_none_or(is_known) {
        return true;
    }
    let kind = match settings.kind {
        JumpMotionKind::Overdamped => JumpMotionKind::Inertial,
        JumpMotionKind::Inertial => JumpMotionKind::Overdamped,
    };
    let settings = JumpMotion { kind, damping_ratio: None, ..*settings };
    let mut other = PathTrace::at(trace.scene, trace.at.clone(), 0.0, trace.cancel.clone());
    let mut scene = TimeStepScene::of(&other);
    let failure = loop {
        let Some(motion) = other.at.motion.clone() else { break None };
        match jump_motion::advance(&mut other, motion, &settings, &mut scene) {
            Ok(Advance::AtRest) => break None,
            Ok(Advance::Moving | Advance::Again) => {}
            Err(JumpEnd(StopReason::Cancelled, _)) => return false,
            Err(JumpEnd(reason, why)) => {
                break Some(why.map_or_else(|| reason.sentence(), |why| why.sentence()).to_owned());
            }
        }
    };
    let (before, after) = (&trace.at.totals.energy, &other.at.totals.energy);
    let end = OtherMotionEnd {
        kind,
        steps: other.at.motion.as_ref().map_or(0, |motion| motion.steps),
        displacement: if failure.is_none() { other.at.here.state.displacement.clone() } else { Vec::new() },
        failure,
        released: after.released - before.released,
        dissipated: after.dissipated - before.dissipated,
    };
    trace.at.totals.work = other.at.totals.work;
    if let Some(motion) = &mut trace.at.motion {
        motion.other = Some(end);
    }
    true
}

/// The other motion in the user's units, beside the state at rest that is the present point.
pub(super) fn compared(trace: &PathTrace<'_>, other: &OtherMotionEnd) -> OtherMotion {
    let (structure, plan) = (&trace.scene.structure, trace.scene.plan());
    let here = &trace.at.here.state.displacement;
    let apart = |node: usize| {
        size(&add(&structure.translation_at(node, &other.displacement), -1.0, &structure.translation_at(node, here)))
    };
    let at_rest = other.failure.is_none();
    let distance = at_rest.then(|| (0..structure.numbering.nodes()).map(apart).fold(0.0, f64::max));
    let energy = plan.displacement_scale * plan.force_scale;
    OtherMotion {
        kind: other.kind,
        time_steps: other.steps,
        at_rest,
        failure: other.failure.clone(),
        distance: distance.map(|distance| distance * plan.displacement_scale),
        released: other.released * energy,
        dissipated: other.dissipated * energy,
    }
}

/// Where the other motion leads, beside the one of the path.
pub(super) fn sentence(other: &OtherMotion) -> String {
    let (kind, steps) = (other.kind.name(), time_steps(other.time_steps));
    match (other.distance, &other.failure) {
        (Some(distance), _) => format!("an {kind} motion of {steps} comes to rest {distance:.3e} away from there"),
        (None, Some(failure)) => format!("an {kind} motion does not come to rest: {failure}"),
        (None, None) => format!("an {kind} motion does not come to rest"),
    }
}

/// Where the other motion leads, where the one of the path does not come to rest.
pub(super) fn sentence_of_end(other: &OtherMotionEnd) -> String {
    let kind = other.kind.name();
    match &other.failure {
        Some(failure) => format!("neither does an {kind} motion come to rest: {failure}"),
        None => format!("an {kind} motion of {} comes to rest", time_steps(other.steps)),
    }
}

/// A number of time steps, in words.
pub(super) fn time_steps(steps: u64) -> String {
    if steps == 1 { "1 time step".to_owned() } else { format!("{steps} time steps") }
}
