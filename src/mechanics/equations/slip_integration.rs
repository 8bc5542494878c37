//! The track of a node that slips along any tangent.
//!
//! The direction `d` opposes the traction and turns as the node goes. Along the track, of length `h` in an increment, let
//! `θ` be the angle of `d` and `κ = dθ/dh` its turn. The chord of the increment has the angle
//!
//! ```text
//! ½ (θ₀ + θ₁) + h (κ₀ - κ₁)/12   [ + h⁴ (θ'''' - κ² κ')/720 ]
//! ```
//!
//! (Euler and Maclaurin's formula; the last term is left out and estimated.) Without the second term it is the
//! trapezoidal rule in the form "the chord bisects the directions at its ends", of second order. `κ₁` is known only
//! when the increment is: the increment is solved with the trapezoidal rule first and with the correction then, which
//! makes it of fourth order (deferred correction: L. Fox, Proc. R. Soc. A 190 (1947) 31; V. Pereyra, Numer. Math. 8
//! (1966) 376, doi:10.1007/BF02162981). Where a node starts to slip without being pressed, `κ₀` is not defined by the
//! rates; the angle is then `(θ₀ + 2 θ₁)/3 - h κ₁/6 [ + h³ θ'''/72 ]`, for that one increment. On a curved obstacle directions are carried along the geodesic.
//!
//! A node that is hardly pressed goes where the structure takes it, and its direction follows: with the stiffness `K`
//! across the slip
//!
//! ```text
//! κ = λ (θ* - θ),    μ r_n κ ḣ = (K ḣ + μ ṙ_n)(θ* - θ),    λ = (K ḣ + μ ṙ_n)/(μ r_n ḣ)
//! ```
//!
//! so that `z = λ h` grows without bound as the reaction vanishes. Over such an increment a rule has to be L-stable and
//! cannot take `κ₁` from a solve before. The second rule is that of the Padé approximant (1, 2), which is L-stable
//! (E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, Springer 1996, chapter IV.3); with `κ₁` linear in
//! `θ₁` as above it is solved until it holds at the end of the increment itself. It takes over as `z` grows.

use crate::mechanics::contact::Frame;
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};

/// Where a slip starts: its direction and the obstacle's normal there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    pub direction: Vector,
    pub normal: Vector,
}

/// Turn of the direction per length of track at both ends of the increment, where known.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Turn {
    pub at_start: Option<f64>,
    pub at_end: Option<f64>,
    /// How the turn at the end depends on the direction there, where the node is hardly pressed.
    pub settling: Option<Settling>,
}

/// A direction that goes over to another one: `κ = -λ (θ - θ*)` near the direction that was found last.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settling {
    /// Angle from the direction at the start to that found last.
    pub angle: f64,
    /// `z = λ h`, positive.
    pub quickness: f64,
    /// `θ* - θ`
    pub ahead: f64,
}

/// The track's equation at an iterate.
pub(crate) struct Rule {
    /// What is left over of it.
    pub left_over: f64,
    /// Derivative of the equation by the node's motion, a tangent.
    pub across: Vector,
    /// Derivative of the equation by the turn of the direction at the end.
    pub by_turn: f64,
    /// The same by the turn at the start.
    pub by_first_turn: f64,
    /// What multiplies the distance by which the chord's end is off the track.
    pub factor: f64,
}

/// Values of `z` from which the second rule has a share, and from which it is the only one.
const SETTLING: [f64; 2] = [2.0, 6.0];
/// A larger `z` makes no difference.
const QUICKEST: f64 = 1e8;

/// Speeds (of unit arc length) and reactions (over the largest) below this give a direction no turn.
const SMALLEST: f64 = 1e-9;

impl Start {
    /// The direction carried along the geodesic to where the normal is another: turned with it by the smallest rotation.
    pub fn carried_to(&self, normal: &Vector) -> Vector {
        let across = dot(&self.direction, normal);
        if across == 0.0 {
            return self.direction;
        }
        let both = add(&self.normal, 1.0, normal);
        add(&self.direction, -across / (1.0 + dot(&self.normal, normal)), &both)
    }
}

impl Turn {
    /// The angle (radians) by which the turns at the ends move the chord away from the bisector of the directions, over
    /// a track of this length.
    pub fn correction(&self, length: f64) -> f64 {
        match (self.at_start, self.at_end) {
            (Some(first), Some(last)) => length * (first - last) / 12.0,
            _ => 0.0,
        }
    }
}

impl Settling {
    /// The share of the second rule in the equation.
    pub fn share(&self) -> f64 {
        ((self.quickness - SETTLING[0]) / (SETTLING[1] - SETTLING[0])).clamp(0.0, 1.0)
    }
}

impl Rule {
    /// `rate_recovery` is that at the end, `chord` the motion relative to the obstacle.
    pub fn new(frame: &Frame, start: &Start, turn: &Turn, direction: &Vector, chord: &Vector) -> Self {
        let carried = start.carried_to(&frame.normal);
        if let Some(settling) = turn.settling.filter(|settling| settling.share() > 0.0) {
            return Self::settling(frame, &carried, turn, &settling, direction, chord);
        }
        let bisector = unit(&add(&carried, 1.0, direction));
        let length = arc(size(chord), &carried, direction);
        let correction = match (turn.at_start, turn.at_end) {
            (None, Some(last)) => {
                let turned = dot(&cross(&carried, direction), &frame.normal).asin();
                (turned - length * last) / 6.0
            }
            _ => turn.correction(length),
        };
        let across = cross(&frame.normal, &bisector);
        let along = unit(&add(&bisector, correction, &across));
        let across = cross(&frame.normal, &along);
        let half = 0.5 * dot(&along, chord);
        Self { left_over: dot(&across, chord), across, by_turn: -half, by_first_turn: -half, factor: 1.0 }
    }

    /// With angles from the first direction, `φ` that of the chord and `h κ₁ = ω z (θ* - θ₁) + (1 - ω) (h κ₁)⁰`, the
    /// equation is `h (φ - φ_rule)/(∂φ_rule/∂θ₁) = 0`: where `z` is large it says `θ₁ = θ*`.
    fn settling(
        frame: &Frame,
        carried: &Vector,
        turn: &Turn,
        settling: &Settling,
        direction: &Vector,
        chord: &Vector,
    ) -> Self {
        let length = size(chord);
        let arc = arc(length, carried, direction);
        let chord_angle = if length > 0.0 { angle(&frame.normal, carried, chord) } else { 0.0 };
        let last = angle(&frame.normal, carried, direction);
        let share = if turn.at_start.is_some() { settling.share() } else { 1.0 };
        let quickness = settling.quickness.min(QUICKEST);
        // `h κ₁` at the direction found last is `z` times what was ahead of it.
        let slope = settling.share() * quickness;
        let turned = quickness * settling.ahead - slope * (last - settling.angle);
        let first = (1.0 - share) * (0.5 * last + (turn.at_start.unwrap_or(0.0) * arc - turned) / 12.0);
        let second = share * (2.0 / 3.0 * last - turned / 6.0);
        let by_last = (1.0 - share) * (0.5 + slope / 12.0) + share * (2.0 / 3.0 + slope / 6.0);
        let factor = 1.0 / by_last;
        let along = if length > 0.0 { scaled(chord, 1.0 / length) } else { *carried };
        Self {
            left_over: length * factor * (chord_angle - first - second),
            across: scaled(&cross(&frame.normal, &along), factor),
            by_turn: -length,
            by_first_turn: -length * factor * ((1.0 - share) * 0.5 + share / 3.0),
            factor,
        }
    }
}

/// The angle from one tangent to another.
pub(crate) fn angle(normal: &Vector, from: &Vector, to: &Vector) -> f64 {
    dot(&cross(from, to), normal).atan2(dot(from, to))
}

/// Length of the arc over a chord whose end directions differ.
pub(crate) fn arc(chord: f64, first: &Vector, last: &Vector) -> f64 {
    let turn = size(&add(last, -1.0, first));
    chord * (1.0 + turn * turn / 24.0)
}

/// A direction turned by an angle (radians, small) and brought into the tangent plane of a frame.
pub(crate) fn turned(frame: &Frame, direction: &Vector, angle: f64) -> Vector {
    let rotated = add(direction, angle, &cross(&frame.normal, direction));
    unit(&add(&rotated, -dot(&rotated, &frame.normal), &frame.normal))
}

/// Turn of a slip's direction per length of track, from the path's direction; `None` where the node does not move or is
/// not pressed.
pub(crate) fn turn_rate(
    loading: Loading<'_>,
    contact: usize,
    state: &State,
    rate: &Rate,
    direction: &Vector,
) -> Option<f64> {
    let frame = loading.frame(contact, state);
    let speed = dot(direction, &loading.relative_rate(contact, state, rate));
    let pressed = loading.contacts[contact].friction.bound(state.reactions[contact].normal);
    if speed <= SMALLEST || pressed <= SMALLEST * rate.reactions[contact].size() {
        return None;
    }
    let across = cross(&frame.normal, direction);
    let turn = -dot(&rate.reactions[contact].tangential, &across) / pressed;
    Some(turn / speed)
}

/// How a direction settles over a chord; `None` where the node does not move, or turns away from `θ*`. `stiffness` is `K`.
pub(crate) fn settling(
    loading: Loading<'_>,
    contact: usize,
    (state, rate): (&State, &Rate),
    (start, direction): (&Start, &Vector),
    (chord, stiffness): (f64, f64),
) -> Option<Settling> {
    let frame = loading.frame(contact, state);
    let friction = loading.contacts[contact].friction;
    let speed = dot(direction, &loading.relative_rate(contact, state, rate));
    let pressed = friction.bound(state.reactions[contact].normal);
    let across = cross(&frame.normal, direction);
    let turn = -dot(&rate.reactions[contact].tangential, &across);
    let drawn = stiffness * speed + friction.bound(rate.reactions[contact].normal);
    // Past the end of contact there is no friction to follow anything.
    if speed <= SMALLEST || drawn <= 0.0 || pressed <= 0.0 {
        return None;
    }
    let carried = start.carried_to(&frame.normal);
    let length = arc(chord, &carried, direction);
    let quickness = drawn * length / (pressed * speed);
    let angle = angle(&frame.normal, &carried, direction);
    Some(Settling { angle, quickness: quickness.min(QUICKEST), ahead: turn / drawn })
}
