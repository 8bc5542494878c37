//! The turns of slips in planes: their rates and their angles.

use crate::algebra::fixed_point::Acceleration;
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
        let turn = Turn { at_start, at_end, settling, is_loose: false };
        settles |= turn.settles();
        system.tracks[track].turn = turn;
    }
    settles
}

/// The solves of an increment in which directions of slip settle. Each takes the turns at the end from the one before.
/// Where slipping nodes are coupled, the turn of one depends on the directions of the others, and the passes converge
/// linearly: they are accelerated.
#[derive(Debug, Default)]
pub struct SettlingPasses {
    acceleration: Acceleration,
    /// The tracks of which the acceleration knows.
    tracks: Vec<usize>,
}

impl SettlingPasses {
    /// Sets the turns for another solve, after one with those that the system has. Returns whether any direction settles
    /// at the end, and the largest angle (radians) by which another solve would turn a direction on the chord that it
    /// has.
    pub fn advance(
        &mut self,
        system: &mut ModeSystem<'_>,
        start: &Rate,
        end: &Corrected,
        tangent: &Tangent,
    ) -> (bool, f64) {
        let posed: Vec<Turn> = system.tracks.iter().map(|track| track.turn).collect();
        let settles = set_turns(system, start, end, tangent);
        let (mut tracks, mut point, mut image, mut chords) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        // What a direction does to the others is the force that it turns: one that is hardly pressed is left alone.
        let mut weights = Vec::new();
        let (mut unsettled, mut is_same_rule) = (0.0_f64, true);
        for (index, role) in system.roles.iter().enumerate() {
            let Role::Plane { track } = *role else { continue };
            let turn = &system.tracks[track].turn;
            if turn.is_loose || end.state.reactions[index].normal <= 0.0 {
                continue;
            }
            let chord = size(&system.chord(index, &end.state));
            is_same_rule &= turn.settles() == posed[track].settles();
            match (posed[track].entering(chord), turn.entering(chord)) {
                (Some(before), Some(now)) if chord > 0.0 => {
                    unsettled = unsettled.max(turn.effect() * (now - before).abs());
                    tracks.push(track);
                    point.push(before);
                    image.push(now);
                    chords.push(chord);
                    let friction = system.loading.contacts[index].friction;
                    weights.push(turn.effect() * friction.bound(end.state.reactions[index].normal));
                }
                (before, now) => is_same_rule &= before.is_some() == now.is_some(),
            }
        }
        if !is_same_rule || tracks != self.tracks {
            *self = Self { acceleration: Acceleration::default(), tracks };
        }
        if !is_same_rule {
            return (settles, f64::INFINITY);
        }
        let next = self.acceleration.next(&point, &image, &weights);
        for ((&track, angle), chord) in self.tracks.iter().zip(next).zip(chords) {
            system.tracks[track].turn.enter(angle, chord);
        }
        (settles, unsettled)
    }
}

/// The largest angle (radians) by which the direction of a slip in a plane has turned since the start; contacts without
/// normal reaction at the end, or that lose it at once, are left out.
pub fn largest_turn(system: &ModeSystem<'_>, corrected: &Corrected) -> f64 {
    let of = |(index, role): (usize, &Role)| {
        let (Role::Plane { track }, Mode::Slip { direction }) = (role, corrected.modes[index]) else {
            return 0.0;
        };
        let Track { start, turn } = &system.tracks[*track];
        if corrected.state.reactions[index].normal <= 0.0 || turn.is_loose {
            return 0.0;
        }
        let normal = system.loading.frame(index, &corrected.state).normal;
        slip_integration::angle(&normal, &start.carried_to(&normal), &direction).abs()
    };
    system.roles.iter().enumerate().map(of).fold(0.0, f64::max)
}

/// The largest angle (radians) by which turns deflect the chord of a track that does not settle.
pub fn largest_correction(system: &ModeSystem<'_>, corrected: &Corrected) -> f64 {
    let of = |(index, role): (usize, &Role)| {
        let Role::Plane { track } = role else { return 0.0 };
        let turn = &system.tracks[*track].turn;
        if turn.settles() { 0.0 } else { turn.correction(size(&system.chord(index, &corrected.state))).abs() }
    };
    system.roles.iter().enumerate().map(of).fold(0.0, f64::max)
}
