//! What is watched along a mode: quantities that must not become negative while the mode lasts, and ends of the stage.
//!
//! ```text
//! free: g         stick: μ r_n ± r_t         slip: r_n and d·ẋ_t         the load rate's sign         bounds of a stage
//! ```
//!
//! Between two points each quantity is also followed by its cubic Hermite interpolant, so that a dip inside the step
//! is seen.

use super::mode_system::Loading;
use super::scene::End;
use super::state::{Rate, State, along};
use crate::contact::Mode;

/// A quantity that is watched; negative means that it was passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Watch {
    Gap(usize),
    Normal(usize),
    Cone { contact: usize, side: f64 },
    Sliding(usize),
    LoadRate { sign: f64 },
    End(End),
}

/// Everything that ends a mode.
pub fn of_mode(loading: Loading<'_>, modes: &[Mode]) -> Vec<Watch> {
    let mut watches = Vec::new();
    for (contact, mode) in modes.iter().enumerate() {
        match mode {
            Mode::Free => watches.push(Watch::Gap(contact)),
            Mode::Stick => watches.extend([1.0, -1.0].map(|side| Watch::Cone { contact, side })),
            Mode::Slip { .. } => {
                watches.push(Watch::Normal(contact));
                if loading.contacts[contact].friction > 0.0 {
                    watches.push(Watch::Sliding(contact));
                }
            }
        }
    }
    watches
}

impl Watch {
    /// Whether a contact's mode ends where the quantity is zero.
    pub fn is_of_contact(self) -> bool {
        match self {
            Self::Gap(_) | Self::Normal(_) | Self::Cone { .. } | Self::Sliding(_) => true,
            Self::LoadRate { .. } | Self::End(_) => false,
        }
    }

    /// The quantity at a point with its direction.
    pub fn value(self, loading: Loading<'_>, modes: &[Mode], state: &State, rate: &Rate) -> f64 {
        let structure = loading.structure;
        match self {
            Self::Gap(contact) => {
                let contact = &loading.contacts[contact];
                contact.gap(structure.dimension, &state.displacement)
            }
            Self::Normal(contact) => state.reactions[contact].normal,
            Self::Cone { contact, side } => {
                let reaction = &state.reactions[contact];
                loading.contacts[contact].friction * reaction.normal + side * reaction.tangential[0]
            }
            Self::Sliding(contact) => self.sliding(loading, modes, contact, &rate.displacement),
            Self::LoadRate { sign } => sign * rate.load,
            Self::End(End::Load { bound, sign }) => sign * (bound - state.load),
            Self::End(End::Displacement { freedom, bound, sign }) => sign * (bound - state.displacement[freedom]),
            Self::End(End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_)) => f64::INFINITY,
        }
    }

    fn sliding(self, loading: Loading<'_>, modes: &[Mode], contact: usize, motion: &[f64]) -> f64 {
        let Mode::Slip { direction } = modes[contact] else { return 0.0 };
        let dimension = loading.structure.dimension;
        let contact = &loading.contacts[contact];
        let first = contact.node * dimension;
        let tangents = contact.obstacle.tangents(dimension);
        let node = &motion[first..first + dimension];
        direction[0] * along(node, &tangents[0]) + direction[1] * along(node, &tangents[1])
    }

    /// Derivative by arc length; `None` for quantities that are themselves rates.
    pub fn slope(self, loading: Loading<'_>, rate: &Rate) -> Option<f64> {
        match self {
            Self::Gap(contact) => {
                let contact = &loading.contacts[contact];
                let dimension = loading.structure.dimension;
                let first = contact.node * dimension;
                Some(along(&rate.displacement[first..first + dimension], &contact.obstacle.normal()))
            }
            Self::Normal(contact) => Some(rate.reactions[contact].normal),
            Self::Cone { contact, side } => {
                let reaction = &rate.reactions[contact];
                Some(loading.contacts[contact].friction * reaction.normal + side * reaction.tangential[0])
            }
            Self::Sliding(_) | Self::LoadRate { .. } => None,
            Self::End(End::Load { sign, .. }) => Some(-sign * rate.load),
            Self::End(End::Displacement { freedom, sign, .. }) => Some(-sign * rate.displacement[freedom]),
            Self::End(End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_)) => None,
        }
    }

    /// What a rate is the rate of: `s`, or the tangential position.
    fn primitive(self, loading: Loading<'_>, modes: &[Mode], state: &State) -> Option<f64> {
        match self {
            Self::Sliding(contact) => Some(self.sliding(loading, modes, contact, &state.displacement)),
            Self::LoadRate { sign } => Some(sign * state.load),
            Self::Gap(_) | Self::Normal(_) | Self::Cone { .. } | Self::End(_) => None,
        }
    }

    /// The size against which the quantity is zero.
    pub fn scale(self, force_scale: f64) -> f64 {
        match self {
            Self::Normal(_) | Self::Cone { .. } => force_scale,
            Self::Gap(_) | Self::Sliding(_) | Self::LoadRate { .. } | Self::End(_) => 1.0,
        }
    }

    /// A place inside `(0, step)` where the Hermite interpolant of the quantity is least, if that is below `-zero`.
    pub fn dip(
        self,
        loading: Loading<'_>,
        modes: &[Mode],
        start: (&State, &Rate),
        end: (&State, &Rate),
        step: f64,
        zero: f64,
    ) -> Option<f64> {
        let (first, last) = (self.value(loading, modes, start.0, start.1), self.value(loading, modes, end.0, end.1));
        if let (Some(first_slope), Some(last_slope)) = (self.slope(loading, start.1), self.slope(loading, end.1)) {
            return dip_of_cubic(first, first_slope * step, last, last_slope * step, zero).map(|place| place * step);
        }
        let from = self.primitive(loading, modes, start.0)?;
        let to = self.primitive(loading, modes, end.0)?;
        dip_of_slope((to - from) / step, first, last, zero).map(|place| place * step)
    }
}

/// Where on `(0, 1)` the cubic with these end values and slopes has a minimum below `-zero`.
fn dip_of_cubic(first: f64, first_slope: f64, last: f64, last_slope: f64, zero: f64) -> Option<f64> {
    if first_slope >= 0.0 || last_slope <= 0.0 {
        return None;
    }
    // p(x) = first + first_slope x + b x² + a x³
    let a = 2.0 * (first - last) + first_slope + last_slope;
    let b = 3.0 * (last - first) - 2.0 * first_slope - last_slope;
    let root = (b * b - 3.0 * a * first_slope).max(0.0).sqrt();
    let place = if b > 0.0 { -first_slope / (b + root) } else { (root - b) / (3.0 * a) };
    let value = first + place * (first_slope + place * (b + place * a));
    (place > 0.0 && place < 1.0 && value < -zero).then_some(place)
}

/// Where on `(0, 1)` the quadratic with these end values and this mean is least, if below `-zero` there.
fn dip_of_slope(mean: f64, first: f64, last: f64, zero: f64) -> Option<f64> {
    // q(x) = first + b x + a x²
    let a = 3.0 * (first + last - 2.0 * mean);
    let b = 6.0 * mean - 4.0 * first - 2.0 * last;
    if a <= 0.0 {
        return None;
    }
    let place = -b / (2.0 * a);
    let value = first - b * b / (4.0 * a);
    (place > 0.0 && place < 1.0 && value < -zero).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::{dip_of_cubic, dip_of_slope};

    #[test]
    fn a_dip_between_two_positive_ends_is_seen() {
        // (x - 0.4)(x - 0.6) has its least value at 0.5.
        let place = dip_of_cubic(0.24, -1.0, 0.24, 1.0, 0.0).unwrap();
        assert!((place - 0.5).abs() < 1e-12);
        assert!(dip_of_cubic(0.3, -1.0, 0.3, 1.0, 0.0).is_none());
        let mean = 1.0 / 3.0 - 0.5 + 0.24;
        assert!((dip_of_slope(mean, 0.24, 0.24, 0.0).unwrap() - 0.5).abs() < 1e-12);
    }
}
