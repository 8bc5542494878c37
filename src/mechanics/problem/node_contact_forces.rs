//! The forces of all contacts on one node, and the directions in which the node is free.

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::vector::{Vector, add, scaled, size};
use crate::mechanics::contact::{Frame, Mode, Reaction, Sliding};
use crate::mechanics::problem::contact_jacobian::{self, AXES};
use crate::mechanics::problem::equilibrium;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::{CONTACT_TOLERANCE, OPPOSITE_RAY_ANGLE};
use crate::mechanics::problem::work_and_dissipation::Placed;

/// A node with several contacts.
#[derive(Debug, Clone)]
pub struct Corner {
    pub contacts: Vec<usize>,
}

impl Corner {
    /// The contacts without a gap.
    pub fn closed(&self, loading: Loading<'_>, state: &State) -> Vec<usize> {
        self.contacts.iter().copied().filter(|contact| loading.gap(*contact, state) <= CONTACT_TOLERANCE).collect()
    }

    /// The contacts that hold the node together in these modes, the sticking ones first; none where fewer than two are
    /// active or none sticks. A node that sticks to one obstacle may be carried along others, against which it slips.
    pub fn holding<'a>(&'a self, modes: &'a [Mode]) -> impl Iterator<Item = usize> + 'a {
        let sticks = move |contact: &&usize| modes[**contact] == Mode::Stick;
        let slips = move |contact: &&usize| matches!(modes[**contact], Mode::Slip { .. });
        let active = self.contacts.iter().filter(|contact| modes[**contact].is_active()).count();
        let together = active >= 2 && self.contacts.iter().any(|contact| sticks(&contact));
        let sticking = self.contacts.iter().filter(move |contact| together && sticks(contact));
        sticking.chain(self.contacts.iter().filter(move |contact| together && slips(contact))).copied()
    }
}

/// Whether a node is free in the plane, so that the sum of its friction cones is a sector.
pub fn is_in_plane(loading: Loading<'_>, corner: &Corner) -> bool {
    loading.structure.dimension == 2
        && corner.contacts.iter().all(|contact| loading.contacts[*contact].sliding != Sliding::None)
}

/// Whether the current stage drives a node against closed obstacles by its supports, or the obstacles against each
/// other.
pub fn is_driven(loading: Loading<'_>, closed: &[usize]) -> bool {
    let shift = &loading.pattern.shifts[closed[0]];
    let by_support = |node: &usize| {
        let mut freedoms = loading.structure.translations_of(*node).zip(shift);
        freedoms.any(|(freedom, shift)| {
            loading.structure.unknown_of[freedom].is_none() && loading.support_rate(freedom) != *shift
        })
    };
    move_apart(loading, closed) || loading.contacts[closed[0]].kinematics.nodes().iter().any(by_support)
}

/// Whether the current stage moves the obstacles of some contacts against each other.
pub(crate) fn move_apart(loading: Loading<'_>, contacts: &[usize]) -> bool {
    let shifts = &loading.pattern.shifts;
    contacts.iter().skip(1).any(|other| shifts[contacts[0]] != shifts[*other])
}

/// The total force of an obstacle on its node.
pub fn force(frame: &Frame, reaction: &Reaction) -> Vector {
    add(&reaction.tangential, reaction.normal, &frame.normal)
}

/// Writes the out-of-balance force `f_int - s p - h - Σ Bᵀ r` over all degrees of freedom: zero along free ones in
/// equilibrium, and the force of the supports along the others.
pub fn write_out_of_balance(loading: Loading<'_>, state: &State, out_of_balance: &mut [f64]) {
    equilibrium::write_unbalanced(loading, state, out_of_balance);
    for (contact, reaction) in state.reactions.iter().enumerate().filter(|(_, reaction)| reaction.size() > 0.0) {
        let on_node = force(&loading.frame(contact, state), reaction);
        let pair = &loading.contacts[contact];
        contact_jacobian::add_force(loading.structure, pair, &state.displacement, &on_node, -1.0, out_of_balance);
    }
}

/// The rates of the forces of the contacts on their nodes; for a node with several contacts the first of them has the
/// sum, since the shares of the contacts do not affect the motion.
pub fn whole_rates(loading: Loading<'_>, state: &State, rate: &Rate) -> Vec<Vector> {
    let mut rates: Vec<Vector> =
        (0..loading.contacts.len()).map(|contact| reaction_in_space(loading, contact, (state, rate)).1).collect();
    for corner in loading.corners {
        if let [first, others @ ..] = &corner.contacts[..] {
            for other in others {
                let part = std::mem::take(&mut rates[*other]);
                rates[*first] = add(&rates[*first], 1.0, &part);
            }
        }
    }
    rates
}

/// Sum of the forces of some contacts on their node.
pub fn total_force(loading: Loading<'_>, contacts: impl Iterator<Item = usize>, state: &State) -> Vector {
    contacts.fold([0.0; 3], |sum, contact| {
        add(&sum, 1.0, &force(&loading.frame(contact, state), &state.reactions[contact]))
    })
}

/// The normal and tangential parts of a force in the cone of a contact. For a large coefficient of friction the normal
/// part may be lost in the rounding of the force; it then follows from the tangential part and the cone.
pub fn taken_apart(force: &Vector, frame: &Frame, friction: CoulombFriction) -> Reaction {
    if !friction.is_rough() {
        return Reaction::along(force, &frame.normal);
    }
    let Reaction { normal, tangential } = Reaction::of(force, &frame.normal);
    // Slightly larger, so that the reaction is within the cone in spite of rounding, however large the force.
    let least = size(&tangential) / friction.coefficient * (1.0 + 4.0 * f64::EPSILON);
    let is_round_off = least - normal <= OPPOSITE_RAY_ANGLE * size(force);
    Reaction { normal: if is_round_off { normal.max(least) } else { normal }, tangential }
}

/// The total force of an obstacle on its node, and its derivative by arc length.
pub fn reaction_in_space(loading: Loading<'_>, contact: usize, at: Placed<'_>) -> (Vector, Vector) {
    let (reaction, change) = (&at.0.reactions[contact], &at.1.reactions[contact]);
    if *reaction == Default::default() && *change == Default::default() {
        return Default::default();
    }
    let frame = loading.frame(contact, at.0);
    let turn = frame.normal_change(&loading.relative_rate(contact, at.0, at.1));
    let force = add(&reaction.tangential, reaction.normal, &frame.normal);
    let rate = add(&add(&change.tangential, change.normal, &frame.normal), 1.0, &scaled(&turn, reaction.normal));
    (force, rate)
}

/// Orthonormal directions in which a contact is free to move: where several nodes move the contact, in the axes of the
/// contact, all but those that supports take from surfaces in space.
pub fn free_directions(loading: Loading<'_>, contact: usize) -> Vec<Vector> {
    let structure = loading.structure;
    let axes = &AXES[..structure.dimension];
    match loading.contacts[contact].kinematics.node() {
        Some(node) => {
            let unknowns = &structure.unknown_of[structure.translations_of(node)];
            axes.iter().zip(unknowns).filter(|(_, unknown)| unknown.is_some()).map(|(axis, _)| *axis).collect()
        }
        None => {
            let pair = &loading.contacts[contact];
            let frame = pair.frame(&[0.0; 3]);
            match pair.sliding {
                Sliding::None | Sliding::Line { .. } if structure.dimension == 3 => {
                    std::iter::once(frame.normal).chain(frame.tangents).take(1 + pair.sliding.directions()).collect()
                }
                _ => axes.to_vec(),
            }
        }
    }
}
