//! The matrix of the equations, dense and sparse.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::Bordered;
use crate::mechanics::contact::vector::{Vector, cross, dot, scaled};
use crate::mechanics::equations::tolerances::SMALLEST_FRICTION_FORCE;
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role, SuppressedMotion, Track, slip_integration};
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::node_contact_forces::force;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::structure::Structure;
use crate::mechanics::structure::elements::FiniteElement;
use nalgebra::DMatrix;

/// Whether the stretching stiffness of the elements is within the matrix or kept apart.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stretch {
    Within,
    Apart,
}

/// The matrix of the rate equations at a state; the last row is left zero for the bordering equation.
pub fn rate_matrix(system: &ModeSystem<'_>, state: &State) -> DMatrix<f64> {
    assemble_dense(system, &system.iterate(state.clone()), Kind::Rates)
}

/// The dense matrix of the equations; the last row is left zero.
pub(crate) fn assemble_dense(system: &ModeSystem<'_>, iterate: &Iterate, kind: Kind) -> DMatrix<f64> {
    assemble_parts(system, iterate, kind, Stretch::Within)
}

pub(super) fn assemble_parts(system: &ModeSystem<'_>, iterate: &Iterate, kind: Kind, stretch: Stretch) -> DMatrix<f64> {
    let structure = system.loading.structure;
    let mut matrix = DMatrix::zeros(system.size, system.size);
    let support_rate = |freedom: usize| system.loading.support_rate(freedom);
    let add = |row: usize, column: usize, value: f64| matrix[(row, column)] += value;
    match stretch {
        Stretch::Within => each_stiffness(structure, iterate, &mut structure.over_unknowns(support_rate, add)),
        Stretch::Apart => each_stiffness_across(structure, iterate, &mut structure.over_unknowns(support_rate, add)),
    }
    add_loads_and_contacts(system, iterate, kind, &mut matrix);
    add_suppressed(system, &mut matrix);
    matrix
}

/// Calls `add(row, column, value)` for every entry of the tangent at an iterate.
fn each_stiffness(structure: &Structure, iterate: &Iterate, add: &mut impl FnMut(usize, usize, f64)) {
    let displacement = &iterate.state.displacement;
    match &iterate.forces {
        None => structure.each_stiffness(displacement, add),
        Some(forces) => {
            let whole = |element: &dyn FiniteElement, own: &[f64], out: &mut [f64]| element.write_stiffness(own, out);
            forces.each_stiffness(structure, displacement, whole, add);
        }
    }
}

/// As [`each_stiffness`], without the summands that `Structure::stretching` lists.
fn each_stiffness_across(structure: &Structure, iterate: &Iterate, add: &mut impl FnMut(usize, usize, f64)) {
    let displacement = &iterate.state.displacement;
    let across = |element: &dyn FiniteElement, own: &[f64], out: &mut [f64]| element.write_stiffness_across(own, out);
    match &iterate.forces {
        None => structure.each_stiffness_across(displacement, add),
        Some(forces) => forces.each_stiffness(structure, displacement, across, add),
    }
}

/// Adds `Σ_j ψ_j φ_jᵀ` of the suppressed motions.
fn add_suppressed(system: &ModeSystem<'_>, matrix: &mut DMatrix<f64>) {
    for SuppressedMotion { column, row } in &system.suppressed {
        for (place, share) in row.iter().enumerate().filter(|(_, share)| **share != 0.0) {
            column.iter().enumerate().for_each(|(equation, value)| matrix.add(equation, place, value * share));
        }
    }
}

/// Adds the columns of the load factor and of the contacts, and the rows of the contacts.
fn add_loads_and_contacts(system: &ModeSystem<'_>, iterate: &Iterate, kind: Kind, matrix: &mut impl Sink) {
    let structure = system.loading.structure;
    for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
        matrix.add(unknown, structure.unknowns(), -system.loading.pattern.forces[*freedom]);
    }
    for (contact, role) in system.roles.iter().enumerate() {
        match role {
            Role::Free | Role::HeldBy => {}
            Role::Stick | Role::Held => add_stick(system, contact, &iterate.state, matrix),
            Role::Frictionless | Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => {
                add_slip(system, contact, iterate, kind, matrix);
            }
        }
    }
}

/// The sparse matrix of the equations, with the last row left zero; `None` for a structure whose matrices are
/// dense, and where motions are suppressed.
pub(crate) fn assemble_sparse(system: &ModeSystem<'_>, iterate: &Iterate, kind: Kind) -> Option<Bordered> {
    let structure = system.loading.structure;
    let layout = structure.layout().filter(|_| !system.is_deflated())?;
    let unknowns = structure.unknowns();
    let mut matrix = Bordered::new(layout.pattern.clone(), system.size - unknowns);
    let mut places = layout.places();
    each_stiffness(structure, iterate, &mut |row, column, value| match places.next().flatten() {
        Some(place) => matrix.add_at(place, value),
        None => {
            if let (Some(row), None) = (structure.unknown_of[row], structure.unknown_of[column]) {
                matrix.add(row, unknowns, value * system.loading.support_rate(column));
            }
        }
    });
    matrix.let_differ(&layout.unsymmetric);
    add_loads_and_contacts(system, iterate, kind, &mut matrix);
    Some(matrix)
}

/// Adds a row `vector·(relative motion)` at a state.
fn put_motion(
    system: &ModeSystem<'_>,
    contact: usize,
    state: &State,
    row: usize,
    vector: &Vector,
    matrix: &mut impl Sink,
) {
    let structure = system.loading.structure;
    let load = structure.unknowns();
    system.loading.each_column(contact, state, |freedom, column| match structure.unknown_of[freedom] {
        Some(unknown) => matrix.add(row, unknown, dot(vector, column)),
        None => matrix.add(row, load, dot(vector, column) * system.loading.support_rate(freedom)),
    });
    matrix.add(row, load, -dot(vector, &system.loading.pattern.shifts[contact]));
}

/// Adds a column of the equilibrium equations: the negative of a contact's force at a state.
fn put_force(
    system: &ModeSystem<'_>,
    contact: usize,
    state: &State,
    column: usize,
    force: &Vector,
    matrix: &mut impl Sink,
) {
    let structure = system.loading.structure;
    system.loading.each_column(contact, state, |freedom, motion| {
        if let Some(unknown) = structure.unknown_of[freedom] {
            matrix.add(unknown, column, -dot(force, motion));
        }
    });
}

/// Adds the change of a contact's force columns with the displacements of the nodes that move it, at a constant
/// force.
fn add_curvature(system: &ModeSystem<'_>, contact: usize, state: &State, matrix: &mut impl Sink) {
    let structure = system.loading.structure;
    let data = &system.loading.contacts[contact];
    if data.kinematics.node().is_some() {
        return;
    }
    let force = force(&system.loading.frame(contact, state), &state.reactions[contact]);
    let support_rate = |freedom: usize| system.loading.support_rate(freedom);
    let mut add = structure.over_unknowns(support_rate, |row, column, value| matrix.add(row, column, value));
    contact_jacobian::each_curvature(structure, data, &state.displacement, &force, |row, column, value| {
        add(row, column, -value);
    });
}

fn add_stick(system: &ModeSystem<'_>, contact: usize, state: &State, matrix: &mut impl Sink) {
    let (row, column) = (system.row_of(contact), system.column_of(contact));
    for (k, direction) in system.held_directions(contact).iter().enumerate() {
        put_force(system, contact, state, column + k, direction, matrix);
        put_motion(system, contact, state, row + k, direction, matrix);
    }
    add_curvature(system, contact, state, matrix);
}

fn add_slip(system: &ModeSystem<'_>, contact: usize, iterate: &Iterate, kind: Kind, matrix: &mut impl Sink) {
    let (structure, state) = (system.loading.structure, &iterate.state);
    let frame = system.loading.frame(contact, state);
    let (row, column) = (system.row_of(contact), system.column_of(contact));
    let friction = system.loading.contacts[contact].friction;
    let normal = iterate.state.reactions[contact].normal;
    let direction = system.direction(contact, &frame, iterate);
    put_force(system, contact, state, column, &friction.force_direction(&frame.normal, &direction), matrix);
    put_motion(system, contact, state, row, &frame.normal, matrix);
    add_curvature(system, contact, state, matrix);
    if let Role::Plane { track } = system.roles[contact] {
        let Track { start, turn } = &system.tracks[track];
        let across = cross(&frame.normal, &direction);
        match kind {
            Kind::Rates => {
                // The unknown is μ r_n times the turn, so that a small normal reaction does not make the matrix
                // singular.
                put_force(system, contact, state, column + 1, &scaled(&across, -1.0), matrix);
                put_motion(system, contact, state, row + 1, &across, matrix);
            }
            Kind::Increment => {
                // Where the normal reaction vanishes, a turn would change nothing and the equations would be
                // singular.
                let pressed = friction.bound(normal);
                let pressed = if pressed.abs() < SMALLEST_FRICTION_FORCE { SMALLEST_FRICTION_FORCE } else { pressed };
                put_force(system, contact, state, column + 1, &scaled(&across, -pressed), matrix);
                let chord = system.chord(contact, &iterate.state);
                let rule = slip_integration::Rule::new(&frame, start, turn, &direction, &chord);
                put_motion(system, contact, state, row + 1, &rule.across, matrix);
                matrix.add(row + 1, column + 1, rule.by_turn);
            }
        }
    }
    let turns_edge = |beside: usize| system.loading.contacts[beside].obstacle.is_curved();
    let turns = matches!(system.roles[contact], Role::Edge { beside, .. } if turns_edge(beside));
    if frame.curvature.is_zero() && !turns {
        return;
    }
    // The reaction turns with the position on the obstacle.
    let change_with = |motion: &Vector| {
        let drag = system.direction_change(contact, iterate, &direction, motion);
        scaled(&friction.force_direction(&frame.normal_change(motion), &drag), normal)
    };
    system.loading.each_column(contact, state, |freedom, motion| {
        let change = change_with(motion);
        match structure.unknown_of[freedom] {
            Some(unknown) => put_force(system, contact, state, unknown, &change, matrix),
            None => {
                let change = scaled(&change, system.loading.support_rate(freedom));
                put_force(system, contact, state, structure.unknowns(), &change, matrix);
            }
        }
    });
    let shifted = scaled(&change_with(&system.loading.pattern.shifts[contact]), -1.0);
    put_force(system, contact, state, structure.unknowns(), &shifted, matrix);
}

/// Adds the bordering row of a rate to a matrix, as its last row.
pub fn border(system: &ModeSystem<'_>, matrix: &mut (impl Sink + ?Sized), rate: &Rate) {
    border_along(system, matrix, |freedom| rate.displacement[freedom], rate.load);
}

/// Adds the bordering row with given entries for the degrees of freedom and for the load.
pub(super) fn border_along(
    system: &ModeSystem<'_>,
    matrix: &mut (impl Sink + ?Sized),
    of_freedom: impl Fn(usize) -> f64,
    of_load: f64,
) {
    border_row(system, system.size - 1, matrix, of_freedom, of_load);
}

/// Adds a bordering row in any row of a matrix.
pub(crate) fn border_row(
    system: &ModeSystem<'_>,
    row: usize,
    matrix: &mut (impl Sink + ?Sized),
    of_freedom: impl Fn(usize) -> f64,
    of_load: f64,
) {
    let structure = system.loading.structure;
    let load = structure.unknowns();
    for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
        matrix.add(row, unknown, of_freedom(*freedom));
    }
    // Supports that move with the load contribute to the arc length.
    let supports = system.loading.pattern.supports.iter().enumerate();
    let supports: f64 = supports.map(|(freedom, motion)| motion * of_freedom(freedom)).sum();
    matrix.add(row, load, of_load + supports);
}
