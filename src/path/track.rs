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

use super::loading::Loading;
use super::state::{Rate, State};
use crate::contact::Frame;
use crate::contact::vector::{Vector, add, cross, dot, scaled, size, unit};

/// Where a slip starts: its direction and the obstacle's normal there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub direction: Vector,
    pub normal: Vector,
}

/// Turn of the direction per length of track at both ends of the increment, where known.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Turn {
    pub at_start: Option<f64>,
    pub at_end: Option<f64>,
}

/// The track's equation `across·chord = 0` at an iterate.
pub(super) struct Rule {
    /// Unit tangent across the chord as it should be.
    pub across: Vector,
    /// Derivative of the equation by the turn of the direction at the end.
    pub by_turn: f64,
}

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

impl Rule {
    /// `direction` is that at the end, `chord` the motion relative to the obstacle.
    pub fn new(frame: &Frame, start: &Start, turn: &Turn, direction: &Vector, chord: &Vector) -> Self {
        let carried = start.carried_to(&frame.normal);
        let bisector = unit(&add(&carried, 1.0, direction));
        let correction = match (turn.at_start, turn.at_end) {
            (Some(first), Some(last)) => arc(size(chord), &carried, direction) * (first - last) / 12.0,
            (None, Some(last)) => {
                let turned = dot(&cross(&carried, direction), &frame.normal).asin();
                (turned - arc(size(chord), &carried, direction) * last) / 6.0
            }
            (_, None) => 0.0,
        };
        let across = cross(&frame.normal, &bisector);
        let along = unit(&add(&bisector, correction, &across));
        Self { across: cross(&frame.normal, &along), by_turn: -0.5 * dot(&along, chord) }
    }
}

/// Length of the arc over a chord whose end directions differ.
pub(super) fn arc(chord: f64, first: &Vector, last: &Vector) -> f64 {
    let turn = size(&add(last, -1.0, first));
    chord * (1.0 + turn * turn / 24.0)
}

/// A direction turned by an angle (radians, small) and brought into the tangent plane of a frame.
pub(super) fn turned(frame: &Frame, direction: &Vector, angle: f64) -> Vector {
    let rotated = add(direction, angle, &cross(&frame.normal, direction));
    unit(&add(&rotated, -dot(&rotated, &frame.normal), &frame.normal))
}

/// Turn of a slip's direction per length of track, from the path's direction; `None` where the node does not move or is
/// not pressed.
pub(super) fn turn_rate(
    loading: Loading<'_>,
    contact: usize,
    state: &State,
    rate: &Rate,
    direction: &Vector,
) -> Option<f64> {
    let frame = loading.frame(contact, state);
    let speed = dot(direction, &loading.relative_rate(contact, rate));
    let pressed = loading.contacts[contact].friction * state.reactions[contact].normal;
    if speed <= SMALLEST || pressed <= SMALLEST * rate.reactions[contact].size() {
        return None;
    }
    let across = cross(&frame.normal, direction);
    let turn = -dot(&rate.reactions[contact].tangential, &across) / pressed;
    Some(turn / speed)
}

/// The direction that opposes a traction; `otherwise` where there is none.
pub(super) fn direction_of(traction: &Vector, otherwise: &Vector) -> Vector {
    let length = size(traction);
    if length > 0.0 { scaled(traction, -1.0 / length) } else { *otherwise }
}
