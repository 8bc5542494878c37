//! The equations of one contact mode.
//!
//! ```text
//! f_int(u) - s f - f_held - Σ_i (n r_n + r_t)_i = 0          equilibrium
//! g_i(u, s) = 0                                              closed contacts
//! t·(x_i - x_i⁰) = 0                                         sticking contacts, unknown r_t
//! r_t = -μ r_n d                                             slipping contacts, d a tangent, or along an edge
//! c(u, s) = 0                                                arc length, or a held load or displacement
//! ```
//!
//! `x_i` is the node's place relative to its obstacle. Along a line `d` is known; in a plane it is an unknown with the
//! equation of `track`. Unknowns are `(u, s)`, then for each closed contact `r_n` and what its mode adds; the matrix is
//! square, and regular at smooth limit points because `c` borders it
//! (E. Riks, Int. J. Solids Struct. 15 (1979) 529, doi:10.1016/0020-7683(79)90081-7).

use super::corner::{self, total_force};
use super::loading::Loading;
use super::newton::{Corrected, Place, Tangent};
use super::pocket::{Edge, beside, free_directions};
use super::state::{Rate, State};
use super::track::{self, Start, Turn};
use crate::contact::vector::{Vector, add, cross, dot, scaled, size};
use crate::contact::{Frame, Mode, Reaction};
use crate::linear_algebra::sparse::{Bordered, Holding, Holdings, SparseFactorisation};
use crate::linear_algebra::{Factorisation, Sink, Stiffener, SystemFactorisation};
use crate::structure::Stretching;
use nalgebra::{DMatrix, DVector};
use smallvec::SmallVec;
use std::cell::OnceCell;

/// What a contact contributes to the equations.
#[derive(Debug, Clone, Copy)]
pub(super) enum Role {
    Free,
    /// Closed, no traction.
    Frictionless,
    /// Slip along the frame's first tangent, in the sense of the sign.
    Line {
        sign: f64,
    },
    /// Slip along the edge with the obstacle of another contact of the node, in the sense of the sign: see `edge`.
    Edge {
        beside: usize,
        sign: f64,
    },
    /// Slip along any tangent, on a track with an equation of its own.
    Plane {
        start: Start,
        turn: Turn,
    },
    Stick,
    /// Holds its node together with other contacts, and has the whole force in its unknowns.
    Held,
    /// Holds its node together with one that is `Held`; adds nothing.
    HeldBy,
}

/// Which equation the track of a slip in a plane has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Of rates: the node goes along the direction.
    Rates,
    /// Of the increment: its chord lies between the directions at both ends.
    Increment,
}

/// Where the elements' resistance to being stretched is.
#[derive(Debug, Clone, Copy)]
enum Stretch {
    Within,
    Apart,
}

/// Smallest pivot over the largest below which digits are worth the larger system that saves them.
const SPREAD: f64 = 1e-4;
/// The same where small pivots were raised and came back as borders: what is left of them is little more than this.
const SPREAD_AT_LEAST: f64 = 1e-5;
/// Unknowns up to which they are saved so.
const MOST_APART: usize = 200;

/// A state on the way to convergence, with the directions of slip (one a contact; empty where none is unknown).
#[derive(Debug, Clone)]
pub(super) struct Iterate {
    pub state: State,
    pub directions: Vec<Vector>,
}

impl Iterate {
    /// Becomes another one of the same equations, in the memory that it has.
    pub fn set_to(&mut self, other: &Self) {
        self.state.set_to(&other.state);
        self.directions.clone_from(&other.directions);
    }
}

/// Friction force (dimensionless) below which Newton's matrix takes it as this.
const LEAST_PRESSED: f64 = 1e-10;

/// Up to three orthonormal directions.
pub(super) type Directions = SmallVec<[Vector; 3]>;

/// One mode's equations.
pub struct ModeSystem<'a> {
    pub(super) loading: Loading<'a>,
    /// Where sticking contacts hold their nodes and slips start.
    pub(super) anchor: &'a State,
    pub(super) roles: Vec<Role>,
    modes: &'a [Mode],
    /// First row and column of each closed contact.
    first_of: Vec<usize>,
    pub(super) size: usize,
    /// Made when first needed.
    holdings: OnceCell<Holdings>,
    /// Of each contact, see [`Self::held_directions`]; made when first needed.
    held: OnceCell<Vec<Directions>>,
}

impl<'a> ModeSystem<'a> {
    /// `anchor` is the state in which the modes begin.
    pub fn new(loading: Loading<'a>, modes: &'a [Mode], anchor: &'a State) -> Self {
        let mut next = loading.structure.unknowns() + 1;
        let mut first_of = Vec::with_capacity(modes.len());
        let mut roles = Vec::with_capacity(modes.len());
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
                    Role::Plane { start: Start { direction: *direction, normal }, turn: Turn::default() }
                }
            };
            first_of.push(next);
            next += match role {
                Role::Free | Role::HeldBy => 0,
                Role::Held => free_directions(loading, contact.node).len(),
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } => 1,
                Role::Plane { .. } => 2,
                Role::Stick => 1 + contact.tangents(),
            };
            roles.push(role);
        }
        Self { loading, anchor, roles, modes, first_of, size: next, holdings: OnceCell::new(), held: OnceCell::new() }
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Whether some contact slips in a plane.
    pub fn has_tracks(&self) -> bool {
        self.roles.iter().any(|role| matches!(role, Role::Plane { .. }))
    }

    /// Sets how fast the slips in planes turn at the start, by the path's direction there, and for another solve at the
    /// end. Whether some direction settles there is returned.
    pub fn set_turns(&mut self, start: &Rate, end: &Corrected, tangent: &Tangent) -> bool {
        let mut settles = false;
        for index in 0..self.roles.len() {
            let Role::Plane { start: begun, .. } = self.roles[index] else { continue };
            let Mode::Slip { direction } = end.modes[index] else { continue };
            let at_start = track::turn_rate(self.loading, index, self.anchor, start, &begun.direction);
            let at_end = track::turn_rate(self.loading, index, &end.state, &tangent.rate, &direction);
            let settling = tangent.stiffness_across[index].and_then(|stiffness| {
                let chord = size(&self.chord(index, &end.state));
                let here = (&end.state, &tangent.rate);
                track::settling(self.loading, index, here, (&begun, &direction), (chord, stiffness))
            });
            settles |= settling.is_some_and(|settling| settling.share() > 0.0);
            self.roles[index] = Role::Plane { start: begun, turn: Turn { at_start, at_end, settling } };
        }
        settles
    }

    /// The largest angle (radians) by which the direction of a slip in a plane differs from that of another point, or
    /// from that at the start; a node that is not pressed has none.
    pub fn largest_turn(&self, corrected: &Corrected, other: Option<&Corrected>) -> f64 {
        let of = |(index, role): (usize, &Role)| {
            let (Role::Plane { start, .. }, Mode::Slip { direction }) = (role, corrected.modes[index]) else {
                return 0.0;
            };
            if corrected.state.reactions[index].normal <= 0.0 {
                return 0.0;
            }
            let normal = self.loading.frame(index, &corrected.state).normal;
            let from = match other.map(|other| other.modes[index]) {
                Some(Mode::Slip { direction }) => direction,
                Some(Mode::Free | Mode::Stick) | None => start.carried_to(&normal),
            };
            track::angle(&normal, &from, &direction).abs()
        };
        self.roles.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    /// The largest angle (radians) by which turns move the chord of a track that does not settle.
    pub fn largest_correction(&self, corrected: &Corrected) -> f64 {
        let of = |(index, role): (usize, &Role)| match role {
            Role::Plane { turn, .. } if turn.settling.is_none_or(|settling| settling.share() == 0.0) => {
                turn.correction(size(&self.chord(index, &corrected.state))).abs()
            }
            _ => 0.0,
        };
        self.roles.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    /// Column of a closed contact's normal reaction; its other unknowns follow. Its rows are one less.
    pub fn column_of(&self, contact: usize) -> usize {
        self.first_of[contact]
    }

    /// Row of a closed contact's normal equation; its others follow.
    pub fn row_of(&self, contact: usize) -> usize {
        self.first_of[contact] - 1
    }

    /// A state with the directions of slip that the modes give; where contacts hold a node together, the first of them
    /// has the whole force.
    pub(super) fn iterate(&self, mut state: State) -> Iterate {
        for corner in self.loading.corners {
            let mut holding = corner.holding(self.modes);
            if let Some(first) = holding.next() {
                let force = total_force(self.loading, corner.holding(self.modes), &state);
                let normal = self.loading.frame(first, &state).normal;
                let along = dot(&force, &normal);
                state.reactions[first] = Reaction { normal: along, tangential: add(&force, -along, &normal) };
                holding.for_each(|other| state.reactions[other] = Reaction::default());
            }
        }
        let directions = if self.has_tracks() {
            let of = |(index, role): (usize, &Role)| match role {
                Role::Plane { start, .. } => start.carried_to(&self.loading.frame(index, &state).normal),
                _ => [0.0; 3],
            };
            self.roles.iter().enumerate().map(of).collect()
        } else {
            Vec::new()
        };
        Iterate { state, directions }
    }

    /// A converged point.
    pub(super) fn iterate_of(&self, corrected: &Corrected) -> Iterate {
        Iterate { directions: corrected.directions.clone(), ..self.iterate(corrected.state.clone()) }
    }

    /// Where several contacts hold a node together, their reactions become those of least norm.
    pub(super) fn share(&self, state: &mut State) {
        corner::share(self.loading, self.loading.corners, self.modes, state);
    }

    /// All rows but the last of the rate equations at a state, which is left zero for the bordering equation.
    pub fn matrix(&self, state: &State) -> DMatrix<f64> {
        self.assemble(&self.iterate(state.clone()), Kind::Rates)
    }

    /// All rows but the last.
    pub(super) fn assemble(&self, iterate: &Iterate, kind: Kind) -> DMatrix<f64> {
        self.assemble_parts(iterate, kind, Stretch::Within)
    }

    fn assemble_parts(&self, iterate: &Iterate, kind: Kind, stretch: Stretch) -> DMatrix<f64> {
        let structure = self.loading.structure;
        let (state, unknowns) = (&iterate.state, structure.unknowns());
        let mut matrix = DMatrix::zeros(self.size, self.size);
        let mut add = |row: usize, column: usize, value: f64| {
            let Some(row) = structure.unknown_of[row] else { return };
            match structure.unknown_of[column] {
                Some(column) => matrix[(row, column)] += value,
                None => matrix[(row, unknowns)] += value * self.loading.support_rate(column),
            }
        };
        match stretch {
            Stretch::Within => structure.each_stiffness(&state.displacement, &mut add),
            Stretch::Apart => structure.each_stiffness_across(&state.displacement, &mut add),
        }
        self.add_loads_and_contacts(iterate, kind, &mut matrix);
        matrix
    }

    /// The columns of the load and of the contacts, and the contacts' rows.
    fn add_loads_and_contacts(&self, iterate: &Iterate, kind: Kind, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            matrix.add(unknown, structure.unknowns(), -self.loading.pattern.forces[*freedom]);
        }
        for (contact, role) in self.roles.iter().enumerate() {
            match role {
                Role::Free | Role::HeldBy => {}
                Role::Stick | Role::Held => self.add_stick(contact, matrix),
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                    self.add_slip(contact, iterate, kind, matrix);
                }
            }
        }
    }

    /// All rows but the last, sparse; `None` for a structure whose matrices are dense.
    pub(super) fn assemble_sparse(&self, iterate: &Iterate, kind: Kind) -> Option<Bordered> {
        let structure = self.loading.structure;
        let layout = structure.layout()?;
        let unknowns = structure.unknowns();
        let mut matrix = Bordered::new(layout.pattern.clone(), self.size - unknowns);
        let mut places = layout.places();
        structure.each_stiffness(
            &iterate.state.displacement,
            &mut |row, column, value| match places.next().flatten() {
                Some(place) => matrix.add_at(place, value),
                None => {
                    if let (Some(row), None) = (structure.unknown_of[row], structure.unknown_of[column]) {
                        matrix.add(row, unknowns, value * self.loading.support_rate(column));
                    }
                }
            },
        );
        self.add_loads_and_contacts(iterate, kind, &mut matrix);
        Some(matrix)
    }

    /// What the closed contacts hold at each node, in the order of the nodes.
    pub(super) fn holdings(&self) -> &Holdings {
        self.holdings.get_or_init(|| {
            let closed = |contact: &usize| !matches!(self.roles[*contact], Role::Free | Role::HeldBy);
            let mut contacts: Vec<usize> = (0..self.roles.len()).filter(closed).collect();
            contacts.sort_by_key(|contact| self.loading.contacts[*contact].node);
            let same_node = |a: &usize, b: &usize| self.loading.contacts[*a].node == self.loading.contacts[*b].node;
            Holdings::new(contacts.chunk_by(same_node).map(|contacts| self.holding(contacts)).collect())
        })
    }

    /// What closed contacts hold at their node.
    fn holding(&self, contacts: &[usize]) -> Holding {
        let structure = self.loading.structure;
        let (dimension, unknowns) = (structure.dimension, structure.unknowns());
        let node = contacts.first().map_or(0, |contact| self.loading.contacts[*contact].node);
        let freedoms = node * dimension..(node + 1) * dimension;
        let mut holding = Holding::new(freedoms.filter_map(|freedom| structure.unknown_of[freedom]));
        for contact in contacts {
            let count = match self.roles[*contact] {
                Role::Free | Role::HeldBy => 0,
                Role::Stick | Role::Held => self.held_directions(*contact).len(),
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => 1,
            };
            let (row, column) = (self.row_of(*contact) - unknowns, self.column_of(*contact) - unknowns);
            holding.rows.extend(row..row + count);
            holding.columns.extend(column..column + count);
        }
        holding
    }

    /// Factorises the equations at an iterate with a last row that the caller puts in. Where stiff and soft parts meet, so
    /// that their sum would cost too many digits, the stiff ones are kept apart (in dense matrices; for many unknowns
    /// solutions are refined instead).
    pub(super) fn factorise(
        &self,
        iterate: &Iterate,
        kind: Kind,
        put_last: impl Fn(&mut dyn Sink),
    ) -> Option<SystemFactorisation> {
        let structure = self.loading.structure;
        let unknowns = structure.unknowns();
        let plain = match self.factorise_as_it_is(iterate, kind, &put_last) {
            Some(SystemFactorisation::Dense(plain)) if plain.pivot_ratio() < SPREAD => plain,
            Some(SystemFactorisation::Sparse(sparse))
                if sparse.spread() < SPREAD_AT_LEAST && unknowns <= MOST_APART =>
            {
                self.factorise_dense(iterate, kind, &put_last)?
            }
            Some(other) => return Some(other),
            None if structure.layout().is_some() && unknowns <= MOST_APART => {
                self.factorise_dense(iterate, kind, &put_last)?
            }
            None => return None,
        };
        if plain.pivot_ratio() >= SPREAD {
            return Some(SystemFactorisation::Dense(plain));
        }
        let stiffener = |stretching: Stretching| {
            let unknown = |(freedom, value): &(usize, f64)| Some((structure.unknown_of[*freedom]?, *value));
            let rows: Vec<(usize, f64)> = stretching.along.iter().filter_map(unknown).collect();
            let driven = |(freedom, value): &(usize, f64)| match structure.unknown_of[*freedom] {
                None => value * self.loading.support_rate(*freedom),
                Some(_) => 0.0,
            };
            let by_load: f64 = stretching.along.iter().map(driven).sum();
            let columns = rows.iter().copied().chain(std::iter::once((unknowns, by_load))).collect();
            (!rows.is_empty()).then_some(Stiffener { stiffness: stretching.stiffness, rows, columns })
        };
        let stretchings = structure.stretching(&iterate.state.displacement);
        let stiffeners: Vec<Stiffener> = stretchings.into_iter().filter_map(stiffener).collect();
        let mut apart = self.assemble_parts(iterate, kind, Stretch::Apart);
        put_last(&mut apart);
        Factorisation::stiffened(apart, &stiffeners).or(Some(plain)).map(SystemFactorisation::Dense)
    }

    /// The same with stiff and soft parts added up.
    pub(super) fn factorise_as_it_is(
        &self,
        iterate: &Iterate,
        kind: Kind,
        put_last: impl Fn(&mut dyn Sink),
    ) -> Option<SystemFactorisation> {
        if let Some(mut matrix) = self.assemble_sparse(iterate, kind) {
            put_last(&mut matrix);
            let factorisation = SparseFactorisation::new(matrix, self.holdings())?;
            return Some(SystemFactorisation::Sparse(Box::new(factorisation)));
        }
        self.factorise_dense(iterate, kind, put_last).map(SystemFactorisation::Dense)
    }

    fn factorise_dense(
        &self,
        iterate: &Iterate,
        kind: Kind,
        put_last: impl Fn(&mut dyn Sink),
    ) -> Option<Factorisation> {
        let mut matrix = self.assemble(iterate, kind);
        put_last(&mut matrix);
        Factorisation::new(matrix)
    }

    /// A row `vector·(relative motion)`.
    fn put_motion(&self, contact: usize, row: usize, vector: &Vector, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        let load = structure.unknowns();
        let first = self.loading.contacts[contact].node * structure.dimension;
        for (component, part) in vector.iter().enumerate().take(structure.dimension) {
            match structure.unknown_of[first + component] {
                Some(unknown) => matrix.add(row, unknown, *part),
                None => matrix.add(row, load, part * self.loading.support_rate(first + component)),
            }
        }
        matrix.add(row, load, -dot(vector, &self.loading.pattern.shifts[contact]));
    }

    /// A column of equilibrium: the negative of a force on the contact's node.
    fn put_force(&self, contact: usize, column: usize, force: &Vector, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        let first = self.loading.contacts[contact].node * structure.dimension;
        for (component, part) in force.iter().enumerate().take(structure.dimension) {
            if let Some(unknown) = structure.unknown_of[first + component] {
                matrix.add(unknown, column, -part);
            }
        }
    }

    fn add_stick(&self, contact: usize, matrix: &mut impl Sink) {
        let (row, column) = (self.row_of(contact), self.column_of(contact));
        for (k, direction) in self.held_directions(contact).iter().enumerate() {
            self.put_force(contact, column + k, direction, matrix);
            self.put_motion(contact, row + k, direction, matrix);
        }
    }

    /// Orthonormal directions in which a sticking contact holds its node, along which it has a force: the normal and the
    /// tangents with friction; where it holds the node together with others, all in which the node is free.
    pub(super) fn held_directions(&self, contact: usize) -> &[Vector] {
        &self.held.get_or_init(|| (0..self.roles.len()).map(|contact| self.directions_held(contact)).collect())[contact]
    }

    fn directions_held(&self, contact: usize) -> Directions {
        let data = &self.loading.contacts[contact];
        let in_frame = |tangents: usize| {
            let frame = self.loading.frame(contact, self.anchor);
            std::iter::once(frame.normal).chain(frame.tangents.into_iter().take(tangents)).collect()
        };
        match self.roles[contact] {
            Role::Stick => in_frame(data.tangents()),
            Role::Held => {
                let free = free_directions(self.loading, data.node);
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

    fn add_slip(&self, contact: usize, iterate: &Iterate, kind: Kind, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        let frame = self.loading.frame(contact, &iterate.state);
        let (row, column) = (self.row_of(contact), self.column_of(contact));
        let friction = self.loading.contacts[contact].friction;
        let normal = iterate.state.reactions[contact].normal;
        let direction = self.direction(contact, &frame, iterate);
        self.put_force(contact, column, &add(&frame.normal, -friction, &direction), matrix);
        self.put_motion(contact, row, &frame.normal, matrix);
        if let Role::Plane { start, turn } = &self.roles[contact] {
            let across = cross(&frame.normal, &direction);
            match kind {
                Kind::Rates => {
                    // The unknown is μ r_n times the turn, so that a node that is hardly pressed makes nothing singular.
                    self.put_force(contact, column + 1, &scaled(&across, -1.0), matrix);
                    self.put_motion(contact, row + 1, &across, matrix);
                }
                Kind::Increment => {
                    // Where the node is hardly pressed a turn changes nothing, and the equations would be singular.
                    let pressed = friction * normal;
                    let pressed = if pressed.abs() < LEAST_PRESSED { LEAST_PRESSED } else { pressed };
                    self.put_force(contact, column + 1, &scaled(&across, -pressed), matrix);
                    let chord = self.chord(contact, &iterate.state);
                    let rule = track::Rule::new(&frame, start, turn, &direction, &chord);
                    self.put_motion(contact, row + 1, &rule.across, matrix);
                    matrix.add(row + 1, column + 1, rule.by_turn);
                }
            }
        }
        let turns_edge = |beside: usize| self.loading.contacts[beside].obstacle.is_curved();
        let turns = matches!(self.roles[contact], Role::Edge { beside, .. } if turns_edge(beside));
        if frame.curvature == 0.0 && !turns {
            return;
        }
        // The reaction turns with the place on the obstacle.
        let dimension = structure.dimension;
        let first = self.loading.contacts[contact].node * dimension;
        let change_with = |motion: &Vector| {
            let drag = self.direction_change(contact, iterate, &direction, motion);
            scaled(&add(&frame.normal_change(motion), -friction, &drag), normal)
        };
        for component in 0..dimension {
            let mut motion = [0.0; 3];
            motion[component] = 1.0;
            let change = change_with(&motion);
            match structure.unknown_of[first + component] {
                Some(unknown) => self.put_force(contact, unknown, &change, matrix),
                None => {
                    let change = scaled(&change, self.loading.support_rate(first + component));
                    self.put_force(contact, structure.unknowns(), &change, matrix);
                }
            }
        }
        let shifted = scaled(&change_with(&self.loading.pattern.shifts[contact]), -1.0);
        self.put_force(contact, structure.unknowns(), &shifted, matrix);
    }

    /// Motion relative to the obstacle since the anchor.
    pub(super) fn chord(&self, contact: usize, state: &State) -> Vector {
        add(&self.loading.relative(contact, state), -1.0, &self.loading.relative(contact, self.anchor))
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

    /// How a slip's direction turns with the place on the obstacle, its own turn apart.
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

    /// Puts the bordering row of a rate into a matrix.
    pub fn border(&self, matrix: &mut (impl Sink + ?Sized), rate: &Rate) {
        let structure = self.loading.structure;
        let (last, load) = (self.size - 1, structure.unknowns());
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            matrix.add(last, unknown, rate.displacement[*freedom]);
        }
        // Supports that move with the load are part of the arc.
        let supports: f64 = self.loading.pattern.supports.iter().zip(&rate.displacement).map(|(a, b)| a * b).sum();
        matrix.add(last, load, rate.load + supports);
    }

    /// Equilibrium and contact equations; returns the largest equilibrium residual and the force scale.
    pub(super) fn residual(&self, iterate: &Iterate, values: &mut DVector<f64>, force: &mut [f64]) -> (f64, f64) {
        let structure = self.loading.structure;
        let (dimension, state) = (structure.dimension, &iterate.state);
        let mut scale = structure.internal_force(&state.displacement, force);
        for (freedom, value) in force.iter_mut().enumerate() {
            let load = state.load * self.loading.pattern.forces[freedom] + self.loading.held.forces[freedom];
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
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } => values[row] = frame.gap,
                Role::Plane { start, turn } => {
                    values[row] = frame.gap;
                    let chord = self.chord(contact, state);
                    let rule = track::Rule::new(&frame, start, turn, &iterate.directions[contact], &chord);
                    values[row + 1] = rule.left_over;
                }
            }
        }
        let mut largest = 0.0_f64;
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            values[unknown] = force[*freedom];
            largest = largest.max(force[*freedom].abs());
        }
        (largest, scale)
    }

    /// Value of the last equation, and its row.
    pub(super) fn place(&self, state: &State, place: Place<'_>, matrix: Option<&mut dyn Sink>) -> f64 {
        let structure = self.loading.structure;
        let (last, unknowns) = (self.size - 1, structure.unknowns());
        match place {
            Place::ArcLength { from, step } if matrix.is_none() => state.distance(from) - step,
            Place::ArcLength { from, step } => {
                let mut chord = Rate {
                    displacement: state.displacement.iter().zip(&from.displacement).map(|(a, b)| a - b).collect(),
                    load: state.load - from.load,
                    reactions: Vec::new(),
                };
                let size = chord.size();
                if let Some(matrix) = matrix {
                    if size > 0.0 {
                        chord.scale(1.0 / size);
                    }
                    self.border(matrix, &chord);
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
        }
    }

    /// Takes a vector of unknowns apart, at a state.
    pub fn rate_from(&self, state: &State, values: &DVector<f64>) -> Rate {
        self.rate_at(&self.iterate(state.clone()), values, Kind::Rates)
    }

    /// `kind` is that of the equations whose solution the values are.
    pub(super) fn rate_at(&self, iterate: &Iterate, values: &DVector<f64>, kind: Kind) -> Rate {
        let structure = self.loading.structure;
        let load = values[structure.unknowns()];
        let mut displacement = vec![0.0; structure.freedoms()];
        for (freedom, value) in displacement.iter_mut().enumerate() {
            *value = match structure.unknown_of[freedom] {
                Some(unknown) => values[unknown],
                None => load * self.loading.support_rate(freedom),
            };
        }
        let mut rate = Rate { displacement, load, reactions: vec![Reaction::default(); self.roles.len()] };
        for (contact, role) in self.roles.iter().enumerate() {
            let column = self.column_of(contact);
            rate.reactions[contact] = match role {
                Role::Free | Role::HeldBy => continue,
                Role::Stick | Role::Held => {
                    let normal = self.loading.frame(contact, self.anchor).normal;
                    let directions = self.held_directions(contact);
                    // In the frame of the contact the first is the normal.
                    let is_normal = directions[0] == normal;
                    let others = directions.iter().enumerate().skip(usize::from(is_normal));
                    let rest = others.fold([0.0; 3], |sum, (k, direction)| add(&sum, values[column + k], direction));
                    if is_normal {
                        Reaction { normal: values[column], tangential: rest }
                    } else {
                        let along = dot(&rest, &normal);
                        Reaction { normal: along, tangential: add(&rest, -along, &normal) }
                    }
                }
                Role::Frictionless => Reaction { normal: values[column], tangential: [0.0; 3] },
                Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                    let frame = self.loading.frame(contact, &iterate.state);
                    let friction = self.loading.contacts[contact].friction;
                    let pressed = friction * iterate.state.reactions[contact].normal;
                    let direction = self.direction(contact, &frame, iterate);
                    let mut tangential = scaled(&direction, -friction * values[column]);
                    if matches!(role, Role::Plane { .. }) {
                        let across = cross(&frame.normal, &direction);
                        let per_turn = if kind == Kind::Rates { 1.0 } else { pressed };
                        tangential = add(&tangential, -per_turn * values[column + 1], &across);
                    }
                    if frame.curvature != 0.0 || matches!(role, Role::Edge { .. }) {
                        let motion = self.loading.relative_rate(contact, &rate);
                        let change = self.direction_change(contact, iterate, &direction, &motion);
                        tangential = add(&tangential, -pressed, &change);
                    }
                    Reaction { normal: values[column], tangential }
                }
            };
        }
        rate
    }

    /// Goes on by minus a Newton correction.
    pub(super) fn corrected_by(&self, iterate: Iterate, values: &DVector<f64>) -> Iterate {
        let correction = self.rate_at(&iterate, values, Kind::Increment);
        let Iterate { mut state, mut directions } = iterate;
        state.advance(&correction, -1.0);
        if self.has_tracks() {
            self.place_exactly(&mut state);
        }
        for (contact, role) in self.roles.iter().enumerate() {
            if let Role::Plane { .. } = role {
                let frame = self.loading.frame(contact, &state);
                let turn = -values[self.column_of(contact) + 1];
                directions[contact] = track::turned(&frame, &directions[contact], turn);
            }
        }
        let mut next = Iterate { state, directions };
        self.make_consistent(&mut next);
        next
    }

    /// Supports and sticking nodes are where they have to be.
    fn place_exactly(&self, state: &mut State) {
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
    pub(super) fn make_consistent(&self, iterate: &mut Iterate) {
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

    /// The modes at an iterate: directions of slip as they are there.
    pub(super) fn modes_at(&self, iterate: &Iterate) -> Vec<Mode> {
        let at = |(contact, mode): (usize, &Mode)| match self.roles[contact] {
            Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                let frame = self.loading.frame(contact, &iterate.state);
                Mode::Slip { direction: self.direction(contact, &frame, iterate) }
            }
            Role::Free | Role::Frictionless | Role::Stick | Role::Held | Role::HeldBy => *mode,
        };
        self.modes.iter().enumerate().map(at).collect()
    }

    /// The path's direction in this mode at its anchor or at a converged point: the null vector of the rate equations, of
    /// unit arc length, on the side of `towards`. `None` where the equations have no such vector or more than one.
    pub fn tangent(&self, corrected: &Corrected, towards: &Rate) -> Option<Rate> {
        let iterate = self.iterate_of(corrected);
        self.tangent_by(&self.bordered(&iterate, towards)?, &iterate)
    }

    pub(super) fn bordered(&self, iterate: &Iterate, towards: &Rate) -> Option<SystemFactorisation> {
        self.factorise(iterate, Kind::Rates, |matrix| self.border(matrix, towards))
    }

    pub(super) fn tangent_by(&self, factorisation: &SystemFactorisation, iterate: &Iterate) -> Option<Rate> {
        let mut values = self.bordering();
        if !factorisation.solve(&mut values) {
            return None;
        }
        self.direction_from(iterate, &values)
    }

    /// The right-hand side whose solution is the path's direction.
    pub(super) fn bordering(&self) -> DVector<f64> {
        let mut values = DVector::zeros(self.size);
        values[self.size - 1] = 1.0;
        values
    }

    /// A solution of the rate equations, of unit arc length.
    pub(super) fn direction_from(&self, iterate: &Iterate, values: &DVector<f64>) -> Option<Rate> {
        let mut rate = self.rate_at(iterate, values, Kind::Rates);
        let size = rate.size();
        if size <= 0.0 || !size.is_finite() {
            return None;
        }
        rate.scale(1.0 / size);
        Some(rate)
    }
}
