//! A node in the plane between two planes that the current stage moves against each other.
//!
//! With the velocities `c_i` of the planes per load factor, a node that stays closed against both planes moves with
//! `v = ṡ V`, `n_i·V = n_i·c_i`: it is carried. Along each plane the node then slips with `ṡ (V - c_i)`, or sticks to
//! the plane that moves with it. The force `R` on the node lies in the sum of the friction cones; a slip reduces a cone
//! to one ray:
//!
//! ```text
//! carried, either sign of ṡ    R = Σ r_i,  r_i on the ray n_i - μ_i d_i, or in the cone where it sticks
//! stuck to one                 R in its cone, the other opens
//! slides along one             R on its ray, the other opens
//! apart                        R = 0
//! ```
//!
//! Where the node sticks to one of the planes while it is carried, equilibrium does not determine the reactions: they
//! are those of least norm, as at other nodes with several contacts.

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled, size, unit};
use crate::mechanics::contact::{Frame, Mode, Reaction};
use crate::mechanics::multi_contact::reaction_sharing;
use crate::mechanics::multi_contact::tolerances::{INDEPENDENCE_SINE, RESTING_VELOCITY};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::Corner;
use crate::mechanics::problem::state::{Rate, State};

/// A node between two planes that move against each other.
pub struct Carried {
    pub(super) contacts: [usize; 2],
    pub(super) frames: [Frame; 2],
    pub(super) frictions: [CoulombFriction; 2],
    /// Velocities of the planes per load factor.
    pub(super) shifts: [Vector; 2],
    /// Velocity of the carried node per load factor.
    pub(super) velocity: Vector,
}

impl Carried {
    /// The node of two contacts between moving planes; `None` for contacts of another kind, and for two smooth planes,
    /// whose normal reactions equilibrium determines.
    pub fn of(loading: Loading<'_>, contacts: &[usize], state: &State) -> Option<Self> {
        let contacts = <[usize; 2]>::try_from(contacts).ok()?;
        let shifts = contacts.map(|contact| loading.pattern.shifts[contact]);
        let is_plane = |contact: &usize| matches!(loading.contacts[*contact].obstacle, RigidSurface::Plane { .. });
        let is_free = |contact: &usize| loading.contacts[*contact].sliding.directions() == 1;
        let is_rough = contacts.iter().any(|contact| loading.contacts[*contact].tangents() > 0);
        let here = loading.structure.dimension == 2 && shifts[0] != shifts[1] && is_rough;
        if !here || !contacts.iter().all(|contact| is_plane(contact) && is_free(contact)) {
            return None;
        }
        let frames = contacts.map(|contact| loading.frame(contact, state));
        let [a, b] = frames.map(|frame| frame.normal);
        let determinant = a[0] * b[1] - a[1] * b[0];
        if determinant.abs() <= INDEPENDENCE_SINE {
            return None;
        }
        let [x, y] = [dot(&a, &shifts[0]), dot(&b, &shifts[1])];
        let velocity = [(x * b[1] - y * a[1]) / determinant, (a[0] * y - b[0] * x) / determinant, 0.0];
        let frictions = contacts.map(|contact| loading.contacts[contact].friction);
        Some(Self { contacts, frames, frictions, shifts, velocity })
    }

    /// The modes of the contacts while the node is carried, by the sign of the load rate.
    pub(super) fn modes(&self, sign: f64) -> [Mode; 2] {
        let largest = size(&self.shifts[0]).max(size(&self.shifts[1]));
        [0, 1].map(|place| {
            let tangent = self.frames[place].tangents[0];
            let along = dot(&tangent, &add(&self.velocity, -1.0, &self.shifts[place]));
            if !self.frictions[place].is_rough() {
                Mode::Slip { direction: [0.0; 3] }
            } else if along.abs() <= RESTING_VELOCITY * largest {
                Mode::Stick
            } else {
                Mode::Slip { direction: scaled(&tangent, (sign * along).signum()) }
            }
        })
    }

    pub(super) fn ray(&self, place: usize, direction: &Vector) -> Vector {
        unit(&self.frictions[place].force_direction(&self.frames[place].normal, direction))
    }

    /// The reactions (or their rates) in these modes whose sum is a force (or its rate), one per contact.
    pub fn reactions(&self, loading: Loading<'_>, modes: &[Mode], force: &Vector, state: &State) -> [Reaction; 2] {
        let own = self.contacts.map(|contact| modes[contact]);
        let whole = |place: usize| Reaction::of(force, &self.frames[place].normal);
        match own {
            [Mode::Free, Mode::Free] => [Reaction::default(); 2],
            [_, Mode::Free] => [whole(0), Reaction::default()],
            [Mode::Free, _] => [Reaction::default(), whole(1)],
            [Mode::Slip { direction: first }, Mode::Slip { direction: second }] => {
                let rays = [self.ray(0, &first), self.ray(1, &second)];
                let turn = |a: &Vector, b: &Vector| a[0] * b[1] - a[1] * b[0];
                let determinant = turn(&rays[0], &rays[1]);
                let sizes = [turn(force, &rays[1]) / determinant, turn(&rays[0], force) / determinant];
                [0, 1].map(|place| Reaction::of(&scaled(&rays[place], sizes[place]), &self.frames[place].normal))
            }
            [Mode::Stick, _] | [_, Mode::Stick] => {
                let mut shared = state.clone();
                let holder = usize::from(own[0] != Mode::Stick);
                self.contacts.iter().for_each(|contact| shared.reactions[*contact] = Reaction::default());
                shared.reactions[self.contacts[holder]] = whole(holder);
                reaction_sharing::share(loading, &[Corner { contacts: self.contacts.to_vec() }], modes, &mut shared);
                self.contacts.map(|contact| shared.reactions[contact])
            }
        }
    }

    /// The rates of the reactions from the rate of their sum; where the node sticks to a plane, the contact with this
    /// plane takes the whole rate.
    pub fn rates(&self, loading: Loading<'_>, modes: &[Mode], rate: &Vector, state: &State) -> [(usize, Reaction); 2] {
        let own = self.contacts.map(|contact| modes[contact]);
        let [first, second] = self.contacts;
        let alone = |place: usize| {
            let mut held = modes.to_vec();
            held[self.contacts[1 - place]] = Mode::Free;
            self.reactions(loading, &held, rate, state)
        };
        let [a, b] = match own {
            [Mode::Stick, _] => alone(0),
            [_, Mode::Stick] => alone(1),
            _ => self.reactions(loading, modes, rate, state),
        };
        [(first, a), (second, b)]
    }

    /// The rate of dissipation under a force on the node.
    pub fn dissipation(&self, loading: Loading<'_>, modes: &[Mode], force: &Vector, state: &State, rate: &Rate) -> f64 {
        let reactions = self.reactions(loading, modes, force, state);
        let of = |(contact, reaction): (&usize, &Reaction)| match modes[*contact] {
            Mode::Slip { .. } => -dot(&reaction.tangential, &loading.relative_rate(*contact, state, rate)),
            Mode::Free | Mode::Stick => 0.0,
        };
        self.contacts.iter().zip(&reactions).map(of).sum()
    }
}
