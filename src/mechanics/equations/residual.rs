//! The residual of the equations, and states that satisfy exactly the equations for which this is possible.

use crate::mechanics::contact::Reaction;
use crate::mechanics::contact::vector::{add, dot, scaled};
use crate::mechanics::equations::{Iterate, ModeSystem, Role, Track, slip_integration};
use crate::mechanics::problem::natural_residual::ZERO;
use crate::mechanics::problem::state::State;
use nalgebra::DVector;

/// A gap (dimensionless) up to this size is the round-off of zero.
const ROUNDING: f64 = 1e-13;

impl ModeSystem<'_> {
    /// Writes the residuals of equilibrium and contact; returns the largest equilibrium residual and the force scale.
    pub(crate) fn residual(&self, iterate: &Iterate, values: &mut DVector<f64>, force: &mut [f64]) -> (f64, f64) {
        let structure = self.loading.structure;
        let state = &iterate.state;
        let mut scale = structure.internal_force(&state.displacement, force);
        let loads = self.loading.pattern.forces.iter().zip(&self.loading.held.forces);
        for (value, (pattern, held)) in force.iter_mut().zip(loads) {
            let load = state.load * pattern + held;
            scale = scale.max(load.abs()).max(value.abs());
            *value -= load;
        }
        values.fill(0.0);
        for (contact, role) in self.roles.iter().enumerate() {
            if matches!(role, Role::Free) {
                continue;
            }
            let reaction = &state.reactions[contact];
            scale = scale.max(reaction.size());
            let frame = self.loading.frame(contact, state);
            let whole = add(&reaction.tangential, reaction.normal, &frame.normal);
            self.loading.each_column(contact, state, |freedom, column| force[freedom] -= dot(column, &whole));
            let row = self.row_of(contact);
            match role {
                // A sticking node is placed exactly: see `place_exactly`.
                Role::Stick if self.loading.contacts[contact].kinematics.node().is_none() => {
                    let chord = self.chord(contact, state);
                    for (k, direction) in self.held_directions(contact).iter().enumerate() {
                        values[row + k] = dot(direction, &chord);
                    }
                }
                Role::Free | Role::Stick | Role::Held | Role::HeldBy => {}
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } => {
                    values[row] = frame.gap - self.left_open(contact);
                }
                Role::Plane { track } => {
                    let Track { start, turn } = &self.tracks[*track];
                    values[row] = frame.gap - self.left_open(contact);
                    let chord = self.chord(contact, state);
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

    /// The gap that a contact keeps after it has closed at a gap that counts as zero: where several contacts close at
    /// almost one point, the path then continues without a jump, however short the way to the next closing is.
    fn left_open(&self, contact: usize) -> f64 {
        let gap = self.loading.gap(contact, self.anchor);
        if gap > ROUNDING && gap <= ZERO { gap } else { 0.0 }
    }

    /// Puts supports and sticking nodes exactly into their positions.
    pub(super) fn place_exactly(&self, state: &mut State) {
        self.loading.place_supports(state);
        let structure = self.loading.structure;
        for (contact, role) in self.roles.iter().enumerate() {
            let Some(node) = self.loading.contacts[contact].kinematics.node() else { continue };
            if !matches!(role, Role::Stick | Role::Held) || !self.holds_node(contact, node) {
                continue;
            }
            let shift = scaled(&self.loading.pattern.shifts[contact], state.load - self.anchor.load);
            for (freedom, shift) in structure.translations_of(node).zip(shift) {
                if structure.unknown_of[freedom].is_some() {
                    state.displacement[freedom] = self.anchor.displacement[freedom] + shift;
                }
            }
        }
    }

    /// Whether sticking leaves the node no motion at all.
    fn holds_node(&self, contact: usize, node: usize) -> bool {
        let structure = self.loading.structure;
        let free = structure.translations_of(node).filter(|freedom| structure.unknown_of[*freedom].is_some());
        self.held_directions(contact).len() >= free.count()
    }

    /// Makes complementarity exact: no reaction on a free contact, no motion of a sticking node, friction of a slipping
    /// contact on its cone.
    pub(crate) fn make_consistent(&self, iterate: &mut Iterate) {
        self.place_exactly(&mut iterate.state);
        for (contact, role) in self.roles.iter().enumerate() {
            match role {
                Role::Free => iterate.state.reactions[contact] = Reaction::default(),
                Role::Stick | Role::Held | Role::HeldBy => {}
                Role::Frictionless => iterate.state.reactions[contact].tangential = [0.0; 3],
                Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                    let frame = self.loading.frame(contact, &iterate.state);
                    let direction = self.direction(contact, &frame, iterate);
                    let friction = self.loading.contacts[contact].friction;
                    let reaction = &mut iterate.state.reactions[contact];
                    reaction.tangential = friction.traction(reaction.normal, &direction);
                }
            }
        }
    }
}
