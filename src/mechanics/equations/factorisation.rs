//! Factorisations of the equations, and the constraints of the contacts at their nodes.

use crate::algebra::dense::assembly::Sink;
use crate::algebra::sparse::{Holding, Holdings, SparseFactorisation};
use crate::algebra::{Factorisation, Stiffener, SystemFactorisation};
use crate::mechanics::equations::matrix::Stretch;
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role};
use crate::mechanics::problem::state::Rate;
use crate::mechanics::structure::elements::Stretching;
use std::sync::Arc;

/// Ratio of the smallest to the largest pivot below which the digits lost are worth the larger system that saves them.
const SPREAD: f64 = 1e-4;
/// The same ratio where small pivots were raised and corrected by borders: the pivots that remain are little larger.
const SPREAD_AT_LEAST: f64 = 1e-5;
/// Largest number of unknowns for which digits are saved in this way.
const MOST_APART: usize = 200;

impl ModeSystem<'_> {
    /// The constraints of the closed contacts at each node, in the order of the nodes. A contact that several nodes
    /// move belongs to no single node: its rows border the matrix.
    pub(crate) fn holdings(&self) -> &Holdings {
        self.holdings.get_or_init(|| {
            let closed = |contact: &usize| !matches!(self.roles[*contact], Role::Free | Role::HeldBy);
            let mut contacts = Vec::with_capacity(self.roles.len());
            let at_node = |contact: usize| Some((self.loading.contacts[contact].kinematics.node()?, contact));
            contacts.extend((0..self.roles.len()).filter(closed).filter_map(at_node));
            contacts.sort_by_key(|(node, _)| *node);
            let mut holdings = Vec::with_capacity(contacts.len());
            holdings.extend(contacts.chunk_by(|a, b| a.0 == b.0).map(|contacts| self.holding(contacts)));
            Holdings::new(holdings)
        })
    }

    /// The constraints of closed contacts at their node; each contact is given with the node.
    fn holding(&self, contacts: &[(usize, usize)]) -> Holding {
        let structure = self.loading.structure;
        let unknowns = structure.unknowns();
        let node = contacts.first().map_or(0, |(node, _)| *node);
        let freedoms = structure.translations_of(node);
        let mut holding = Holding::new(freedoms.filter_map(|freedom| structure.unknown_of[freedom]));
        for (_, contact) in contacts {
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

    /// Factorises the equations at an iterate; the caller puts in the last row. Where stiff and soft parts meet, so
    /// that adding them up would cost too many digits, the stiff parts are kept apart (in dense matrices; for many
    /// unknowns solutions are refined instead).
    pub(crate) fn factorise(
        &self,
        iterate: &Iterate,
        kind: Kind,
        put_last: impl Fn(&mut dyn Sink),
    ) -> Option<SystemFactorisation> {
        let structure = self.loading.structure;
        let unknowns = structure.unknowns();
        let plain = match self.factorise_as_it_is(iterate, kind, &put_last) {
            Some(SystemFactorisation::Dense(plain)) if plain.pivot_ratio() < SPREAD => plain,
            Some(SystemFactorisation::Sparse(sparse)) if !self.is_kept(&sparse) => {
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

    /// Whether a sparse factorisation is as accurate as one that keeps stiff and soft parts apart, or must do for many
    /// unknowns.
    pub(crate) fn is_kept(&self, factorisation: &SparseFactorisation) -> bool {
        factorisation.spread() >= SPREAD_AT_LEAST || self.loading.structure.unknowns() > MOST_APART
    }

    /// Factorises the equations with stiff and soft parts added up.
    pub(crate) fn factorise_as_it_is(
        &self,
        iterate: &Iterate,
        kind: Kind,
        put_last: impl Fn(&mut dyn Sink),
    ) -> Option<SystemFactorisation> {
        if let Some(mut matrix) = self.assemble_sparse(iterate, kind) {
            put_last(&mut matrix);
            let factorisation = SparseFactorisation::new(matrix, self.holdings())?;
            return Some(SystemFactorisation::Sparse(Arc::new(factorisation)));
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

    pub(crate) fn bordered(&self, iterate: &Iterate, towards: &Rate) -> Option<SystemFactorisation> {
        self.factorise(iterate, Kind::Rates, |matrix| self.border(matrix, towards))
    }
}
