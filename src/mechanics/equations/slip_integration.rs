//! Integrates the slip path (the track) of a node that can slip in any tangential direction.
//!
//! The direction `d` opposes the traction and turns as the node moves. Along the track, of length `h` in an increment,
//! let `θ` be the angle of `d` and `κ = dθ/dh` its turn. The chord of the increment has the angle
//!
//! ```text
//! ½ (θ₀ + θ₁) + h (κ₀ - κ₁)/12   [ + h⁴ (θ'''' - κ² κ')/720 ]
//! ```
//!
//! (Euler–Maclaurin formula; the last term is omitted and estimated.) Without the second term this is the trapezoidal
//! rule in the form "the chord bisects the directions at its ends", of second order. `κ₁` is known only once the
//! increment is solved: the increment is solved first with the trapezoidal rule and then with the correction, which
//! gives fourth order (deferred correction: L. Fox, Proc. R. Soc. A 190 (1947) 31; V. Pereyra, Numer. Math. 8 (1966)
//! 376, doi:10.1007/BF02162981). Where a node starts to slip at zero normal reaction, the rates do not define `κ₀`; for
//! this one increment the angle is `(θ₀ + 2 θ₁)/3 - h κ₁/6 [ + h³ θ'''/72 ]`. On a curved obstacle directions are
//! transported along the geodesic.
//!
//! A node with a small normal reaction moves as the structure drives it, and the direction of its slip settles towards
//! the direction `θ*` of this motion: with the stiffness `K` across the slip
//!
//! ```text
//! κ = λ (θ* - θ),    μ r_n κ ḣ = (K ḣ + μ ṙ_n)(θ* - θ),    λ = (K ḣ + μ ṙ_n)/(μ r_n ḣ)
//! ```
//!
//! so that `z = λ h` grows without bound as the reaction vanishes. Over such an increment a rule has to be L-stable and
//! cannot take `κ₁` from a previous solve. The second rule is that of the Padé approximant (1, 2), which is L-stable
//! (E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, Springer 1996, chapter IV.3); with `κ₁` linear
//! in `θ₁` as above, the increment is solved repeatedly until the rule holds at its end. The second rule takes over as
//! `z` grows.
//!
//! Where `K ḣ + μ ṙ_n` is negative, as where friction falls faster than the load, the direction moves away from `θ*` as a
//! power of `1/r_n`, and `κ` grows without bound towards lift-off. The correction then takes no `κ₁` from a point where
//! the normal reaction is negligible against that at the start; and once the way to lift-off is shorter than the error
//! that an increment may have, the direction is that of the chord.

use crate::mechanics::contact::Frame;
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};
use crate::mechanics::equations::tolerances::{LARGEST_SETTLING, SMALLEST_TURN_DIVISOR};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};

/// The start of a slip: its direction and the obstacle's normal there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    pub direction: Vector,
    pub normal: Vector,
}

/// The turn of the direction per length of track at both ends of the increment, where known.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Turn {
    pub at_start: Option<f64>,
    pub at_end: Option<f64>,
    /// The dependence of the turn at the end on the direction there, where the normal reaction is small.
    pub settling: Option<Settling>,
    /// Whether the normal reaction vanishes so close to the start that the direction follows the motion at once.
    pub is_loose: bool,
}

/// The settling of a direction: `κ = -λ (θ - θ*)` near the direction of the last solve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settling {
    /// Angle from the direction at the start to that of the last solve.
    pub angle: f64,
    /// `z = λ h`, positive.
    pub quickness: f64,
    /// The angle `θ* - θ` at the direction of the last solve.
    pub ahead: f64,
}

/// The track's equation at an iterate.
pub(crate) struct Rule {
    /// The residual of the equation.
    pub left_over: f64,
    /// Derivative of the equation with respect to the node's motion: a tangent vector.
    pub across: Vector,
    /// Derivative of the equation with respect to the turn of the direction at the end.
    pub by_turn: f64,
    /// Derivative of the equation with respect to the turn of the direction at the start.
    pub by_first_turn: f64,
    /// The factor in the equation of the distance between the end of the chord and the track.
    pub factor: f64,
}

/// Values of `z` above which the second rule has a weight, and above which it is used alone.
const SETTLING: [f64; 2] = [2.0, 6.0];

impl Start {
    /// The direction transported along the geodesic to a point with another normal: rotated by the smallest rotation
    /// between the two normals.
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
    /// The angle (radians) between the bisector of the end directions and the chord, as the turns at the ends of a
    /// track of this length make it.
    pub fn correction(&self, length: f64) -> f64 {
        match (self.at_start, self.at_end) {
            (Some(first), Some(last)) => length * (first - last) / 12.0,
            _ => 0.0,
        }
    }

    /// Whether the direction at the end settles.
    pub fn settles(&self) -> bool {
        self.settling.is_some_and(|settling| settling.share() > 0.0)
    }

    /// The angle (radians) by which the turn at the end enters the rule, as the last solve gives it: `θ*` where the
    /// direction settles, else the turn over the whole track; `None` where the rule takes no turn at the end.
    pub fn entering(&self, chord: f64) -> Option<f64> {
        match self.settling.filter(|settling| settling.share() > 0.0) {
            Some(settling) => Some(settling.ahead + settling.share() * settling.angle),
            None => self.at_end.map(|turn| turn * chord),
        }
    }

    /// Lets another angle enter the rule.
    pub fn enter(&mut self, angle: f64, chord: f64) {
        match self.settling.as_mut().filter(|settling| settling.share() > 0.0) {
            Some(settling) => settling.ahead = angle - settling.share() * settling.angle,
            None => self.at_end = Some(angle / chord),
        }
    }

    /// The derivative of the direction at the end with respect to the angle that enters the rule, on a chord that is
    /// held.
    pub fn effect(&self) -> f64 {
        match self.settling.filter(|settling| settling.share() > 0.0) {
            Some(settling) => {
                let (share, slope) = (self.share_of_second_rule(&settling), settling.share() * settling.quickness);
                settling.quickness * Self::by_turned(share) / Self::by_last(share, slope)
            }
            None if self.at_start.is_none() => 0.25,
            None => 1.0 / 6.0,
        }
    }

    /// The weight of the second rule: without a turn at the start only that one is there.
    fn share_of_second_rule(&self, settling: &Settling) -> f64 {
        if self.at_start.is_some() { settling.share() } else { 1.0 }
    }

    /// The derivative of the angle of the chord with respect to `-h κ₁`, with a weight of the second rule.
    fn by_turned(share: f64) -> f64 {
        (1.0 - share) / 12.0 + share / 6.0
    }

    /// The derivative of the angle of the chord with respect to that of the direction at the end, where `h κ₁` has the
    /// derivative `-slope`.
    fn by_last(share: f64, slope: f64) -> f64 {
        (1.0 - share) * 0.5 + share * 2.0 / 3.0 + slope * Self::by_turned(share)
    }
}

impl Settling {
    /// The weight of the second rule in the equation.
    pub fn share(&self) -> f64 {
        ((self.quickness - SETTLING[0]) / (SETTLING[1] - SETTLING[0])).clamp(0.0, 1.0)
    }
}

impl Rule {
    /// The rule of an increment; `frame` and `direction` are those at its end, `chord` the motion relative to the
    /// obstacle.
    pub fn new(frame: &Frame, start: &Start, turn: &Turn, direction: &Vector, chord: &Vector) -> Self {
        if turn.is_loose {
            return Self::loose(frame, direction, chord);
        }
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

    /// The rule of a direction that is that of the motion, whatever it was at the start: the backward Euler method.
    fn loose(frame: &Frame, direction: &Vector, chord: &Vector) -> Self {
        let across = cross(&frame.normal, direction);
        let by_turn = -dot(direction, chord);
        Self { left_over: dot(&across, chord), across, by_turn, by_first_turn: 0.0, factor: 1.0 }
    }

    /// The rule of a direction that settles. With angles measured from the direction at the start, `φ` the angle of the
    /// chord and `h κ₁ = ω z (θ* - θ₁) + (1 - ω) (h κ₁)⁰`, the equation is `h (φ - φ_rule)/(∂φ_rule/∂θ₁) = 0`: for
    /// large `z` it becomes `θ₁ = θ*`.
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
        let share = turn.share_of_second_rule(settling);
        let quickness = settling.quickness.min(LARGEST_SETTLING);
        // `h κ₁` at the direction of the last solve is `z` times the angle `θ* - θ` there.
        let slope = settling.share() * quickness;
        let turned = quickness * settling.ahead - slope * (last - settling.angle);
        let first = (1.0 - share) * (0.5 * last + (turn.at_start.unwrap_or(0.0) * arc - turned) / 12.0);
        let second = share * (2.0 / 3.0 * last - turned / 6.0);
        let factor = 1.0 / Turn::by_last(share, slope);
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

/// The length of an arc, from its chord and the directions at its ends.
pub(crate) fn arc(chord: f64, first: &Vector, last: &Vector) -> f64 {
    let turn = size(&add(last, -1.0, first));
    chord * (1.0 + turn * turn / 24.0)
}

/// A direction rotated by an angle (radians, small) and projected into the tangent plane of a frame.
pub(crate) fn turned(frame: &Frame, direction: &Vector, angle: f64) -> Vector {
    let rotated = add(direction, angle, &cross(&frame.normal, direction));
    unit(&add(&rotated, -dot(&rotated, &frame.normal), &frame.normal))
}

/// The turn of a slip's direction per length of track, from the path's direction; `None` where the node does not move
/// or has no normal reaction.
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
    if speed <= SMALLEST_TURN_DIVISOR || pressed <= SMALLEST_TURN_DIVISOR * rate.reactions[contact].size() {
        return None;
    }
    let across = cross(&frame.normal, direction);
    let turn = -dot(&rate.reactions[contact].tangential, &across) / pressed;
    Some(turn / speed)
}

/// The settling of a direction over a chord; `None` where the node does not move, or the direction turns away from
/// `θ*`. `stiffness` is `K`.
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
    // Without a normal reaction there is no friction to give a direction.
    if speed <= SMALLEST_TURN_DIVISOR || drawn <= 0.0 || pressed <= 0.0 {
        return None;
    }
    let carried = start.carried_to(&frame.normal);
    let length = arc(chord, &carried, direction);
    let quickness = drawn * length / (pressed * speed);
    let angle = angle(&frame.normal, &carried, direction);
    Some(Settling { angle, quickness: quickness.min(LARGEST_SETTLING), ahead: turn / drawn })
}
