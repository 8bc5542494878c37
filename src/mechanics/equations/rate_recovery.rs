//! Rates, corrections and the path's direction from solutions of the equations.

use crate::algebra::SystemFactorisation;
use crate::mechanics::contact::vector::{add, cross};
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::equations::corrected_point::Corrected;
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role, mode_factorisation, residual, slip_integration};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::DVector;

/// The rate of a vector of unknowns at a state.
pub fn rate_from(system: &ModeSystem<'_>, state: &State, values: &DVector<f64>) -> Rate {
    rate_at(system, &system.iterate(state.clone()), values, Kind::Rates)
}

/// The rate of a solution at an iterate; `kind` is the kind of the equations solved.
pub(crate) fn rate_at(system: &ModeSystem<'_>, iterate: &Iterate, values: &DVector<f64>, kind: Kind) -> Rate {
    let mut rate = no_rate(system);
    rate_into(system, iterate, values, kind, &mut rate);
    rate
}

/// The norm `‖(u̇, ṡ)‖` of a vector of unknowns.
pub(crate) fn length_of(system: &ModeSystem<'_>, values: &DVector<f64>) -> f64 {
    let structure = system.loading.structure;
    let load = values[structure.unknowns()];
    let motion = |(freedom, unknown): (usize, &Option<usize>)| match unknown {
        Some(unknown) => values[*unknown],
        None => load * system.loading.support_rate(freedom),
    };
    let squared: f64 = structure.unknown_of.iter().enumerate().map(motion).map(|velocity| velocity * velocity).sum();
    (squared + load * load).sqrt()
}

/// The zero rate, with these contacts and degrees of freedom.
pub(crate) fn no_rate(system: &ModeSystem<'_>) -> Rate {
    let displacement = vec![0.0; system.loading.structure.freedoms()];
    Rate { displacement, load: 0.0, reactions: vec![Reaction::default(); system.roles.len()] }
}

/// Writes the rate of a solution into `rate`, in which free contacts must have no reaction.
pub(crate) fn rate_into(
    system: &ModeSystem<'_>,
    iterate: &Iterate,
    values: &DVector<f64>,
    kind: Kind,
    rate: &mut Rate,
) {
    let structure = system.loading.structure;
    let load = values[structure.unknowns()];
    rate.load = load;
    for (freedom, (value, unknown)) in rate.displacement.iter_mut().zip(&structure.unknown_of).enumerate() {
        *value = match unknown {
            Some(unknown) => values[*unknown],
            None => load * system.loading.support_rate(freedom),
        };
    }
    for (contact, role) in system.roles.iter().enumerate() {
        let column = system.column_of(contact);
        rate.reactions[contact] = match role {
            Role::Free | Role::HeldBy => continue,
            Role::Stick | Role::Held => {
                let directions = system.held_directions(contact);
                let sum = |first: usize| {
                    let some = directions.iter().enumerate().skip(first);
                    some.fold([0.0; 3], |sum, (k, direction)| add(&sum, values[column + k], direction))
                };
                let normal_of_held = || system.loading.frame(contact, system.anchor).normal;
                match role {
                    Role::Held if directions[0] != normal_of_held() => Reaction::of(&sum(0), &normal_of_held()),
                    // In the frame of the contact the first direction is the normal.
                    _ => Reaction { normal: values[column], tangential: sum(1) },
                }
            }
            Role::Frictionless => Reaction { normal: values[column], tangential: [0.0; 3] },
            Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                let frame = system.loading.frame(contact, &iterate.state);
                let friction = system.loading.contacts[contact].friction;
                let pressed = friction.bound(iterate.state.reactions[contact].normal);
                let direction = system.direction(contact, &frame, iterate);
                let mut tangential = friction.traction(values[column], &direction);
                if matches!(role, Role::Plane { .. }) {
                    let across = cross(&frame.normal, &direction);
                    let per_turn = if kind == Kind::Rates { 1.0 } else { pressed };
                    tangential = add(&tangential, -per_turn * values[column + 1], &across);
                }
                if !frame.curvature.is_zero() || matches!(role, Role::Edge { .. }) {
                    let motion = system.loading.relative_rate(contact, &iterate.state, rate);
                    let change = system.direction_change(contact, iterate, &direction, &motion);
                    tangential = add(&tangential, -pressed, &change);
                }
                Reaction { normal: values[column], tangential }
            }
        };
    }
}

/// Subtracts a Newton correction from an iterate, and writes it to `correction` (see [`no_rate`]).
pub(crate) fn correct_by(system: &ModeSystem<'_>, iterate: &mut Iterate, values: &DVector<f64>, correction: &mut Rate) {
    rate_into(system, iterate, values, Kind::Increment, correction);
    let before = iterate.forces.as_ref().map(|_| iterate.state.displacement.clone());
    let Iterate { state, directions, .. } = iterate;
    state.advance(correction, -1.0);
    if system.has_tracks() {
        residual::place_exactly(system, state);
    }
    for (contact, role) in system.roles.iter().enumerate() {
        if let Role::Plane { .. } = role {
            let frame = system.loading.frame(contact, state);
            let turn = -values[system.column_of(contact) + 1];
            directions[contact] = slip_integration::turned(&frame, &directions[contact], turn);
        }
    }
    residual::make_consistent(system, iterate);
    if let (Some(before), Some(forces)) = (before, &mut iterate.forces) {
        let after = &iterate.state.displacement;
        forces.advance(system.loading.structure, &before, |freedom| after[freedom] - before[freedom]);
    }
}

/// The iterate after a Newton correction.
pub(crate) fn corrected_by(system: &ModeSystem<'_>, mut iterate: Iterate, values: &DVector<f64>) -> Iterate {
    correct_by(system, &mut iterate, values, &mut no_rate(system));
    iterate
}

/// The modes with the directions of slip at an iterate.
pub(crate) fn modes_at(system: &ModeSystem<'_>, iterate: &Iterate) -> Vec<Mode> {
    let at = |(contact, mode): (usize, &Mode)| match system.roles[contact] {
        Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
            let frame = system.loading.frame(contact, &iterate.state);
            Mode::Slip { direction: system.direction(contact, &frame, iterate) }
        }
        Role::Free | Role::Frictionless | Role::Stick | Role::Held | Role::HeldBy => *mode,
    };
    system.modes.iter().enumerate().map(at).collect()
}

/// The path's direction in this mode at its anchor or at a converged point: the null vector of the rate equations,
/// of unit arc length, on the side of `towards`. `None` where the equations have no such vector or more than one.
pub fn tangent(system: &ModeSystem<'_>, corrected: &Corrected, towards: &Rate) -> Option<Rate> {
    let iterate = system.iterate_of(corrected);
    tangent_by(system, &mode_factorisation::factorise_bordered(system, &iterate, towards)?, &iterate)
}

pub(crate) fn tangent_by(
    system: &ModeSystem<'_>,
    factorisation: &SystemFactorisation,
    iterate: &Iterate,
) -> Option<Rate> {
    let mut values = bordering(system);
    if !factorisation.solve(&mut values) {
        return None;
    }
    direction_from(system, iterate, &values)
}

/// The right-hand side whose solution is the path's direction.
pub(crate) fn bordering(system: &ModeSystem<'_>) -> DVector<f64> {
    let mut values = DVector::zeros(system.size);
    border_into(system, &mut values);
    values
}

/// Writes this right-hand side into `values`.
pub(crate) fn border_into(system: &ModeSystem<'_>, values: &mut DVector<f64>) {
    values.fill(0.0);
    values[system.size - 1] = 1.0;
}

/// The rate of a solution of the rate equations, scaled to unit arc length.
pub(crate) fn direction_from(system: &ModeSystem<'_>, iterate: &Iterate, values: &DVector<f64>) -> Option<Rate> {
    rate_at(system, iterate, values, Kind::Rates).normalised()
}
