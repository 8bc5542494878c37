//! The rate equations condensed on the contacts that can change, and the directions of each contact mode.
//!
//! With `v` the velocities of those contacts and `τ` the coordinate along the held structure's own direction `z₀`,
//! `(u̇, ṡ, ṙ) = Z v + z₀ τ`; a mode picks one linear equation for each velocity and leaves a line, taken in both senses.
//! The inequalities are those listed in `directions`. Here they become the forms and entities of a rate problem, and
//! `rates` finds its rays.

use super::directions::{Candidate, Found, RANK, WEAK, is_mechanism, merge};
use super::mode_system::{Loading, ModeSystem};
use super::rates::{self, Choice, Entity, RateProblem, Ray, Touching};
use super::standing::Standing;
use super::state::{Rate, State, along};
use crate::cancel::CancelFlag;
use crate::contact::{Mode, Reaction};
use crate::linear_algebra::{Factorisation, null_space};
use nalgebra::{DMatrix, DVector};

/// A velocity of a changeable contact.
#[derive(Debug, Clone, Copy)]
enum Velocity {
    Normal,
    Tangential,
}

/// A changeable contact with the places of its velocities among the columns, and its reaction rates as linear forms.
struct Changeable {
    contact: usize,
    standing: Standing,
    friction: f64,
    normal_column: Option<usize>,
    tangential_column: Option<usize>,
    normal_rate: DVector<f64>,
    tangential_rate: DVector<f64>,
    /// Size of the pressing reaction: what a unit of slip dissipates is `μ` times this.
    normal: f64,
}

/// The rate equations condensed on the changeable contacts: column `j` is the full rate for unit `v_j`, the last one
/// is `z₀`.
pub(super) struct Condensed<'a> {
    loading: Loading<'a>,
    columns: Vec<Rate>,
    changeable: Vec<Changeable>,
}

impl<'a> Condensed<'a> {
    /// `None` where the held structure has more than one independent direction.
    pub(super) fn new(
        system: &ModeSystem<'_>,
        loading: Loading<'a>,
        state: &State,
        standings: &[Standing],
        incoming: Option<&Rate>,
    ) -> Option<Self> {
        let factorisation = bordered(system, loading, state, incoming)?;
        let mut changeable = Vec::new();
        let mut velocities = Vec::new();
        for (contact, standing) in standings.iter().enumerate() {
            let friction = loading.contacts[contact].friction;
            let mut place = |velocity: Velocity| {
                velocities.push((contact, velocity));
                Some(velocities.len() - 1)
            };
            let (normal_column, tangential_column) = match standing {
                Standing::Settled(_) => continue,
                Standing::OnCone { .. } => (None, place(Velocity::Tangential)),
                Standing::Touching if friction > 0.0 => (place(Velocity::Normal), place(Velocity::Tangential)),
                Standing::Touching => (place(Velocity::Normal), None),
            };
            changeable.push(Changeable {
                contact,
                standing: *standing,
                friction,
                normal_column,
                tangential_column,
                normal_rate: DVector::zeros(0),
                tangential_rate: DVector::zeros(0),
                normal: state.reactions[contact].normal,
            });
        }
        let mut columns = Vec::with_capacity(velocities.len() + 1);
        for (contact, velocity) in velocities {
            let mut values = DVector::zeros(system.size());
            let offset = match velocity {
                Velocity::Normal => 0,
                Velocity::Tangential => 1,
            };
            values[system.row_of(contact) + offset] = 1.0;
            if !factorisation.solve(&mut values) {
                return None;
            }
            columns.push(system.rate_from(&values));
        }
        let mut values = DVector::zeros(system.size());
        values[system.size() - 1] = 1.0;
        if !factorisation.solve(&mut values) {
            return None;
        }
        columns.push(system.rate_from(&values));
        for entry in &mut changeable {
            let reaction = |column: &Rate| column.reactions[entry.contact];
            entry.normal_rate = DVector::from_iterator(columns.len(), columns.iter().map(|c| reaction(c).normal));
            entry.tangential_rate =
                DVector::from_iterator(columns.len(), columns.iter().map(|c| reaction(c).tangential[0]));
        }
        Some(Self { loading, columns, changeable })
    }

    /// Options of one contact, holding first.
    fn options(&self, entry: &Changeable) -> Vec<Mode> {
        match entry.standing {
            Standing::Settled(mode) => vec![mode],
            Standing::OnCone { direction } => vec![Mode::Stick, Mode::Slip { direction }],
            Standing::Touching if entry.friction > 0.0 => vec![
                Mode::Stick,
                Mode::Slip { direction: [1.0, 0.0] },
                Mode::Slip { direction: [-1.0, 0.0] },
                Mode::Free,
            ],
            Standing::Touching => vec![Mode::Slip { direction: [0.0; 2] }, Mode::Free],
        }
    }

    /// The rate problem of these contacts, with options in the order of [`Self::options`].
    pub(super) fn problem(&self) -> RateProblem {
        let mut forms = Forms { columns: self.columns.len(), rows: Vec::new(), is_force: Vec::new() };
        let entities = self.changeable.iter().map(|entry| forms.add_contact(entry)).collect();
        let freedoms = self.columns[0].displacement.len();
        let motion = DMatrix::from_fn(freedoms + 1, self.columns.len(), |row, column| {
            if row < freedoms { self.columns[column].displacement[row] } else { self.columns[column].load }
        });
        let contacts = self.columns[0].reactions.len();
        let reactions = DMatrix::from_fn(3 * contacts, self.columns.len(), |row, column| {
            let reaction = self.columns[column].reactions[row / 3];
            [reaction.normal, reaction.tangential[0], reaction.tangential[1]][row % 3]
        });
        RateProblem {
            forms: DMatrix::from_fn(forms.rows.len(), self.columns.len(), |row, column| forms.rows[row][column]),
            is_force: forms.is_force,
            entities,
            motion,
            reactions,
        }
    }

    /// Lists the directions, by branch and bound over the contacts' options.
    pub(super) fn enumerate(
        &self,
        held: &[Mode],
        state: &State,
        incoming: Option<&Rate>,
        most_modes: u64,
        cancel: &CancelFlag,
        found: &mut Found,
    ) {
        let problem = self.problem();
        let mut first = vec![vec![0; self.changeable.len()]];
        if let Some(rate) = incoming {
            first.extend(rates::near(&problem, &self.weights_of(rate)));
        }
        let findings = rates::explore(&problem, &first, most_modes, cancel);
        found.unexplored = findings.unexplored;
        found.degenerate |= findings.degenerate;
        for basis in &findings.planes {
            found.mechanism |= basis.column_iter().any(|column| {
                let (rate, _) = self.combine(&column.into_owned());
                is_mechanism(self.loading, state, &rate)
            });
        }
        for ray in &findings.rays {
            self.add(ray, held, found);
        }
    }

    /// The weights that come nearest to a rate: its velocities, and what it has along `z₀`.
    fn weights_of(&self, rate: &Rate) -> DVector<f64> {
        let dimension = self.loading.structure.dimension;
        let last = self.columns.len() - 1;
        let mut weights = DVector::zeros(last + 1);
        for entry in &self.changeable {
            let contact = &self.loading.contacts[entry.contact];
            let node = &rate.displacement[contact.node * dimension..(contact.node + 1) * dimension];
            if let Some(column) = entry.normal_column {
                weights[column] = along(node, &contact.obstacle.normal());
            }
            if let Some(column) = entry.tangential_column {
                weights[column] = along(node, &contact.obstacle.tangents(dimension)[0]);
            }
        }
        let mut rest = rate.clone();
        for (column, weight) in self.columns.iter().zip(weights.iter()).take(last) {
            rest.displacement.iter_mut().zip(&column.displacement).for_each(|(sum, value)| *sum -= weight * value);
            rest.load -= weight * column.load;
        }
        let own = &self.columns[last];
        weights[last] = own.product(&rest) / own.product(own);
        weights
    }

    /// Adds a ray as a candidate direction.
    fn add(&self, ray: &Ray, held: &[Mode], found: &mut Found) {
        let (mut rate, weights) = self.combine(&ray.weights);
        let mut modes = held.to_vec();
        for (entry, &choice) in self.changeable.iter().zip(&ray.chosen) {
            let mode = self.options(entry)[choice];
            modes[entry.contact] = mode;
            match mode {
                Mode::Free => rate.reactions[entry.contact] = Reaction::default(),
                Mode::Stick => {}
                Mode::Slip { direction } => {
                    let drag = -entry.friction * rate.reactions[entry.contact].normal;
                    rate.reactions[entry.contact].tangential = [drag * direction[0], drag * direction[1]];
                }
            }
        }
        let dissipation = self.dissipation(&weights);
        merge(found, Candidate { rate, labels: vec![modes], weak: ray.weak, dissipation });
    }

    /// The rate of unit arc length for weights of the columns, and the weights that give it; of no size where the
    /// weights move nothing.
    pub(super) fn combine(&self, weights: &DVector<f64>) -> (Rate, DVector<f64>) {
        let mut rate = self.columns[0].clone();
        rate.scale(weights[0]);
        for (column, weight) in self.columns.iter().zip(weights.iter()).skip(1) {
            rate.displacement.iter_mut().zip(&column.displacement).for_each(|(sum, value)| *sum += weight * value);
            rate.load += weight * column.load;
            for (sum, value) in rate.reactions.iter_mut().zip(&column.reactions) {
                sum.normal += weight * value.normal;
                sum.tangential[0] += weight * value.tangential[0];
                sum.tangential[1] += weight * value.tangential[1];
            }
        }
        let size = rate.size();
        if size > WEAK * rate.largest_reaction() {
            rate.scale(1.0 / size);
            (rate, weights / size)
        } else {
            rate.scale(0.0);
            (rate, weights.clone())
        }
    }

    fn dissipation(&self, weights: &DVector<f64>) -> f64 {
        self.changeable
            .iter()
            .map(|entry| match (entry.standing, entry.tangential_column) {
                (Standing::OnCone { direction }, Some(column)) => {
                    entry.friction * entry.normal * direction[0] * weights[column]
                }
                _ => 0.0,
            })
            .sum()
    }
}

/// Linear forms of the rate problem as they are made.
struct Forms {
    columns: usize,
    rows: Vec<DVector<f64>>,
    is_force: Vec<bool>,
}

impl Forms {
    fn velocity(&mut self, column: usize, sign: f64) -> usize {
        self.rows.push(DVector::from_fn(self.columns, |row, _| if row == column { sign } else { 0.0 }));
        self.is_force.push(false);
        self.rows.len() - 1
    }

    fn force(&mut self, rate: DVector<f64>) -> usize {
        self.rows.push(rate);
        self.is_force.push(true);
        self.rows.len() - 1
    }

    /// The options of one contact as equations and inequalities on the weights.
    fn add_contact(&mut self, entry: &Changeable) -> Entity {
        match (entry.standing, entry.normal_column, entry.tangential_column) {
            (Standing::Settled(_), _, _) | (_, None, None) => {
                Entity { options: vec![Choice::default()], touching: None }
            }
            (Standing::OnCone { direction }, _, Some(column)) => {
                let along = self.velocity(column, direction[0]);
                let slack = self.force(&entry.normal_rate * entry.friction + &entry.tangential_rate * direction[0]);
                Entity::complementary(slack, along)
            }
            (_, Some(column), None) => {
                let gap = self.velocity(column, 1.0);
                let pressing = self.force(entry.normal_rate.clone());
                Entity::complementary(pressing, gap)
            }
            (_, normal, Some(tangential)) => {
                let gap = self.velocity(normal.unwrap_or(tangential), 1.0);
                let along = self.velocity(tangential, 1.0);
                let pressing = self.force(entry.normal_rate.clone());
                let traction = self.force(entry.tangential_rate.clone());
                let forward = self.force(&entry.normal_rate * entry.friction + &entry.tangential_rate);
                let backward = self.force(&entry.normal_rate * entry.friction - &entry.tangential_rate);
                Entity::touching(Touching { gap, along, pressing, traction, cone: [forward, backward] })
            }
        }
    }
}

/// A factorisation of the held system with a border that makes it regular: the load, the incoming direction, or the
/// null vector itself.
fn bordered(
    system: &ModeSystem<'_>,
    loading: Loading<'_>,
    state: &State,
    incoming: Option<&Rate>,
) -> Option<Factorisation> {
    let matrix = system.matrix(state);
    let mut by_load = matrix.clone();
    by_load[(system.size() - 1, loading.structure.unknowns())] = 1.0;
    if let Some(factorisation) = Factorisation::new(by_load) {
        return Some(factorisation);
    }
    if let Some(rate) = incoming {
        let mut by_rate = matrix.clone();
        system.border(&mut by_rate, rate);
        if let Some(factorisation) = Factorisation::new(by_rate) {
            return Some(factorisation);
        }
    }
    let basis = null_space(&matrix.rows(0, system.size() - 1).into_owned(), RANK)?;
    if basis.ncols() != 1 {
        return None;
    }
    let mut by_null_vector = matrix;
    by_null_vector.set_row(system.size() - 1, &basis.column(0).transpose());
    Factorisation::new(by_null_vector)
}
