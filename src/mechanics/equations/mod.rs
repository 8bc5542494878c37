//! The equations of one contact mode.
//!
//! ```text
//! f_int(u) - s f - f_held - Σ_i (n r_n + r_t)_i = 0          equilibrium
//! g_i(u, s) = 0                                              closed contacts (or the gap below 1e-10 at closing)
//! t·(x_i - x_i⁰) = 0                                         sticking contacts, unknown r_t
//! r_t = -μ r_n d                                             slipping contacts, d a tangent, or along an edge
//! c(u, s) = 0                                                arc length, or a prescribed load or displacement
//! ```
//!
//! `x_i` is the position of the node relative to its obstacle. For slip along a line `d` is known; for slip in a plane
//! `d` is an unknown with the equation of `slip_integration`. The unknowns are `(u, s)`, then for each closed contact
//! `r_n` and the unknowns of its mode; the matrix is square, and regular at smooth limit points because `c` borders it
//! (E. Riks, Int. J. Solids Struct. 15 (1979) 529, doi:10.1016/0020-7683(79)90081-7).

pub mod closing_equation;
pub(crate) mod corrected_point;
pub(crate) mod matrix;
pub(crate) mod mode_factorisation;
pub(crate) mod null_motion_suppression;
pub(crate) mod rate_recovery;
pub(crate) mod residual;
pub(crate) mod scaled_rows;
pub(crate) mod slip_integration;
pub(crate) mod slip_turn_update;
pub(crate) mod stage_end_criteria;
pub(crate) mod tolerances;

use crate::algebra::sparse::Holdings;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled};
use crate::mechanics::contact::{Frame, Mode, Reaction};
use crate::mechanics::equations::corrected_point::Corrected;
use crate::mechanics::equations::slip_integration::{Start, Turn};
use crate::mechanics::multi_contact::reaction_sharing;
use crate::mechanics::multi_contact::spatial::{Edge, beside};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::{free_directions, total_force};
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::structure::mixed_iteration::IndependentForces;
use nalgebra::DVector;
use smallvec::SmallVec;
use std::cell::OnceCell;

/// The contribution of a contact to the equations.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Role {
    Free,
    /// Closed, without traction.
    Frictionless,
    /// Slip along the frame's first tangent or against it, by the sign.
    Line {
        sign: f64,
    },
    /// Slip along the edge with the obstacle of another contact of the node, in the direction of [`Edge`] or against
    /// it, by the sign.
    Edge {
        beside: usize,
        sign: f64,
    },
    /// Slip along any tangent, on a track with an equation of its own; `track` is its index in the system.
    Plane {
        track: usize,
    },
    Stick,
    /// Holds its node together with other contacts; its unknowns are the total force on the node.
    Held,
    /// Holds its node together with a contact that is `Held`; adds nothing.
    HeldBy,
}

/// The start of the track of a slip in a plane, and its turn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Track {
    pub start: Start,
    pub turn: Turn,
}

/// The kind of equation of the track of a slip in a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Equation of the rates: the node moves along the direction.
    Rates,
    /// Equation of the increment: its chord lies between the directions at both ends.
    Increment,
}

/// An iterate on the way to convergence: a state with the directions of slip (one per contact; empty where none is
/// unknown).
#[derive(Debug, Clone)]
pub(crate) struct Iterate {
    pub state: State,
    pub directions: Vec<Vector>,
    /// Forces in elements that are variables of the iteration; `None`: they are those of the displacements.
    pub forces: Option<IndependentForces>,
}

impl Iterate {
    /// Copies another iterate of the same equations, without new memory.
    pub fn set_to(&mut self, other: &Self) {
        self.state.set_to(&other.state);
        self.directions.clone_from(&other.directions);
        self.forces.clone_from(&other.forces);
    }
}

/// Up to three orthonormal directions.
pub(crate) type Directions = SmallVec<[Vector; 3]>;

/// The directions of all contacts, one after the other, and the index of the first of each contact.
struct HeldDirections {
    starts: Vec<u32>,
    directions: Vec<Vector>,
}

/// A motion that the equations leave undetermined and that `null_motion_suppression` suppresses.
struct SuppressedMotion {
    /// The left null vector `ψ`.
    column: DVector<f64>,
    /// The motion `φ`, as a row.
    row: DVector<f64>,
}

/// The equations of one contact mode.
pub struct ModeSystem<'a> {
    pub(crate) loading: Loading<'a>,
    /// The state in which sticking contacts hold their nodes and slips start.
    pub(crate) anchor: &'a State,
    pub(crate) roles: Vec<Role>,
    pub(crate) tracks: Vec<Track>,
    pub(crate) modes: &'a [Mode],
    /// First row and column of each closed contact.
    first_of: SmallVec<[usize; 4]>,
    pub(crate) size: usize,
    /// Rate of the path at the anchor, where it is known.
    pub(crate) along: Option<&'a Rate>,
    /// A point near by, and the chord to the guess, from which forces in elements start instead.
    beside: Option<(&'a State, &'a Rate)>,
    /// Whether a step shorter than the required one serves as well.
    pub(crate) may_be_shorter: bool,
    /// Suppressed motions: see `null_motion_suppression`.
    suppressed: Vec<SuppressedMotion>,
    /// Computed when first needed.
    holdings: OnceCell<Holdings>,
    /// See [`Self::held_directions`]; computed when first needed.
    held: OnceCell<HeldDirections>,
}

impl<'a> ModeSystem<'a> {
    /// The equations of `modes`; `anchor` is the state in which the modes begin.
    pub fn new(loading: Loading<'a>, modes: &'a [Mode], anchor: &'a State) -> Self {
        let mut next = loading.structure.unknowns() + 1;
        let mut first_of = SmallVec::with_capacity(modes.len());
        let mut roles = Vec::with_capacity(modes.len());
        let mut tracks = Vec::new();
        for (index, (mode, contact)) in modes.iter().zip(loading.contacts).enumerate() {
            let held = loading.corners.iter().find_map(|corner| {
                let mut holding = corner.holding(modes);
                let first = holding.next()?;
                (first == index || holding.any(|other| other == index)).then_some(first == index)
            });
            let role = match mode {
                Mode::Stick if held == Some(true) => Role::Held,
                Mode::Stick | Mode::Slip { .. } if held == Some(false) => Role::HeldBy,
                Mode::Free => Role::Free,
                Mode::Stick => Role::Stick,
                Mode::Slip { .. } if contact.tangents() == 0 => Role::Frictionless,
                Mode::Slip { direction } if contact.tangents() == 1 => {
                    let tangent = loading.frame(index, anchor).tangents[0];
                    Role::Line { sign: if dot(direction, &tangent) < 0.0 { -1.0 } else { 1.0 } }
                }
                Mode::Slip { direction } if let Some(beside) = beside(loading, modes, index) => {
                    let edge = Edge::new(loading, [index, beside], anchor);
                    Role::Edge { beside, sign: if dot(direction, &edge.direction) < 0.0 { -1.0 } else { 1.0 } }
                }
                Mode::Slip { direction } => {
                    let normal = loading.frame(index, anchor).normal;
                    tracks.push(Track { start: Start { direction: *direction, normal }, turn: Turn::default() });
                    Role::Plane { track: tracks.len() - 1 }
                }
            };
            first_of.push(next);
            next += match role {
                Role::Free | Role::HeldBy => 0,
                Role::Held => free_directions(loading, index).len(),
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } => 1,
                Role::Plane { .. } => 2,
                Role::Stick => 1 + contact.tangents(),
            };
            roles.push(role);
        }
        Self {
            loading,
            anchor,
            roles,
            tracks,
            modes,
            first_of,
            size: next,
            along: None,
            beside: None,
            may_be_shorter: false,
            suppressed: Vec::new(),
            holdings: OnceCell::new(),
            held: OnceCell::new(),
        }
    }

    /// The same equations, for iterations along a path of this rate at the anchor.
    pub fn along(self, rate: &'a Rate) -> Self {
        Self { along: Some(rate), ..self }
    }

    /// The same equations, for iterations that start near a converged point other than the anchor; `chord` leads from it to
    /// the guess.
    pub(crate) fn beside(self, point: &'a State, chord: &'a Rate) -> Self {
        Self { beside: Some((point, chord)), ..self }
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Whether some contact slips in a plane.
    pub fn has_tracks(&self) -> bool {
        !self.tracks.is_empty()
    }

    /// Whether any motion is suppressed.
    fn is_deflated(&self) -> bool {
        !self.suppressed.is_empty()
    }

    /// The column of a closed contact's normal reaction; its other unknowns follow. The rows of a contact have indices
    /// smaller by one.
    pub fn column_of(&self, contact: usize) -> usize {
        self.first_of[contact]
    }

    /// The row of a closed contact's normal equation; its other equations follow.
    pub fn row_of(&self, contact: usize) -> usize {
        self.first_of[contact] - 1
    }

    /// The iterate of a state, with the directions of slip that the modes give; where contacts hold a node together,
    /// the first of them takes the total force.
    pub(crate) fn iterate(&self, mut state: State) -> Iterate {
        for corner in self.loading.corners {
            let mut holding = corner.holding(self.modes);
            if let Some(first) = holding.next() {
                let force = total_force(self.loading, corner.holding(self.modes), &state);
                let normal = self.loading.frame(first, &state).normal;
                state.reactions[first] = Reaction::of(&force, &normal);
                holding.for_each(|other| state.reactions[other] = Reaction::default());
            }
        }
        for (contact, role) in self.roles.iter().enumerate() {
            if let Role::Stick = role {
                self.hold_in_frame(contact, &mut state);
            }
        }
        let directions = if self.has_tracks() {
            let of = |(index, role): (usize, &Role)| match role {
                Role::Plane { track } => {
                    self.tracks[*track].start.carried_to(&self.loading.frame(index, &state).normal)
                }
                _ => [0.0; 3],
            };
            self.roles.iter().enumerate().map(of).collect()
        } else {
            Vec::new()
        };
        Iterate { state, directions, forces: None }
    }

    /// Lets the forces in elements vary in an iteration from a guess, where the elements have such forces. They start
    /// from those at the anchor and follow the path's rate: the displacements of a guess may strain stiff elements far
    /// more than the solution's do. Without the change along the path, a step from a bifurcation point would begin at
    /// the critical forces, with singular equations.
    pub(crate) fn begin_iteration(&self, guess: &mut Iterate) {
        let Self { loading, .. } = self;
        let (from, along) = self.beside.map_or((self.anchor, self.along), |(point, chord)| (point, Some(chord)));
        guess.forces = IndependentForces::at(loading.structure, &from.displacement);
        if let (Some(forces), Some(rate)) = (&mut guess.forces, along) {
            let square = rate.product(rate);
            if square > 0.0 {
                let length = from.product_of_chord(&guess.state, rate) / square;
                forces.advance(loading.structure, &from.displacement, |freedom| length * rate.displacement[freedom]);
            }
        }
    }

    /// Resolves the force of a sticking contact in the frame at the anchor. A guess may have moved the sticking node on
    /// a curved obstacle; the correction puts the node back to its position at the anchor, where the normal is
    /// different. Corrections of the traction are perpendicular to the normal there. A component of the guessed
    /// traction along this normal would therefore remain: in equilibrium, but neither pressure nor friction.
    fn hold_in_frame(&self, contact: usize, state: &mut State) {
        let held = self.loading.frame(contact, self.anchor);
        if held.curvature.is_zero() {
            return;
        }
        let guessed = self.loading.frame(contact, state).normal;
        if guessed != held.normal {
            let Reaction { normal, tangential } = state.reactions[contact];
            state.reactions[contact] = Reaction::of(&add(&tangential, normal, &guessed), &held.normal);
        }
    }

    /// The iterate of a converged point.
    pub(crate) fn iterate_of(&self, corrected: &Corrected) -> Iterate {
        Iterate { directions: corrected.directions.clone(), ..self.iterate(corrected.state.clone()) }
    }

    /// Replaces the reactions of contacts that hold a node together by those of least norm.
    pub(crate) fn share(&self, state: &mut State) {
        reaction_sharing::share(self.loading, self.loading.corners, self.modes, state);
    }

    /// The orthonormal directions in which a sticking contact holds its node and has a reaction: the normal and the
    /// tangents with friction; where contacts hold the node together, all directions in which the node is free.
    pub(crate) fn held_directions(&self, contact: usize) -> &[Vector] {
        let held = self.held.get_or_init(|| {
            let count = self.roles.len();
            let mut held = HeldDirections { starts: Vec::with_capacity(count + 1), directions: Vec::new() };
            held.directions.reserve(count);
            for contact in 0..count {
                held.starts.push(held.directions.len() as u32);
                held.directions.extend(self.directions_held(contact));
            }
            held.starts.push(held.directions.len() as u32);
            held
        });
        &held.directions[held.starts[contact] as usize..held.starts[contact + 1] as usize]
    }

    fn directions_held(&self, contact: usize) -> Directions {
        let in_frame = |tangents: usize| {
            let frame = self.loading.frame(contact, self.anchor);
            std::iter::once(frame.normal).chain(frame.tangents.into_iter().take(tangents)).collect()
        };
        match self.roles[contact] {
            Role::Stick => in_frame(self.loading.contacts[contact].tangents()),
            Role::Held => {
                let free = free_directions(self.loading, contact);
                let dimension = self.loading.structure.dimension;
                if free.len() == dimension { in_frame(dimension - 1) } else { Directions::from_vec(free) }
            }
            Role::Free
            | Role::Frictionless
            | Role::Line { .. }
            | Role::Edge { .. }
            | Role::Plane { .. }
            | Role::HeldBy => Directions::new(),
        }
    }

    /// The motion relative to the obstacle since the anchor.
    pub(crate) fn chord(&self, contact: usize, state: &State) -> Vector {
        self.loading.relative_motion(contact, self.anchor, state)
    }

    /// The direction of a slip at an iterate; zero without friction.
    fn direction(&self, contact: usize, frame: &Frame, iterate: &Iterate) -> Vector {
        match self.roles[contact] {
            Role::Line { sign } => scaled(&frame.tangents[0], sign),
            Role::Edge { beside, sign } => {
                scaled(&Edge::new(self.loading, [contact, beside], &iterate.state).direction, sign)
            }
            Role::Plane { .. } => iterate.directions[contact],
            Role::Free | Role::Frictionless | Role::Stick | Role::Held | Role::HeldBy => [0.0; 3],
        }
    }

    /// The change of a slip's direction with the position on the obstacle, apart from the turn that is an unknown.
    fn direction_change(&self, contact: usize, iterate: &Iterate, direction: &Vector, motion: &Vector) -> Vector {
        let frame = self.loading.frame(contact, &iterate.state);
        match self.roles[contact] {
            Role::Line { sign } => scaled(&frame.tangent_change(motion), sign),
            Role::Edge { beside, sign } => {
                scaled(&Edge::new(self.loading, [contact, beside], &iterate.state).change(motion), sign)
            }
            Role::Plane { .. } => scaled(&frame.normal, -dot(&frame.normal_change(motion), direction)),
            Role::Free | Role::Frictionless | Role::Stick | Role::Held | Role::HeldBy => [0.0; 3],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::scene::Scene;
    use crate::mechanics::equations::closing_equation::PrescribedValue;
    use crate::step::corrector::newton;

    /// A node on a spring sticks to the top of a ball. The guess has slid off, with the force resolved along and across
    /// the normal there.
    #[test]
    fn a_stuck_node_keeps_its_force_across_its_own_normal() {
        let request = crate::model::decode::decode(
            br#"{"model": {"dimension": 2, "nodes": {"node": [0, 0]},
                "elements": [{"kind": "spring", "nodes": ["node"], "stiffness": [[1, 0], [0, 1]]}],
                "obstacles": {"ball": {"kind": "ball", "center": [0, -1], "radius": 1}},
                "contacts": [{"node": "node", "obstacle": "ball", "friction": 0.5}],
                "stages": [{"name": "press", "forces": {"node": [0.25, -1]}}]}}"#,
        )
        .expect("a request");
        let scene = Scene::new(&request).expect("a scene");
        let held = scene.stages[0].pattern.zeroed();
        let loading = Loading {
            structure: &scene.structure,
            contacts: &scene.contacts,
            corners: &scene.corners,
            pattern: &scene.stages[0].pattern,
            held: &held,
        };
        let anchor = State::at_rest(&scene.structure, 1);
        let system = ModeSystem::new(loading, &[Mode::Stick], &anchor);
        let mut guess = anchor.clone();
        (guess.load, guess.displacement[0]) = (1.0, 1e-3);
        let force = scaled(&[loading.pattern.forces[0], loading.pattern.forces[1], 0.0], -1.0);
        guess.reactions[0] = Reaction::of(&force, &loading.frame(0, &guess).normal);
        let found = newton::correct(&system, guess, &PrescribedValue::Load(1.0), 1.0).expect("a point").state;
        let normal = loading.frame(0, &found).normal;
        let whole = add(&found.reactions[0].tangential, found.reactions[0].normal, &normal);
        assert_eq!(found.displacement, anchor.displacement);
        assert!(
            crate::mechanics::contact::vector::size(&add(&whole, -1.0, &force)) <= 1e-15,
            "{whole:?} for {force:?}"
        );
        assert!(dot(&found.reactions[0].tangential, &normal).abs() <= 1e-16, "{:?}", found.reactions[0]);
    }
}
