//! The turns of slips in planes: their rates and their angles.

use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::size;
use crate::mechanics::equations::corrected_point::{Corrected, Tangent};
use crate::mechanics::equations::slip_integration::{self, Turn};
use crate::mechanics::equations::tolerances::{LIFTING_OFF, LOOSE};
use crate::mechanics::equations::{ModeSystem, Role, Track};
use crate::mechanics::problem::state::Rate;

/// Marks the slips in planes whose contacts lose their normal reaction so close to the start of the increment that the
/// direction there does not matter; `start` is the path's direction.
pub fn mark_loose(system: &mut ModeSystem<'_>, start: &Rate) {
    for index in 0..system.roles.len() {
        let Role::Plane { track } = system.roles[index] else { continue };
        let to_lift_off = LOOSE * -start.reactions[index].normal;
        system.tracks[track].turn.is_loose = system.anchor.reactions[index].normal <= to_lift_off;
    }
}

/// Sets the turns of the slips in planes at the start, from the path's direction there, and for another solve at
/// the end. Returns whether any direction settles at the end.
pub fn set_turns(system: &mut ModeSystem<'_>, start: &Rate, end: &Corrected, tangent: &Tangent) -> bool {
    let mut settles = false;
    for index in 0..system.roles.len() {
        let Role::Plane { track } = system.roles[index] else { continue };
        let Track { start: begun, turn } = system.tracks[track];
        if turn.is_loose {
            continue;
        }
        let Mode::Slip { direction } = end.modes[index] else { continue };
        let at_start = slip_integration::turn_rate(system.loading, index, system.anchor, start, &begun.direction);
        let lifts_off = end.state.reactions[index].normal <= LIFTING_OFF * system.anchor.reactions[index].normal;
        let at_end = slip_integration::turn_rate(system.loading, index, &end.state, &tangent.rate, &direction)
            .filter(|_| !lifts_off);
        let settling = tangent.stiffness_across.get(index).copied().flatten().and_then(|stiffness| {
            let chord = size(&system.chord(index, &end.state));
            let here = (&end.state, &tangent.rate);
            slip_integration::settling(system.loading, index, here, (&begun, &direction), (chord, stiffness))
        });
        settles |= settling.is_some_and(|settling| settling.share() > 0.0);
        system.tracks[track].turn = Turn { at_start, at_end, settling, is_loose: false };
    }
    settles
}

/// The largest angle (radians) between the directions of a slip in a plane at a point and at another point, or at
/// the start; contacts without normal reaction at the end, or that lose it at once, are left out.
pub fn largest_turn(system: &ModeSystem<'_>, corrected: &Corrected, other: Option<&Corrected>) -> f64 {
    let of = |(index, role): (usize, &Role)| {
        let (Role::Plane { track }, Mode::Slip { direction }) = (role, corrected.modes[index]) else {
            return 0.0;
        };
        let Track { start, turn } = &system.tracks[*track];
        if corrected.state.reactions[index].normal <= 0.0 || turn.is_loose {
            return 0.0;
        }
        let normal = system.loading.frame(index, &corrected.state).normal;
        let from = match other.map(|other| other.modes[index]) {
            Some(Mode::Slip { direction }) => direction,
            Some(Mode::Free | Mode::Stick) | None => start.carried_to(&normal),
        };
        slip_integration::angle(&normal, &from, &direction).abs()
    };
    system.roles.iter().enumerate().map(of).fold(0.0, f64::max)
}

/// The largest angle (radians) by which turns deflect the chord of a track that does not settle.
pub fn largest_correction(system: &ModeSystem<'_>, corrected: &Corrected) -> f64 {
    let of = |(index, role): (usize, &Role)| {
        let Role::Plane { track } = role else { return 0.0 };
        let turn = &system.tracks[*track].turn;
        let settles = turn.settling.is_some_and(|settling| settling.share() != 0.0);
        if settles { 0.0 } else { turn.correction(size(&system.chord(index, &corrected.state))).abs() }
    };
    system.roles.iter().enumerate().map(of).fold(0.0, f64::max)
}
