//! Which contacts could change at a point, and between what.

use super::state::State;
use crate::contact::{Contact, Mode, Tangential};
use crate::structure::Structure;

/// How a contact stands at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Standing {
    /// Strictly inside its mode: that mode is the only one near by.
    Settled(Mode),
    /// Pressed, with the traction on the cone: it sticks, or slips along `direction`.
    OnCone { direction: Tangential },
    /// At zero gap with zero reaction: anything may follow.
    Touching,
}

/// A gap (dimensionless) or a reaction (over the force scale) of this size is zero.
pub const ZERO: f64 = 1e-10;

/// Standing of every contact.
pub fn standings(structure: &Structure, contacts: &[Contact], state: &State, force_scale: f64) -> Vec<Standing> {
    contacts
        .iter()
        .enumerate()
        .map(|(index, contact)| standing(structure, contact, state, index, force_scale))
        .collect()
}

fn standing(structure: &Structure, contact: &Contact, state: &State, index: usize, force_scale: f64) -> Standing {
    let reaction = &state.reactions[index];
    let zero = ZERO * force_scale;
    if reaction.normal <= zero {
        return if contact.gap(structure.dimension, &state.displacement) <= ZERO {
            Standing::Touching
        } else {
            Standing::Settled(Mode::Free)
        };
    }
    if contact.friction == 0.0 {
        return Standing::Settled(Mode::Slip { direction: [0.0; 2] });
    }
    let size = reaction.tangential_size();
    if contact.friction * reaction.normal - size > zero {
        return Standing::Settled(Mode::Stick);
    }
    Standing::OnCone { direction: [-reaction.tangential[0] / size, -reaction.tangential[1] / size] }
}
