//! The structure under a load pattern, with what earlier stages hold.

use crate::mechanics::contact::vector::{Vector, add};
use crate::mechanics::contact::{Contact, Frame, Reaction};
use crate::mechanics::problem::node_forces::Corner;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::structure::Structure;
use serde::{Deserialize, Serialize};

/// What a load factor multiplies, dimensionless.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LoadPattern {
    /// Forces; all degrees of freedom.
    pub forces: Vec<f64>,
    /// Displacements of supports; all degrees of freedom, or empty where no support moves in any stage.
    pub supports: Vec<f64>,
    /// Translation of each contact's obstacle.
    pub shifts: Vec<Vector>,
}

impl LoadPattern {
    /// Adds a multiple of another.
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.forces.iter_mut().zip(&other.forces).for_each(|(sum, value)| *sum += factor * value);
        self.supports.iter_mut().zip(&other.supports).for_each(|(sum, value)| *sum += factor * value);
        self.shifts.iter_mut().zip(&other.shifts).for_each(|(sum, value)| *sum = add(sum, factor, value));
    }

    /// Whether supports or obstacles move.
    pub fn moves_boundary(&self) -> bool {
        self.supports.iter().any(|value| *value != 0.0) || self.shifts.iter().any(|shift| *shift != [0.0; 3])
    }

    /// The same shape, all zero.
    pub fn zeroed(&self) -> Self {
        Self {
            forces: vec![0.0; self.forces.len()],
            supports: vec![0.0; self.supports.len()],
            shifts: vec![[0.0; 3]; self.shifts.len()],
        }
    }
}

/// The structure under a load pattern, with what is held from before.
#[derive(Clone, Copy)]
pub struct Loading<'a> {
    pub structure: &'a Structure,
    pub contacts: &'a [Contact],
    /// Nodes with several contacts.
    pub corners: &'a [Corner],
    /// Multiplied by the load factor.
    pub pattern: &'a LoadPattern,
    /// Held by earlier stages.
    pub held: &'a LoadPattern,
}

/// The displacement (dimensionless) whose forces count as meeting at a node even where there is less: the scale of
/// displacements itself. A structure that is just undeformed has no smaller forces than before.
pub(crate) const USUAL: f64 = 1.0;

fn largest_of(vector: &Vector) -> f64 {
    vector.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

impl Loading<'_> {
    /// Displacement of a contact's node less its obstacle's.
    #[inline(always)]
    pub fn relative(&self, contact: usize, state: &State) -> Vector {
        let moved = self.structure.translation_at(self.contacts[contact].node, &state.displacement);
        let shifted = add(&moved, -1.0, &self.held.shifts[contact]);
        add(&shifted, -state.load, &self.pattern.shifts[contact])
    }

    /// Velocity of a contact's node less its obstacle's.
    #[inline(always)]
    pub fn relative_rate(&self, contact: usize, rate: &Rate) -> Vector {
        let moved = self.structure.translation_at(self.contacts[contact].node, &rate.displacement);
        add(&moved, -rate.load, &self.pattern.shifts[contact])
    }

    /// Gap, normal and tangents of a contact.
    #[inline(always)]
    pub fn frame(&self, contact: usize, state: &State) -> Frame {
        self.contacts[contact].frame(&self.relative(contact, state))
    }

    /// The reaction (or its rate) by which a contact takes a force on its node; across the normal where there is friction.
    pub fn taken_by(&self, contact: usize, state: &State, force: &Vector) -> Reaction {
        let normal = self.frame(contact, state).normal;
        if self.contacts[contact].tangents() == 0 {
            Reaction::along(force, &normal)
        } else {
            Reaction::of(force, &normal)
        }
    }

    /// Gap of a contact.
    #[inline(always)]
    pub fn gap(&self, contact: usize, state: &State) -> f64 {
        self.contacts[contact].gap(&self.relative(contact, state))
    }

    /// The force against which a contact's reaction is zero: those that meet at its node, or the largest of the path where
    /// that is less. Structures with forces far apart each have their own.
    pub fn force_scale_at(&self, contact: usize, state: &State, force_scale: f64) -> f64 {
        self.forces_meeting_at(contact, state).min(force_scale).max(f64::EPSILON * force_scale)
    }

    /// Size of the forces that meet at a contact's node.
    pub fn forces_meeting_at(&self, contact: usize, state: &State) -> f64 {
        let node = self.contacts[contact].node;
        let own = |pattern: &LoadPattern| largest_of(&self.structure.translation_at(node, &pattern.forces));
        self.structure.force_size_at(node, &state.displacement, USUAL)
            + state.load.abs() * own(self.pattern)
            + own(self.held)
            + state.reactions[contact].size()
    }

    /// Whether a force at a contact is at most so many times the forces against which its reaction is zero.
    pub fn is_no_force(&self, contact: usize, state: &State, force: f64, tolerance: f64, force_scale: f64) -> bool {
        // The largest of the path often tells.
        force <= tolerance * force_scale && force <= tolerance * self.force_scale_at(contact, state, force_scale)
    }

    /// Displacement of a supported degree of freedom per load factor.
    #[inline(always)]
    pub fn support_rate(&self, freedom: usize) -> f64 {
        self.pattern.supports.get(freedom).copied().unwrap_or(0.0)
    }

    /// Puts the supports where the load factor has them.
    pub fn place_supports(&self, state: &mut State) {
        for (freedom, (held, pattern)) in self.held.supports.iter().zip(&self.pattern.supports).enumerate() {
            if self.structure.unknown_of[freedom].is_none() {
                state.displacement[freedom] = held + state.load * pattern;
            }
        }
    }
}
