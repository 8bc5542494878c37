//! Whether equilibrium determines the reactions of several contacts of a node, and whether the bounds on the forces
//! that hold the node are known.

use crate::mechanics::contact::kinematics::Kinematics;
use crate::mechanics::contact::vector::{Vector, add, dot, size, unit};
use crate::mechanics::multi_contact::moving_planes::Carried;
use crate::mechanics::multi_contact::spatial::ContactGroup;
use crate::mechanics::multi_contact::tolerances::INDEPENDENCE_SINE;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::{free_directions, is_driven, is_in_plane, move_apart};
use crate::mechanics::problem::state::State;
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use itertools::Itertools;

/// Whether a node is in contact with several obstacles such that the bounds on the forces that hold it are not known:
/// where the node is driven against the obstacles or they move against each other, with friction or with more reactions
/// than equilibrium determines; and where more than the two obstacles of an edge carry a slide.
pub fn is_not_available(loading: Loading<'_>, state: &State) -> bool {
    turns_against_another(loading, state)
        || loading.corners.iter().any(|corner| {
            let closed = corner.closed(loading, state);
            let is_known = || {
                if is_in_plane(loading, corner) {
                    return !is_driven(loading, &closed) || Carried::of(loading, &closed, state).is_some();
                }
                ContactGroup::new(loading, &closed, state).is_determinate_when_sliding()
            };
            closed.len() > 1 && !are_determinate(loading, &closed, state) && !is_known()
        })
}

/// Whether a node is closed, with friction, against an obstacle that turns and another obstacle.
fn turns_against_another(loading: Loading<'_>, state: &State) -> bool {
    let structure = loading.structure;
    let is_held = |node: &usize| structure.freedoms_of(*node).all(|freedom| structure.unknown_of[freedom].is_none());
    // A single node, and nothing that moves by itself on the other side.
    let touches_rigid =
        |kinematics: &Kinematics| kinematics.own_nodes().len() == 1 && kinematics.touched_nodes().iter().all(is_held);
    if loading.contacts.iter().all(|contact| contact.kinematics.node().is_some()) {
        return false;
    }
    let closed = loading.contacts.iter().enumerate().filter(|(index, contact)| {
        touches_rigid(&contact.kinematics) && loading.gap(*index, state) <= CONTACT_TOLERANCE
    });
    let of_node = closed.map(|(_, contact)| {
        (contact.kinematics.own_nodes()[0], contact.kinematics.node().is_none(), contact.tangents() > 0)
    });
    let of_node: Vec<(usize, bool, bool)> = of_node.sorted_unstable().collect();
    of_node.chunk_by(|one, other| one.0 == other.0).any(|together| {
        together.len() > 1 && together.iter().any(|(_, turns, _)| *turns) && together.iter().any(|(.., rough)| *rough)
    })
}

/// Whether closed contacts of a node are treated one by one: equilibrium determines all their reactions, and in the
/// plane their obstacles move against each other.
pub fn stand_alone(loading: Loading<'_>, closed: &[usize], state: &State) -> bool {
    let apart = loading.structure.dimension == 3 || move_apart(loading, closed);
    apart && are_determinate(loading, closed, state)
}

/// Whether equilibrium determines the reactions of some contacts of a node: no contact has friction, and the normals,
/// projected on the free directions of the node, are independent.
pub(crate) fn are_determinate(loading: Loading<'_>, contacts: &[usize], state: &State) -> bool {
    let mut basis: Vec<Vector> = Vec::new();
    contacts.iter().all(|contact| {
        let data = &loading.contacts[*contact];
        let mut rest = loading.frame(*contact, state).normal;
        rest = free_directions(loading, *contact).iter().fold([0.0; 3], |sum, free| add(&sum, dot(free, &rest), free));
        for known in &basis {
            rest = add(&rest, -dot(&rest, known), known);
        }
        let is_independent = size(&rest) > INDEPENDENCE_SINE;
        basis.push(if is_independent { unit(&rest) } else { rest });
        data.tangents() == 0 && is_independent
    })
}
