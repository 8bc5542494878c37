//! The status of the contacts at a point: which contacts can change their mode, and to which modes.

use crate::mechanics::contact::vector::{Vector, direction_of, dot, scaled, size};
use crate::mechanics::contact::{Mode, Sliding};
use crate::mechanics::multi_contact::moving_planes::Carried;
use crate::mechanics::multi_contact::spatial::ContactGroup;
use crate::mechanics::multi_contact::spatial::cone_sum;
use crate::mechanics::multi_contact::tolerances::{CONE_ROUNDING, LARGEST_ROUNDING_OF_BOUND};
use crate::mechanics::multi_contact::{determinacy, planar};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces;
use crate::mechanics::problem::state::State;
use crate::mechanics::problem::tolerances::{CONTACT_TOLERANCE, LARGEST_ROUNDING_OF_FORCE};

/// The status of a contact at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Standing {
    /// Strictly within its mode: no other mode is possible nearby.
    Settled(Mode),
    /// Closed, with the traction on the friction cone: the contact sticks, or slips along `direction`.
    OnCone { direction: Vector },
    /// At zero gap with zero reaction: every mode is possible.
    Touching,
    /// One of several closed contacts of a node whose total force is zero or on a bound of the forces that hold the
    /// node: the node may slide along one of the obstacles or leave.
    Cornered {
        /// In the plane: on which of the two bounds the force lies.
        facets: [bool; 2],
        unloaded: bool,
        /// Forces up to this size count as zero.
        zero: f64,
    },
}

/// The distance from the friction cone of a contact that counts as zero, for a relative tolerance: relative to the
/// friction bound `μ r_n` itself, but at least round-off, and at most relative to the forces at the node. An event is
/// located within the round-off of stiff elements, too, which counts as far as it is small against the bound.
pub fn none_from_cone(loading: Loading<'_>, contact: usize, state: &State, tolerance: f64, force_scale: f64) -> f64 {
    let reaction = &state.reactions[contact];
    let bound = loading.contacts[contact].friction.bound(reaction.normal).abs();
    // The forces at the node lie between the reaction and the force scale, which often decides.
    let least = reaction.size().min(force_scale);
    if bound <= least && tolerance * bound >= LARGEST_ROUNDING_OF_FORCE * force_scale {
        return tolerance * bound;
    }
    let forces = loading.force_scale_at(contact, state, force_scale);
    let most = (LARGEST_ROUNDING_OF_FORCE * forces).min(LARGEST_ROUNDING_OF_BOUND * bound);
    let of_stiff_elements = loading.rounding_of_force(contact, state).min(most);
    (tolerance * bound.min(forces)).max(CONE_ROUNDING * forces).max(of_stiff_elements)
}

/// The status of every contact.
pub fn standings(loading: Loading<'_>, state: &State, force_scale: f64) -> Vec<Standing> {
    let mut standings: Vec<Standing> =
        (0..loading.contacts.len()).map(|contact| standing(loading, state, contact, force_scale)).collect();
    for corner in loading.corners {
        let closed = corner.closed(loading, state);
        if closed.len() > 1 && !determinacy::stand_alone(loading, &closed, state) {
            let together = if node_contact_forces::is_in_plane(loading, corner) {
                standing_of_corner(loading, state, &closed, force_scale)
            } else {
                standing_in_group(loading, state, &closed, force_scale)
            };
            closed.iter().for_each(|contact| standings[*contact] = together);
        }
    }
    standings
}

fn standing_in_group(loading: Loading<'_>, state: &State, closed: &[usize], force_scale: f64) -> Standing {
    let group = ContactGroup::new(loading, closed, state);
    let force = group.force(loading, state);
    let zero = CONTACT_TOLERANCE * force_scale;
    let unloaded = size(&force) <= zero;
    if unloaded
        || group.is_driven
        || !group.ready(&force, zero).is_empty()
        || cone_sum::is_at_bound(&group, &force, zero)
    {
        Standing::Cornered { facets: [true; 2], unloaded, zero }
    } else {
        Standing::Settled(Mode::Stick)
    }
}

fn standing_of_corner(loading: Loading<'_>, state: &State, closed: &[usize], force_scale: f64) -> Standing {
    let force = node_contact_forces::total_force(loading, closed.iter().copied(), state);
    let scale_at = |contact: &usize| loading.force_scale_at(*contact, state, force_scale);
    let zero = CONTACT_TOLERANCE * closed.iter().map(scale_at).fold(0.0, f64::max);
    let unloaded = size(&force) <= zero;
    if Carried::of(loading, closed, state).is_some() {
        return Standing::Cornered { facets: [true; 2], unloaded, zero };
    }
    let inward = planar::sector(loading, closed, |_| Mode::Stick, state).inward;
    let facets = inward.map_or([false; 2], |inward| inward.map(|inward| dot(&inward, &force) <= zero));
    if unloaded || facets != [false; 2] {
        Standing::Cornered { facets, unloaded, zero }
    } else {
        Standing::Settled(Mode::Stick)
    }
}

fn standing(loading: Loading<'_>, state: &State, index: usize, force_scale: f64) -> Standing {
    let (contact, reaction) = (&loading.contacts[index], &state.reactions[index]);
    if reaction.normal <= 0.0 || loading.is_no_force(index, state, reaction.normal, CONTACT_TOLERANCE, force_scale) {
        return if loading.gap(index, state) <= CONTACT_TOLERANCE {
            Standing::Touching
        } else {
            Standing::Settled(Mode::Free)
        };
    }
    if contact.tangents() == 0 {
        return Standing::Settled(Mode::Slip { direction: [0.0; 3] });
    }
    let bound = contact.friction.bound(reaction.normal);
    // The largest force of the path often decides.
    let distance = bound - reaction.tangential_size();
    if distance > CONTACT_TOLERANCE * force_scale
        || distance > none_from_cone(loading, index, state, CONTACT_TOLERANCE, force_scale)
    {
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
