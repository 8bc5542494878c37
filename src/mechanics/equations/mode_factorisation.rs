//! Factorisations of the equations, and the constraints of the contacts at their nodes.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::{Holding, Holdings, SparseFactorisation};
use crate::algebra::{Factorisation, Stiffener, SystemFactorisation};
use crate::mechanics::equations::matrix::Stretch;
use crate::mechanics::equations::tolerances::{DENSE_PIVOT_RATIO, SPARSE_PIVOT_RATIO};
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role, matrix};
use crate::mechanics::problem::state::Rate;
use crate::mechanics::structure::elements::Stretching;
use std::sync::Arc;

/// Largest number of unknowns for which digits are saved in this way.
const MOST_APART: usize = 60;

/// The constraints of the closed contacts at each node, in the order of the nodes. A contact that several nodes
/// move belongs to no single node: its rows border the matrix.
pub(crate) fn holdings<'s>(system: &'s ModeSystem<'_>) -> &'s Holdings {
    system.holdings.get_or_init(|| {
        let closed = |contact: &usize| !matches!(system.roles[*contact], Role::Free | Role::HeldBy);
        let mut contacts = Vec::with_capacity(system.roles.len());
        let at_node = |contact: usize| Some((system.loading.contacts[contact].kinematics.node()?, contact));
        contacts.extend((0..system.roles.len()).filter(closed).filter_map(at_node));
        contacts.sort_by_key(|(node, _)| *node);
        let mut holdings = Vec::with_capacity(contacts.len());
        holdings.extend(contacts.chunk_by(|a, b| a.0 == b.0).map(|contacts| holding(system, contacts)));
        Holdings::new(holdings)
    })
}

/// The constraints of closed contacts at their node; each contact is given with the node.
fn holding(system: &ModeSystem<'_>, contacts: &[(usize, usize)]) -> Holding {
    let structure = system.loading.structure;
    let unknowns = structure.unknowns();
    let node = contacts.first().map_or(0, |(node, _)| *node);
    let freedoms = structure.translations_of(node);
    let mut holding = Holding::new(freedoms.filter_map(|freedom| structure.unknown_of[freedom]));
    for (_, contact) in contacts {
        let count = match system.roles[*contact] {
            Role::Free | Role::HeldBy => 0,
            Role::Stick | Role::Held => system.held_directions(*contact).len(),
            Role::Frictionless | Role::Line { .. } | Role::Edge { .. } | Role::Plane { .. } => 1,
        };
        let (row, column) = (system.row_of(*contact) - unknowns, system.column_of(*contact) - unknowns);
        holding.rows.extend(row..row + count);
        holding.columns.extend(column..column + count);
    }
    holding
}

/// Factorises the equations at an iterate; the caller puts in the last row. Where stiff and soft parts meet, so
/// that adding them up would cost too many digits, the stiff parts are kept apart (in dense matrices; for many
/// unknowns solutions are refined instead).
pub(crate) fn factorise(
    system: &ModeSystem<'_>,
    iterate: &Iterate,
    kind: Kind,
    put_last: impl Fn(&mut dyn Sink),
) -> Option<SystemFactorisation> {
    let structure = system.loading.structure;
    let unknowns = structure.unknowns();
    let plain = match factorise_as_it_is(system, iterate, kind, &put_last) {
        Some(SystemFactorisation::Dense(plain)) if plain.pivot_ratio() < DENSE_PIVOT_RATIO => plain,
        Some(SystemFactorisation::Sparse(sparse)) if !is_kept(system, &sparse) => {
            factorise_dense(system, iterate, kind, &put_last)?
        }
        Some(other) => return Some(other),
        None if structure.layout().is_some() && unknowns <= MOST_APART => {
            factorise_dense(system, iterate, kind, &put_last)?
        }
        None => return None,
    };
    if plain.pivot_ratio() >= DENSE_PIVOT_RATIO {
        return Some(SystemFactorisation::Dense(plain));
    }
    let stiffener = |stretching: Stretching| {
        let unknown = |(freedom, value): &(usize, f64)| Some((structure.unknown_of[*freedom]?, *value));
        let rows: Vec<(usize, f64)> = stretching.along.iter().filter_map(unknown).collect();
        let driven = |(freedom, value): &(usize, f64)| match structure.unknown_of[*freedom] {
            None => value * system.loading.support_rate(*freedom),
            Some(_) => 0.0,
        };
        let by_load: f64 = stretching.along.iter().map(driven).sum();
        let columns = rows.iter().copied().chain(std::iter::once((unknowns, by_load))).collect();
        (!rows.is_empty()).then_some(Stiffener { stiffness: stretching.stiffness, rows, columns })
    };
    let stretchings = structure.stretching(&iterate.state.displacement);
    let stiffeners: Vec<Stiffener> = stretchings.into_iter().filter_map(stiffener).collect();
    let mut apart = matrix::assemble_parts(system, iterate, kind, Stretch::Apart);
    put_last(&mut apart);
    Factorisation::stiffened(apart, &stiffeners).or(Some(plain)).map(SystemFactorisation::Dense)
}

/// Whether a sparse factorisation is as accurate as one that keeps stiff and soft parts apart, or must do for many
/// unknowns.
pub(crate) fn is_kept(system: &ModeSystem<'_>, factorisation: &SparseFactorisation) -> bool {
    factorisation.spread() >= SPARSE_PIVOT_RATIO || system.loading.structure.unknowns() > MOST_APART
}

/// Factorises the equations with stiff and soft parts added up.
pub(crate) fn factorise_as_it_is(
    system: &ModeSystem<'_>,
    iterate: &Iterate,
    kind: Kind,
    put_last: impl Fn(&mut dyn Sink),
) -> Option<SystemFactorisation> {
    if let Some(mut matrix) = matrix::assemble_sparse(system, iterate, kind) {
        put_last(&mut matrix);
        let factorisation = SparseFactorisation::new(matrix, holdings(system))?;
        return Some(SystemFactorisation::Sparse(Arc::new(factorisation)));
    }
    factorise_dense(system, iterate, kind, put_last).map(SystemFactorisation::Dense)
}

fn factorise_dense(
    system: &ModeSystem<'_>,
    iterate: &Iterate,
    kind: Kind,
    put_last: impl Fn(&mut dyn Sink),
) -> Option<Factorisation> {
    let mut matrix = matrix::assemble_dense(system, iterate, kind);
    put_last(&mut matrix);
    Factorisation::new(matrix)
}

pub(crate) fn factorise_bordered(
    system: &ModeSystem<'_>,
    iterate: &Iterate,
    towards: &Rate,
) -> Option<SystemFactorisation> {
    factorise(system, iterate, Kind::Rates, |matrix| matrix::border(system, matrix, towards))
}
