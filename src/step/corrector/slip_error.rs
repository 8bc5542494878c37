//! The drift of the computed path from the exact one: the error of slip tracks, accumulated along the path.
//!
//! Slip along any tangent is the only place where an increment has an error of discretisation (`slip_integration`).
//! With `y = computed - exact` at the end of an increment, `y₀` at its start and the rule's defect
//! `τ = h⁵ (θ'''' - κ² κ')/720`, the linearised equations of the increment give
//!
//! ```text
//! J y = (0, 0, t·y₀ at sticking contacts, m·y₀ + ½ h θ(y₀) - τ at tracks, 0 along the path)
//! ```
//!
//! `θ''''` follows from a point half way: from the error there of the cubic through `θ` and `κ` at both ends.

use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::{Vector, add, cross, dot, size};
use crate::mechanics::equations::corrected_point::Corrected;
use crate::mechanics::equations::slip_integration::{self, Rule};
use crate::mechanics::equations::{Kind, ModeSystem, Role, Track, matrix, mode_factorisation, rate_recovery};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::DVector;

/// A point of the path with its direction.
#[derive(Clone, Copy)]
pub struct Pointed<'a> {
    pub corrected: &'a Corrected,
    pub rate: &'a Rate,
}

/// The drift at the end of an increment, from the drift at its start (`None`: none yet) and the point half way.
pub fn drift(
    system: &ModeSystem<'_>,
    start: &Rate,
    before: Option<&Rate>,
    middle: Pointed<'_>,
    end: Pointed<'_>,
) -> Option<Rate> {
    let iterate = system.iterate_of(end.corrected);
    let mut values = DVector::zeros(system.size);
    for (contact, role) in system.roles.iter().enumerate() {
        let moved = before.map_or([0.0; 3], |before| system.loading.relative_rate(contact, system.anchor, before));
        let row = system.row_of(contact);
        match role {
            Role::Free | Role::Frictionless | Role::Line { .. } | Role::Edge { .. } | Role::HeldBy => {}
            Role::Stick | Role::Held => {
                // The gap of a sticking contact is closed exactly.
                let tangents = usize::from(matches!(role, Role::Stick));
                for (k, direction) in system.held_directions(contact).iter().enumerate().skip(tangents) {
                    values[row + k] = dot(direction, &moved);
                }
            }
            Role::Plane { track } => {
                let Track { start: begun, turn } = &system.tracks[*track];
                let frame = system.loading.frame(contact, &end.corrected.state);
                let direction = iterate.directions[contact];
                let chord = system.chord(contact, &end.corrected.state);
                let rule = Rule::new(&frame, begun, turn, &direction, &chord);
                let pressed = system.loading.contacts[contact].friction.bound(system.anchor.reactions[contact].normal);
                let turned = before.filter(|_| pressed > 0.0).map_or(0.0, |before| {
                    let across = cross(&begun.normal, &begun.direction);
                    -dot(&before.reactions[contact].tangential, &across) / pressed
                });
                let defect = defect(system, contact, start, middle, end).unwrap_or(0.0);
                values[row + 1] = dot(&rule.across, &moved) - rule.by_first_turn * turned - rule.factor * defect;
            }
        }
    }
    let factorisation = mode_factorisation::factorise_as_it_is(system, &iterate, Kind::Increment, |matrix| {
        matrix::border(system, matrix, end.rate)
    })?;
    if !factorisation.solve(&mut values) {
        return None;
    }
    Some(rate_recovery::rate_at(system, &iterate, &values, Kind::Increment))
}

/// The defect `τ` of the rule.
fn defect(system: &ModeSystem<'_>, contact: usize, start: &Rate, middle: Pointed<'_>, end: Pointed<'_>) -> Option<f64> {
    let Role::Plane { track } = system.roles[contact] else { return None };
    let Track { start: begun, turn: own } = &system.tracks[track];
    let direction_at = |corrected: &Corrected| match corrected.modes[contact] {
        Mode::Slip { direction } => Some(direction),
        Mode::Free | Mode::Stick => None,
    };
    let turn = |state: &State, rate: &Rate, direction: &Vector| {
        slip_integration::turn_rate(system.loading, contact, state, rate, direction)
    };
    let (last, half) = (direction_at(end.corrected)?, direction_at(middle.corrected)?);
    let angle = |corrected: &Corrected, direction: &Vector| {
        let normal = system.loading.frame(contact, &corrected.state).normal;
        slip_integration::angle(&normal, &begun.carried_to(&normal), direction)
    };
    let (last_angle, half_angle) = (angle(end.corrected, &last), angle(middle.corrected, &half));
    let to_end = system.chord(contact, &end.corrected.state);
    let to_half = system.chord(contact, &middle.corrected.state);
    let from_half = add(&to_end, -1.0, &to_half);
    let first_part = slip_integration::arc(size(&to_half), &begun.direction, &half);
    let length = first_part + slip_integration::arc(size(&from_half), &half, &last);
    if length <= 0.0 {
        return None;
    }
    let x = first_part / length;
    let y = 1.0 - x;
    if own.is_loose {
        // Simpson's rule says how far the mean direction is from that at the end.
        return Some(length * (4.0 * half_angle - 5.0 * last_angle) / 6.0);
    }
    let settles = own.settling.is_some_and(|settling| settling.share() > 0.0);
    if own.at_end.is_none() && !settles {
        // The trapezoidal rule; the mean of the quadratic through the three directions is more exact.
        return Some(length * (half_angle - x * last_angle) / (6.0 * x * y));
    }
    let first_turn = turn(system.anchor, start, &begun.direction);
    let last_turn = turn(&end.corrected.state, end.rate, &last)?;
    let Some(first_turn) = first_turn.filter(|_| !settles) else {
        // The defect of the rule is 2/3 of the error of the quadratic with the turn at the end.
        let square = last_turn * length - last_angle;
        let quadratic = x * (last_angle - square) + x * x * square;
        let scale = x * y * y / 0.125;
        return Some(length * (half_angle - quadratic) / (1.5 * scale));
    };
    let cubic = y * y * x * length * first_turn + x * x * ((1.0 + 2.0 * y) * last_angle - y * length * last_turn);
    // The error of the cubic is x² y² h⁴ θ''''/24.
    let fourth = 24.0 * (half_angle - cubic) / (x * x * y * y);
    let (mean, change) = (0.5 * (first_turn + last_turn) * length, (last_turn - first_turn) * length);
    Some(length * (fourth - mean * mean * change) / 720.0)
}
