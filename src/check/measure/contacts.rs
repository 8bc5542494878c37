//! Checks a contact by the laws of contact and friction.

use crate::check::measure::errors::{Errors, worse};
use crate::check::measure::global::largest_or_nan;
use crate::check::measure::numbers::{MeasuredVector, angle, padded};
use crate::check::measure::obstacles::MeasuredFrame;
use crate::result::increment::{ContactState, Status};

/// A traction within this fraction of `μ r_n` of the friction cone counts as on the cone.
const ON_THE_CONE: f64 = 1e-6;

/// A contact at the end of an increment.
pub(super) struct Seen<'a> {
    pub state: &'a ContactState,
    pub frame: &'a MeasuredFrame,
    pub friction: f64,
    /// Motion of the node relative to the obstacle during the increment (length).
    pub motion: MeasuredVector,
    /// `-r_t/|r_t|` in space at the start of the increment, if the contact was on the friction cone there; in 3D only.
    pub direction_before: Option<MeasuredVector>,
    /// `slip_total` of the increment before.
    pub slipped_before: [f64; 2],
    pub dimension: usize,
    /// The increment is a motion under inertia or damping: its chord says nothing of friction on the way.
    pub is_motion: bool,
    /// The force on the node, or on its surface where bodies touch.
    pub force: MeasuredVector,
}

impl Seen<'_> {
    /// Adds the errors of the contact to `errors`. In 3D, returns the direction of slip at the end of the increment if
    /// the contact is on the friction cone. `length` and `force` make lengths and forces dimensionless.
    pub fn judge(&self, length: f64, force: f64, errors: &mut Errors) -> Option<MeasuredVector> {
        let Self { state, frame, friction, .. } = *self;
        let beyond_rounding =
            |error: f64| if error.abs() <= frame.rounding { 0.0 } else { (error.abs() - frame.rounding) / length };
        let tangents = self.dimension - 1;
        if state.tangential_reaction.len() != tangents
            || state.slip.len() != tangents
            || !matches_length(&state.slip_total, tangents)
            || !matches_length(&state.reaction, self.dimension)
        {
            errors.reported = f64::MAX;
            return None;
        }
        let pair = |values: &[f64]| [values[0], values.get(1).copied().unwrap_or(0.0)];
        let normal = state.normal_reaction / force;
        let traction = pair(&state.tangential_reaction).map(|value| value / force);
        let size = traction[0].hypot(traction[1]);
        let radius = friction * normal;

        // A comparison, since `min` ignores NaN.
        let apart = state.gap / length;
        errors.contact = worse(errors.contact, if normal < apart { normal.abs() } else { apart.abs() });
        errors.contact = worse(errors.contact, if normal.is_nan() { normal } else { 0.0 });
        errors.cone = worse(errors.cone, size - radius);

        let slip = frame.along(&self.motion);
        let distance = slip[0].hypot(slip[1]);
        // A motion within the rounding error of the coordinates has no direction.
        let moves = distance > frame.rounding;
        let slipped = beyond_rounding(distance);
        let on_the_cone = size > 0.0 && size >= (1.0 - ON_THE_CONE) * radius;
        let shrunk = if moves { slipped / distance } else { 0.0 };
        let slip_scaled = slip.map(|value| value * shrunk);
        let off = self.off_friction(traction, slip_scaled, radius, on_the_cone);
        errors.friction = worse(errors.friction, off.abs());

        errors.reported = worse(errors.reported, beyond_rounding(state.gap - frame.gap));
        let moved_closed = if state.status == Status::Free { [0.0; 2] } else { slip };
        let reported = pair(&state.slip);
        for k in 0..tangents {
            errors.reported = worse(errors.reported, beyond_rounding(reported[k] - moved_closed[k]));
        }
        if !state.slip_total.is_empty() {
            let total = pair(&state.slip_total);
            for k in 0..tangents {
                let sum = self.slipped_before[k] + reported[k];
                errors.reported = worse(errors.reported, (total[k] - sum).abs() / length.max(sum.abs()));
            }
        }
        if !state.reaction.is_empty() {
            let off = padded(&state.reaction) - self.force;
            errors.reported = worse(errors.reported, largest_or_nan(&off) / force);
        }
        let of_status = match state.status {
            Status::Free => size.max(normal.abs()),
            Status::Stick | Status::Slip if self.is_motion => 0.0,
            Status::Stick => slipped,
            Status::Slip if friction > 0.0 && moves => (size - radius).abs(),
            Status::Slip => 0.0,
        };
        errors.reported = worse(errors.reported, of_status);

        if !(self.dimension == 3 && friction > 0.0 && on_the_cone) {
            return None;
        }
        let direction = frame.in_space(traction) * (-1.0 / size);
        if let (Status::Slip, true, Some(before), false) = (state.status, moves, self.direction_before, self.is_motion)
        {
            errors.slip_direction = worse(errors.slip_direction, angle(&self.motion, &(before + direction)));
        }
        Some(direction)
    }

    /// The error of Coulomb's law between a traction and a slip, both dimensionless.
    fn off_friction(&self, traction: [f64; 2], slip: [f64; 2], radius: f64, on_the_cone: bool) -> f64 {
        let (size, bound) = (traction[0].hypot(traction[1]), radius.max(0.0));
        if self.is_motion {
            return (size - bound).max(0.0);
        }
        if !on_the_cone {
            return natural_map(traction, slip, bound);
        }
        // Only the slip along the traction counts; on a curved path, `slip_direction` measures the slip across the
        // traction.
        let against = -(traction[0] * slip[0] + traction[1] * slip[1]) / size;
        size - (size + against).clamp(-bound, bound)
    }
}

/// Whether a figure that an increment may lack has its length.
fn matches_length(values: &[f64], length: usize) -> bool {
    values.is_empty() || values.len() == length
}

/// `|t - P(t - x)|`, where `P` is the projection onto the disc of the given radius.
fn natural_map(traction: [f64; 2], slip: [f64; 2], radius: f64) -> f64 {
    let moved = [traction[0] - slip[0], traction[1] - slip[1]];
    let size = moved[0].hypot(moved[1]);
    let factor = if size > radius { radius / size } else { 1.0 };
    (traction[0] - factor * moved[0]).hypot(traction[1] - factor * moved[1])
}

/// The sum of the slips up to an increment in which the contact slips.
pub(super) fn slipped(state: &ContactState) -> Option<[f64; 2]> {
    let component = |k: usize| state.slip_total.get(k).copied().unwrap_or(0.0);
    state.slip.iter().any(|slip| *slip != 0.0).then(|| [component(0), component(1)])
}

/// The total force of an obstacle on its node.
pub(super) fn force(state: &ContactState, frame: &MeasuredFrame) -> MeasuredVector {
    let component = |k: usize| state.tangential_reaction.get(k).copied().unwrap_or(0.0);
    frame.in_space([component(0), component(1)]) + frame.normal * state.normal_reaction
}
