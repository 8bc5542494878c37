//! The structure under a load pattern and the constant loads of earlier stages.

use crate::mechanics::contact::vector::{Vector, add, dot, scaled};
use crate::mechanics::contact::{ContactPair, Frame, Reaction};
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::node_contact_forces::Corner;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::{FORCE_ROUND_OFF_MULTIPLE, USUAL_DISPLACEMENT};
use crate::mechanics::structure::Structure;
use serde::{Deserialize, Serialize};

/// The loads that a load factor multiplies, dimensionless.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LoadPattern {
    /// Forces over all degrees of freedom.
    pub forces: Vec<f64>,
    /// Displacements of supports over all degrees of freedom, and pressures at those that stand for them; empty where no
    /// support moves in any stage and nothing is under pressure.
    pub supports: Vec<f64>,
    /// Translation of each contact's obstacle.
    pub shifts: Vec<Vector>,
}

impl LoadPattern {
    /// Adds a multiple of another pattern.
    pub fn add(&mut self, factor: f64, other: &Self) {
        self.forces.iter_mut().zip(&other.forces).for_each(|(sum, value)| *sum += factor * value);
        self.supports.iter_mut().zip(&other.supports).for_each(|(sum, value)| *sum += factor * value);
        self.shifts.iter_mut().zip(&other.shifts).for_each(|(sum, value)| *sum = add(sum, factor, value));
    }

    /// Whether supports or obstacles move.
    pub fn moves_boundary(&self) -> bool {
        self.supports.iter().any(|value| *value != 0.0) || self.shifts.iter().any(|shift| *shift != [0.0; 3])
    }

    /// The zero pattern of the same shape.
    pub fn zeroed(&self) -> Self {
        Self {
            forces: vec![0.0; self.forces.len()],
            supports: vec![0.0; self.supports.len()],
            shifts: vec![[0.0; 3]; self.shifts.len()],
        }
    }
}

/// The structure under a load pattern and the constant loads of earlier stages.
#[derive(Clone, Copy)]
pub struct Loading<'a> {
    pub structure: &'a Structure,
    pub contacts: &'a [ContactPair],
    /// Nodes with several contacts.
    pub corners: &'a [Corner],
    /// Loads multiplied by the load factor.
    pub pattern: &'a LoadPattern,
    /// Constant loads of earlier stages.
    pub held: &'a LoadPattern,
}

fn largest_of(vector: &Vector) -> f64 {
    vector.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

impl Loading<'_> {
    /// The displacement of a contact less that of its obstacle, in the obstacle's axes.
    #[inline(always)]
    pub fn relative(&self, contact: usize, state: &State) -> Vector {
        let moved = contact_jacobian::moved(self.structure, &self.contacts[contact], &state.displacement);
        let shifted = add(&moved, -1.0, &self.held.shifts[contact]);
        add(&shifted, -state.load, &self.pattern.shifts[contact])
    }

    /// The motion of a contact less that of its obstacle between two states of one path.
    #[inline(always)]
    pub fn relative_motion(&self, contact: usize, from: &State, to: &State) -> Vector {
        let data = &self.contacts[contact];
        match contact_jacobian::coupled_motion(self.structure, data, &from.displacement, &to.displacement) {
            Some(moved) => add(&moved, from.load - to.load, &self.pattern.shifts[contact]),
            None => add(&self.relative(contact, to), -1.0, &self.relative(contact, from)),
        }
    }

    /// The velocity of a contact less that of its obstacle at a state.
    #[inline(always)]
    pub fn relative_rate(&self, contact: usize, state: &State, rate: &Rate) -> Vector {
        let contact_data = &self.contacts[contact];
        let moved = contact_jacobian::velocity(self.structure, contact_data, &state.displacement, &rate.displacement);
        add(&moved, -rate.load, &self.pattern.shifts[contact])
    }

    /// Calls `each(freedom, column)` with the motion of a contact per degree of freedom at a state.
    #[inline(always)]
    pub fn each_column(&self, contact: usize, state: &State, each: impl FnMut(usize, &Vector)) {
        contact_jacobian::each_column(self.structure, &self.contacts[contact], &state.displacement, each);
    }

    /// The velocity of a contact less that of its obstacle, per load factor, due to the motion of supports and obstacle
    /// alone.
    pub fn driven(&self, contact: usize, state: &State) -> Vector {
        let mut motion = scaled(&self.pattern.shifts[contact], -1.0);
        self.each_column(contact, state, |freedom, column| {
            if self.structure.unknown_of[freedom].is_none() {
                motion = add(&motion, self.support_rate(freedom), column);
            }
        });
        motion
    }

    /// Gap, normal and tangents of a contact.
    #[inline(always)]
    pub fn frame(&self, contact: usize, state: &State) -> Frame {
        let mut frame = self.contacts[contact].frame(&self.relative(contact, state));
        if let Some(beyond) = self.beyond_rounding(contact, state) {
            frame.gap += dot(&frame.normal, &beyond);
        }
        frame
    }

    /// What the rounding of a node's displacement left, where the state keeps it.
    fn beyond_rounding(&self, contact: usize, state: &State) -> Option<Vector> {
        let node = self.contacts[contact].kinematics.node().filter(|_| !state.remainder.is_empty())?;
        Some(self.structure.translation_at(node, &state.remainder))
    }

    /// The reaction (or its rate) by which a contact carries a force on its node; with a tangential part only with
    /// friction.
    pub fn taken_by(&self, contact: usize, state: &State, force: &Vector) -> Reaction {
        let normal = self.frame(contact, state).normal;
        if self.contacts[contact].tangents() == 0 {
            Reaction::along(force, &normal)
        } else {
            Reaction::of(force, &normal)
        }
    }

    /// Gap of a contact. A contact that carries a reaction keeps its gap past the end of a surface, which goes on straight.
    #[inline(always)]
    pub fn gap(&self, contact: usize, state: &State) -> f64 {
        let is_pressed = || state.reactions.get(contact).is_some_and(|reaction| reaction.normal > 0.0);
        if self.beyond_rounding(contact, state).is_some() {
            return self.frame(contact, state).gap;
        }
        if self.contacts[contact].kinematics.node().is_some() || is_pressed() {
            return self.contacts[contact].gap(&self.relative(contact, state));
        }
        self.open_gap(contact, state)
    }

    /// Gap of a contact without reaction.
    pub fn open_gap(&self, contact: usize, state: &State) -> f64 {
        let data = &self.contacts[contact];
        let beyond = contact_jacobian::beyond_end(self.structure, data, &state.displacement);
        beyond.unwrap_or_else(|| data.gap(&self.relative(contact, state)))
    }

    /// The force scale against which a contact's reaction counts as zero: the forces that meet at its node, or the
    /// largest of the path where this is smaller. Parts of a structure with forces of different size have scales of
    /// their own.
    pub fn force_scale_at(&self, contact: usize, state: &State, force_scale: f64) -> f64 {
        self.forces_meeting_at(contact, state).min(force_scale).max(f64::EPSILON * force_scale)
    }

    /// Size of the forces that meet at a contact's node; the largest over several nodes.
    pub fn forces_meeting_at(&self, contact: usize, state: &State) -> f64 {
        let at_node = |node: &usize| {
            let own = |pattern: &LoadPattern| largest_of(&self.structure.translation_at(*node, &pattern.forces));
            self.structure.force_size_at(*node, &state.displacement, USUAL_DISPLACEMENT)
                + state.load.abs() * own(self.pattern)
                + own(self.held)
                + state.reactions[contact].size()
        };
        self.contacts[contact].kinematics.nodes().iter().map(at_node).fold(0.0, f64::max)
    }

    /// What the rounding of displacements leaves in a force at a contact.
    pub fn rounding_of_force(&self, contact: usize, state: &State) -> f64 {
        FORCE_ROUND_OFF_MULTIPLE * f64::EPSILON * self.forces_meeting_at(contact, state)
    }

    /// Whether a force at a contact is at most `tolerance` times the force scale against which its reaction counts as
    /// zero.
    pub fn is_no_force(&self, contact: usize, state: &State, force: f64, tolerance: f64, force_scale: f64) -> bool {
        // The largest force of the path often decides.
        force <= tolerance * force_scale && force <= tolerance * self.force_scale_at(contact, state, force_scale)
    }

    /// Displacement of a supported degree of freedom per load factor.
    #[inline(always)]
    pub fn support_rate(&self, freedom: usize) -> f64 {
        self.pattern.supports.get(freedom).copied().unwrap_or(0.0)
    }

    /// Places the supports according to the load factor of a state.
    pub fn place_supports(&self, state: &mut State) {
        for (freedom, (held, pattern)) in self.held.supports.iter().zip(&self.pattern.supports).enumerate() {
            if self.structure.unknown_of[freedom].is_none() {
                state.place(freedom, *held, state.load * pattern);
                if let Some(remainder) = state.remainder.get_mut(freedom) {
                    *remainder += state.load_remainder * pattern;
                }
            }
        }
    }
}
