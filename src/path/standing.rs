//! Which contacts could change at a point, and between what.

use super::loading::Loading;
use super::state::State;
use super::track::direction_of;
use crate::contact::vector::{Vector, dot, scaled};
use crate::contact::{Mode, Sliding};

/// How a contact stands at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Standing {
    /// Strictly inside its mode: that mode is the only one near by.
    Settled(Mode),
    /// Pressed, with the traction on the cone: it sticks, or slips along `direction`.
    OnCone { direction: Vector },
    /// At zero gap with zero reaction: anything may follow.
    Touching,
}

/// A gap (dimensionless) or a reaction (over the force scale) of this size is zero.
pub const ZERO: f64 = 1e-10;

/// Standing of every contact.
pub fn standings(loading: Loading<'_>, state: &State, force_scale: f64) -> Vec<Standing> {
    (0..loading.contacts.len()).map(|contact| standing(loading, state, contact, force_scale)).collect()
}

fn standing(loading: Loading<'_>, state: &State, index: usize, force_scale: f64) -> Standing {
    let (contact, reaction) = (&loading.contacts[index], &state.reactions[index]);
    let zero = ZERO * force_scale;
    if reaction.normal <= zero {
        return if loading.gap(index, state) <= ZERO { Standing::Touching } else { Standing::Settled(Mode::Free) };
    }
    if contact.tangents() == 0 {
        return Standing::Settled(Mode::Slip { direction: [0.0; 3] });
    }
    if contact.friction * reaction.normal - reaction.tangential_size() > zero {
        return Standing::Settled(Mode::Stick);
    }
    let direction = match contact.sliding {
        Sliding::Plane => direction_of(&reaction.tangential, &[0.0; 3]),
        Sliding::None | Sliding::Line { .. } => {
            let tangent = loading.frame(index, state).tangents[0];
            scaled(&tangent, if dot(&tangent, &reaction.tangential) > 0.0 { -1.0 } else { 1.0 })
        }
    };
    Standing::OnCone { direction }
}
