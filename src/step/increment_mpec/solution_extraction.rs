//! The results of an increment from the variables at its end: contact modes, the state, and the exact solution.

use crate::complementarity::mpec::semismooth_newton::{self, Polished};
use crate::complementarity::mpec::{Activities, ConeActivity, PairActivity, Problem, ProgramSolution};
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::problem::state::State;
use crate::resources::cancel::CancelFlag;
use crate::step::increment_mpec::tolerances::{MEMBER_TOLERANCE, SMALLEST_DIRECTED_SIZE, SMALLEST_MOTION_COSINE};
use crate::step::increment_mpec::{InReach, IncrementProgram, Named, tangent_components};
use nalgebra::DVector;

/// The result of a solution of the program. Where there are circular cones, the solution is first made exact, so that
/// the directions of slip are those at the end of the increment.
pub(super) fn named_modes(
    program: &IncrementProgram<'_>,
    solution: ProgramSolution,
    present: &[Mode],
    cancel: &CancelFlag,
) -> Named {
    if let Some(exact) = exact_end(program, &solution.x, cancel)
        && let Ok(activities) = Activities::at(program, &exact, MEMBER_TOLERANCE)
    {
        return Named {
            modes: modes_at(program, &exact, &activities, present),
            #[cfg(test)]
            end: Some(end_state(program, &exact)),
        };
    }
    let activities = Activities { pairs: solution.activity, cones: solution.cone_activity };
    Named {
        modes: modes_at(program, &solution.x, &activities, present),
        #[cfg(test)]
        end: None,
    }
}

/// The exact solution near variables of the program, where there are circular cones.
fn exact_end(program: &IncrementProgram<'_>, x: &DVector<f64>, cancel: &CancelFlag) -> Option<DVector<f64>> {
    if program.cone_sizes().is_empty() {
        return None;
    }
    let polished = polish(program, x, cancel).filter(|polished| polished.is_converged)?;
    let moved = program.loading.structure.unknowns() + 1;
    let (before, after) = (x.rows(0, moved), polished.x.rows(0, moved));
    // A solution other than that of the program is rejected.
    (before.dot(&after) >= SMALLEST_MOTION_COSINE * before.norm() * after.norm()).then_some(polished.x)
}

/// The contact modes at variables of the program; `present` decides where a pair is biactive.
pub(super) fn modes_at(
    program: &IncrementProgram<'_>,
    x: &DVector<f64>,
    activities: &Activities,
    present: &[Mode],
) -> Vec<Mode> {
    let mut modes = vec![Mode::Free; program.loading.contacts.len()];
    let mut pairs = activities.pairs.iter().copied();
    let mut next = || pairs.next().unwrap_or(PairActivity::NeitherZero);
    let mut cones = activities.cones.iter().copied();
    for entry in &program.reach {
        let present = present[entry.contact];
        let normal = next();
        let closed = if entry.tangents == 0 {
            Mode::Slip { direction: Default::default() }
        } else if entry.tangents == 2 {
            let activity = cones.next().unwrap_or(ConeActivity::NotComplementary);
            closed_in_space(entry, x, activity, present)
        } else {
            match (next(), next()) {
                (PairActivity::FirstZero, _) => tangent_components::slip(&entry.frame.tangents, [1.0, 0.0]),
                (_, PairActivity::FirstZero) => tangent_components::slip(&entry.frame.tangents, [-1.0, 0.0]),
                (PairActivity::BothZero, _) | (_, PairActivity::BothZero) if present.is_active() => present,
                _ => Mode::Stick,
            }
        };
        modes[entry.contact] = match normal {
            PairActivity::FirstZero => closed,
            PairActivity::BothZero => present,
            PairActivity::SecondZero | PairActivity::NeitherZero => Mode::Free,
        };
    }
    modes
}

/// The state at variables of the program, reactions included.
pub(super) fn end_state(program: &IncrementProgram<'_>, x: &DVector<f64>) -> State {
    let mut state = program.state(x);
    state.reactions.fill(Reaction::default());
    for entry in &program.reach {
        let mut tangential = [0.0; 2];
        if entry.friction.is_rough() {
            for (k, component) in tangential.iter_mut().enumerate().take(entry.tangents) {
                *component = x[entry.tangential(k)] * program.force;
            }
        }
        let tangents = entry.tangents_at(&program.loading.frame(entry.contact, &state));
        state.reactions[entry.contact] =
            tangent_components::reaction(&tangents, x[entry.normal()] * program.force, tangential);
    }
    state
}

/// Solves equilibrium, contact and friction of the increment with exactly the prescribed arc length, by the semismooth
/// Newton method from variables of the program. This serves where the equations of a mode cannot be started, since the
/// direction of slip is not known.
pub(super) fn polish(program: &IncrementProgram<'_>, x: &DVector<f64>, cancel: &CancelFlag) -> Option<Polished> {
    let moved = program.loading.structure.unknowns() + 1;
    let arc_length = |x: &DVector<f64>| {
        let size = x.rows(0, moved).norm();
        let mut gradient = DVector::zeros(x.len());
        if size > 0.0 {
            gradient.rows_mut(0, moved).copy_from(&(x.rows(0, moved) / size));
        }
        (size - 1.0, gradient)
    };
    semismooth_newton::polish(program, x, Some(&arc_length), cancel).ok()
}

/// The mode of a closed contact in 3D.
fn closed_in_space(entry: &InReach, x: &DVector<f64>, activity: ConeActivity, present: Mode) -> Mode {
    let (force, slip) = entry.cone_members(x);
    let size = |v: &[f64; 3]| v[1].hypot(v[2]);
    let sliding = if size(&force) > SMALLEST_DIRECTED_SIZE {
        tangent_components::slip(&entry.frame.tangents, [-force[1], -force[2]])
    } else if size(&slip) > SMALLEST_DIRECTED_SIZE {
        tangent_components::slip(&entry.frame.tangents, [slip[1], slip[2]])
    } else {
        present
    };
    match activity {
        ConeActivity::BothOnBoundary | ConeActivity::FirstZero | ConeActivity::FirstZeroSecondOnBoundary => sliding,
        ConeActivity::SecondZeroFirstOnBoundary if matches!(present, Mode::Slip { .. }) => sliding,
        ConeActivity::BothZero if present.is_active() => present,
        ConeActivity::SecondZero
        | ConeActivity::SecondZeroFirstOnBoundary
        | ConeActivity::BothZero
        | ConeActivity::NotComplementary => Mode::Stick,
    }
}
