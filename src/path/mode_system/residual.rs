//! What is left over of the equations, and states that fulfil exactly what can be.

use super::{Iterate, ModeSystem, Role, Track};
use crate::contact::Reaction;
use crate::contact::vector::scaled;
use crate::linear_algebra::Sink;
use crate::path::newton::Place;
use crate::path::standing::ZERO;
use crate::path::state::State;
use crate::path::track;
use nalgebra::DVector;

/// A gap (dimensionless) up to this size is what rounding leaves of none.
const ROUNDING: f64 = 1e-13;

impl ModeSystem<'_> {
    /// Equilibrium and contact equations; returns the largest equilibrium residual and the force scale.
    pub(in crate::path) fn residual(
        &self,
        iterate: &Iterate,
        values: &mut DVector<f64>,
        force: &mut [f64],
    ) -> (f64, f64) {
        let structure = self.loading.structure;
        let (dimension, state) = (structure.dimension, &iterate.state);
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
            let first = self.loading.contacts[contact].node * dimension;
            for component in 0..dimension {
                force[first + component] -= reaction.normal * frame.normal[component] + reaction.tangential[component];
            }
            let row = self.row_of(contact);
            match role {
                // A sticking node is put in its place exactly: see `place_exactly`.
                Role::Free | Role::Stick | Role::Held | Role::HeldBy => {}
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } => {
                    values[row] = frame.gap - self.left_open(contact);
                }
                Role::Plane { track } => {
                    let Track { start, turn } = &self.tracks[*track];
                    values[row] = frame.gap - self.left_open(contact);
                    let chord = self.chord(contact, state);
                    let rule = track::Rule::new(&frame, start, turn, &iterate.directions[contact], &chord);
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

    /// The gap that a contact keeps which closed where that was as good as none: where several touch at almost one place the
    /// path goes on from there without a jump, however short the way to the next is.
    fn left_open(&self, contact: usize) -> f64 {
        let gap = self.loading.gap(contact, self.anchor);
        if gap > ROUNDING && gap <= ZERO { gap } else { 0.0 }
    }

    /// Value of the last equation, and its row.
    pub(in crate::path) fn place(&self, state: &State, place: Place<'_>, matrix: Option<&mut dyn Sink>) -> f64 {
        let structure = self.loading.structure;
        let (last, unknowns) = (self.size - 1, structure.unknowns());
        match place {
            Place::ArcLength { from, step } if matrix.is_none() => state.distance(from) - step,
            Place::ArcLength { from, step } => {
                let size = state.distance(from);
                if let Some(matrix) = matrix {
                    let factor = if size > 0.0 { 1.0 / size } else { 1.0 };
                    let along = |freedom: usize| factor * (state.displacement[freedom] - from.displacement[freedom]);
                    self.border_along(matrix, along, factor * (state.load - from.load));
                }
                size - step
            }
            Place::Load(value) => {
                if let Some(matrix) = matrix {
                    matrix.add(last, unknowns, 1.0);
                }
                state.load - value
            }
            Place::Displacement { freedom, value } => {
                if let Some(matrix) = matrix {
                    match structure.unknown_of[freedom] {
                        Some(unknown) => matrix.add(last, unknown, 1.0),
                        None => matrix.add(last, unknowns, self.loading.support_rate(freedom)),
                    }
                }
                state.displacement[freedom] - value
            }
            Place::Zero { watch, scale, towards } => {
                if let Some(matrix) = matrix {
                    self.border(matrix, towards);
                }
                watch.value(self.loading, self.modes, state, towards) / scale
            }
        }
    }

    /// Supports and sticking nodes are where they have to be.
    pub(super) fn place_exactly(&self, state: &mut State) {
        self.loading.place_supports(state);
        let structure = self.loading.structure;
        for (contact, role) in self.roles.iter().enumerate() {
            if !matches!(role, Role::Stick | Role::Held) || !self.holds_node(contact) {
                continue;
            }
            let shift = scaled(&self.loading.pattern.shifts[contact], state.load - self.anchor.load);
            let first = self.loading.contacts[contact].node * structure.dimension;
            for (freedom, shift) in (first..first + structure.dimension).zip(shift) {
                if structure.unknown_of[freedom].is_some() {
                    state.displacement[freedom] = self.anchor.displacement[freedom] + shift;
                }
            }
        }
    }

    /// Whether sticking leaves the node no motion at all.
    fn holds_node(&self, contact: usize) -> bool {
        let structure = self.loading.structure;
        let first = self.loading.contacts[contact].node * structure.dimension;
        let free = (first..first + structure.dimension).filter(|freedom| structure.unknown_of[*freedom].is_some());
        self.held_directions(contact).len() >= free.count()
    }

    /// Makes complementarity exact: no reaction on a free contact, no motion of a sticking node, friction of a slipping
    /// contact on its cone.
    pub(in crate::path) fn make_consistent(&self, iterate: &mut Iterate) {
        self.place_exactly(&mut iterate.state);
        for (contact, role) in self.roles.iter().enumerate() {
            match role {
                Role::Free => iterate.state.reactions[contact] = Reaction::default(),
                Role::Stick | Role::Held | Role::HeldBy => {}
                Role::Frictionless => iterate.state.reactions[contact].tangential = [0.0; 3],
                Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                    let frame = self.loading.frame(contact, &iterate.state);
                    let direction = self.direction(contact, &frame, iterate);
                    let drag = -self.loading.contacts[contact].friction * iterate.state.reactions[contact].normal;
                    iterate.state.reactions[contact].tangential = scaled(&direction, drag);
                }
            }
        }
    }
}
