//! The residual of the equations, and states that satisfy exactly the equations for which this is possible.

use crate::mechanics::contact::Reaction;
use crate::mechanics::contact::vector::{add, dot, scaled};
use crate::mechanics::equations::tolerances::GAP_ROUNDING;
use crate::mechanics::equations::{Iterate, ModeSystem, Role, Track, slip_integration};
use crate::mechanics::problem::equilibrium;
use crate::mechanics::problem::state::State;
use crate::mechanics::problem::tolerances::CONTACT_TOLERANCE;
use nalgebra::DVector;

/// Writes the residuals of equilibrium and contact; returns the largest equilibrium residual and the force scale.
pub(crate) fn write_residual(
    system: &ModeSystem<'_>,
    iterate: &Iterate,
    values: &mut DVector<f64>,
    force: &mut [f64],
) -> (f64, f64) {
    let structure = system.loading.structure;
    let state = &iterate.state;
    let sizes = equilibrium::write_unbalanced(system.loading, state, force);
    let mut scale = sizes.carried.max(sizes.applied).max(sizes.internal);
    values.fill(0.0);
    for (contact, role) in system.roles.iter().enumerate() {
        if matches!(role, Role::Free) {
            continue;
        }
        let reaction = &state.reactions[contact];
        scale = scale.max(reaction.size());
        let frame = system.loading.frame(contact, state);
        let whole = add(&reaction.tangential, reaction.normal, &frame.normal);
        system.loading.each_column(contact, state, |freedom, column| force[freedom] -= dot(column, &whole));
        let row = system.row_of(contact);
        match role {
            // A sticking node is placed exactly: see `place_exactly`.
            Role::Stick if system.loading.contacts[contact].kinematics.node().is_none() => {
                let chord = system.chord(contact, state);
                for (k, direction) in system.held_directions(contact).iter().enumerate() {
                    values[row + k] = dot(direction, &chord);
                }
            }
            Role::Free | Role::Stick | Role::Held | Role::HeldBy => {}
            Role::Frictionless | Role::Line { .. } | Role::Edge { .. } => {
                values[row] = frame.gap - left_open(system, contact);
            }
            Role::Plane { track } => {
                let Track { start, turn } = &system.tracks[*track];
                values[row] = frame.gap - left_open(system, contact);
                let chord = system.chord(contact, state);
                let rule = slip_integration::Rule::new(&frame, start, turn, &iterate.directions[contact], &chord);
                values[row + 1] = rule.left_over;
            }
        }
    }
    let mut largest = 0.0_f64;
    for (value, freedom) in values.as_mut_slice().iter_mut().zip(&structure.freedom_of) {
        *value = force[*freedom];
        largest = largest.max(value.abs());
    }
    (largest, scale)
}

/// Turns the residual of equilibrium, where forces in elements are variables of the iteration, into that of the mixed
/// form, from which the correction follows. `force` is work memory over all degrees of freedom.
pub(crate) fn make_mixed(system: &ModeSystem<'_>, iterate: &Iterate, values: &mut DVector<f64>, force: &mut [f64]) {
    let Some(forces) = &iterate.forces else { return };
    let structure = system.loading.structure;
    force.fill(0.0);
    forces.add_to_residual(structure, &iterate.state.displacement, force);
    values.iter_mut().zip(&structure.freedom_of).for_each(|(value, freedom)| *value += force[*freedom]);
}

/// The gap that a contact keeps after it has closed at a gap that counts as zero: where several contacts close at
/// almost one point, the path then continues without a jump, however short the way to the next closing is.
fn left_open(system: &ModeSystem<'_>, contact: usize) -> f64 {
    let gap = system.loading.gap(contact, system.anchor);
    if gap > GAP_ROUNDING && gap <= CONTACT_TOLERANCE { gap } else { 0.0 }
}

/// Puts supports and sticking nodes exactly into their positions.
pub(super) fn place_exactly(system: &ModeSystem<'_>, state: &mut State) {
    system.loading.place_supports(state);
    let structure = system.loading.structure;
    for (contact, role) in system.roles.iter().enumerate() {
        let Some(node) = system.loading.contacts[contact].kinematics.node() else { continue };
        if !matches!(role, Role::Stick | Role::Held) || !holds_node(system, contact, node) {
            continue;
        }
        let shift = scaled(&system.loading.pattern.shifts[contact], state.load_beyond(system.anchor));
        for (freedom, shift) in structure.translations_of(node).zip(shift) {
            if structure.unknown_of[freedom].is_some() {
                let kept = system.anchor.remainder.get(freedom).copied().unwrap_or(0.0);
                state.place(freedom, system.anchor.displacement[freedom], kept + shift);
            }
        }
    }
}

/// Whether sticking leaves the node no motion at all.
fn holds_node(system: &ModeSystem<'_>, contact: usize, node: usize) -> bool {
    let structure = system.loading.structure;
    let free = structure.translations_of(node).filter(|freedom| structure.unknown_of[*freedom].is_some());
    system.held_directions(contact).len() >= free.count()
}

/// Makes complementarity exact: no reaction on a free contact, no motion of a sticking node, friction of a slipping
/// contact on its cone.
pub(crate) fn make_consistent(system: &ModeSystem<'_>, iterate: &mut Iterate) {
    place_exactly(system, &mut iterate.state);
    for (contact, role) in system.roles.iter().enumerate() {
        match role {
            Role::Free => iterate.state.reactions[contact] = Reaction::default(),
            Role::Stick | Role::Held | Role::HeldBy => {}
            Role::Frictionless => iterate.state.reactions[contact].tangential = [0.0; 3],
            Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                let frame = system.loading.frame(contact, &iterate.state);
                let direction = system.direction(contact, &frame, iterate);
                let friction = system.loading.contacts[contact].friction;
                let reaction = &mut iterate.state.reactions[contact];
                reaction.tangential = friction.traction(reaction.normal, &direction);
            }
        }
    }
}
