//! The matrix of the equations, dense and sparse.

use crate::algebra::dense::assembly::Sink;
use crate::algebra::sparse::Bordered;
use crate::mechanics::contact::vector::{Vector, cross, dot, scaled};
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role, Track, slip_integration};
use crate::mechanics::problem::contact_motion;
use crate::mechanics::problem::node_forces::force;
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::DMatrix;

/// Whether the stretching stiffness of the elements is within the matrix or kept apart.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stretch {
    Within,
    Apart,
}

/// Lower bound on the friction force (dimensionless) in Newton's matrix.
const LEAST_PRESSED: f64 = 1e-10;

impl ModeSystem<'_> {
    /// The matrix of the rate equations at a state; the last row is left zero for the bordering equation.
    pub fn matrix(&self, state: &State) -> DMatrix<f64> {
        self.assemble(&self.iterate(state.clone()), Kind::Rates)
    }

    /// The dense matrix of the equations; the last row is left zero.
    pub(crate) fn assemble(&self, iterate: &Iterate, kind: Kind) -> DMatrix<f64> {
        self.assemble_parts(iterate, kind, Stretch::Within)
    }

    pub(super) fn assemble_parts(&self, iterate: &Iterate, kind: Kind, stretch: Stretch) -> DMatrix<f64> {
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
        self.add_still(&mut matrix);
        matrix
    }

    /// Adds the columns of the load factor and of the contacts, and the rows of the contacts.
    fn add_loads_and_contacts(&self, iterate: &Iterate, kind: Kind, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            matrix.add(unknown, structure.unknowns(), -self.loading.pattern.forces[*freedom]);
        }
        for (contact, role) in self.roles.iter().enumerate() {
            match role {
                Role::Free | Role::HeldBy => {}
                Role::Stick | Role::Held => self.add_stick(contact, &iterate.state, matrix),
                Role::Frictionless | Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                    self.add_slip(contact, iterate, kind, matrix);
                }
            }
        }
    }

    /// The sparse matrix of the equations, with the last row left zero; `None` for a structure whose matrices are
    /// dense, and where motions are suppressed.
    pub(crate) fn assemble_sparse(&self, iterate: &Iterate, kind: Kind) -> Option<Bordered> {
        let structure = self.loading.structure;
        let layout = structure.layout().filter(|_| !self.holds_still())?;
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

    /// Adds a row `vector·(relative motion)` at a state.
    fn put_motion(&self, contact: usize, state: &State, row: usize, vector: &Vector, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        let load = structure.unknowns();
        self.loading.each_column(contact, state, |freedom, column| match structure.unknown_of[freedom] {
            Some(unknown) => matrix.add(row, unknown, dot(vector, column)),
            None => matrix.add(row, load, dot(vector, column) * self.loading.support_rate(freedom)),
        });
        matrix.add(row, load, -dot(vector, &self.loading.pattern.shifts[contact]));
    }

    /// Adds a column of the equilibrium equations: the negative of a contact's force at a state.
    fn put_force(&self, contact: usize, state: &State, column: usize, force: &Vector, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        self.loading.each_column(contact, state, |freedom, motion| {
            if let Some(unknown) = structure.unknown_of[freedom] {
                matrix.add(unknown, column, -dot(force, motion));
            }
        });
    }

    /// Adds the change of a contact's force columns with the displacements of the nodes that move it, at a constant
    /// force.
    fn add_curvature(&self, contact: usize, state: &State, matrix: &mut impl Sink) {
        let structure = self.loading.structure;
        let data = &self.loading.contacts[contact];
        if data.kinematics.node().is_some() {
            return;
        }
        let force = force(&self.loading.frame(contact, state), &state.reactions[contact]);
        contact_motion::each_curvature(structure, data, &state.displacement, &force, |row, column, value| {
            let Some(row) = structure.unknown_of[row] else { return };
            match structure.unknown_of[column] {
                Some(column) => matrix.add(row, column, -value),
                None => matrix.add(row, structure.unknowns(), -value * self.loading.support_rate(column)),
            }
        });
    }

    fn add_stick(&self, contact: usize, state: &State, matrix: &mut impl Sink) {
        let (row, column) = (self.row_of(contact), self.column_of(contact));
        for (k, direction) in self.held_directions(contact).iter().enumerate() {
            self.put_force(contact, state, column + k, direction, matrix);
            self.put_motion(contact, state, row + k, direction, matrix);
        }
        self.add_curvature(contact, state, matrix);
    }

    fn add_slip(&self, contact: usize, iterate: &Iterate, kind: Kind, matrix: &mut impl Sink) {
        let (structure, state) = (self.loading.structure, &iterate.state);
        let frame = self.loading.frame(contact, state);
        let (row, column) = (self.row_of(contact), self.column_of(contact));
        let friction = self.loading.contacts[contact].friction;
        let normal = iterate.state.reactions[contact].normal;
        let direction = self.direction(contact, &frame, iterate);
        self.put_force(contact, state, column, &friction.force_direction(&frame.normal, &direction), matrix);
        self.put_motion(contact, state, row, &frame.normal, matrix);
        self.add_curvature(contact, state, matrix);
        if let Role::Plane { track } = self.roles[contact] {
            let Track { start, turn } = &self.tracks[track];
            let across = cross(&frame.normal, &direction);
            match kind {
                Kind::Rates => {
                    // The unknown is μ r_n times the turn, so that a small normal reaction does not make the matrix
                    // singular.
                    self.put_force(contact, state, column + 1, &scaled(&across, -1.0), matrix);
                    self.put_motion(contact, state, row + 1, &across, matrix);
                }
                Kind::Increment => {
                    // Where the normal reaction vanishes, a turn would change nothing and the equations would be
                    // singular.
                    let pressed = friction.bound(normal);
                    let pressed = if pressed.abs() < LEAST_PRESSED { LEAST_PRESSED } else { pressed };
                    self.put_force(contact, state, column + 1, &scaled(&across, -pressed), matrix);
                    let chord = self.chord(contact, &iterate.state);
                    let rule = slip_integration::Rule::new(&frame, start, turn, &direction, &chord);
                    self.put_motion(contact, state, row + 1, &rule.across, matrix);
                    matrix.add(row + 1, column + 1, rule.by_turn);
                }
            }
        }
        let turns_edge = |beside: usize| self.loading.contacts[beside].obstacle.is_curved();
        let turns = matches!(self.roles[contact], Role::Edge { beside, .. } if turns_edge(beside));
        if frame.curvature == 0.0 && !turns {
            return;
        }
        // The reaction turns with the position on the obstacle.
        let change_with = |motion: &Vector| {
            let drag = self.direction_change(contact, iterate, &direction, motion);
            scaled(&friction.force_direction(&frame.normal_change(motion), &drag), normal)
        };
        self.loading.each_column(contact, state, |freedom, motion| {
            let change = change_with(motion);
            match structure.unknown_of[freedom] {
                Some(unknown) => self.put_force(contact, state, unknown, &change, matrix),
                None => {
                    let change = scaled(&change, self.loading.support_rate(freedom));
                    self.put_force(contact, state, structure.unknowns(), &change, matrix);
                }
            }
        });
        let shifted = scaled(&change_with(&self.loading.pattern.shifts[contact]), -1.0);
        self.put_force(contact, state, structure.unknowns(), &shifted, matrix);
    }

    /// Adds the bordering row of a rate to a matrix, as its last row.
    pub fn border(&self, matrix: &mut (impl Sink + ?Sized), rate: &Rate) {
        self.border_along(matrix, |freedom| rate.displacement[freedom], rate.load);
    }

    /// Adds the bordering row with given entries for the degrees of freedom and for the load.
    pub(super) fn border_along(
        &self,
        matrix: &mut (impl Sink + ?Sized),
        of_freedom: impl Fn(usize) -> f64,
        of_load: f64,
    ) {
        self.border_row(self.size - 1, matrix, of_freedom, of_load);
    }

    /// Adds a bordering row in any row of a matrix.
    pub(crate) fn border_row(
        &self,
        row: usize,
        matrix: &mut (impl Sink + ?Sized),
        of_freedom: impl Fn(usize) -> f64,
        of_load: f64,
    ) {
        let structure = self.loading.structure;
        let load = structure.unknowns();
        for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
            matrix.add(row, unknown, of_freedom(*freedom));
        }
        // Supports that move with the load contribute to the arc length.
        let supports = self.loading.pattern.supports.iter().enumerate();
        let supports: f64 = supports.map(|(freedom, motion)| motion * of_freedom(freedom)).sum();
        matrix.add(row, load, of_load + supports);
    }
}
