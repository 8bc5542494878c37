//! The rate equations condensed on the contacts that can change, and the directions of each contact mode.
//!
//! With `v` the velocities of those contacts and `τ` the coordinate along the held structure's own direction `z₀`,
//! `(u̇, ṡ, ṙ) = Z v + z₀ τ`; a mode picks one linear equation for each velocity and leaves a line, taken in both senses.
//! The inequalities are those listed in `directions`.

use super::directions::{Candidate, Found, RANK, WEAK, is_mechanism, merge};
use super::loading::Loading;
use super::mode_system::ModeSystem;
use super::standing::Standing;
use super::state::{Rate, State};
use crate::cancel::CancelFlag;
use crate::contact::vector::{Vector, add, dot, scaled};
use crate::contact::{Frame, Mode, Reaction};
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
    frame: Frame,
    /// The tangent along which the velocity is counted: the direction of slip on the cone, else the frame's first.
    axis: Vector,
    normal_column: Option<usize>,
    tangential_column: Option<usize>,
    normal_rate: DVector<f64>,
    tangential_rate: DVector<f64>,
    /// The present reaction: what a unit of slip dissipates is `μ r_n`.
    reaction: Reaction,
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
            let frame = loading.frame(contact, state);
            let axis = match standing {
                Standing::OnCone { direction } => *direction,
                Standing::Settled(_) | Standing::Touching => frame.tangents[0],
            };
            let (normal_column, tangential_column) = match standing {
                Standing::Settled(_) => continue,
                Standing::OnCone { .. } => (None, place(Velocity::Tangential)),
                Standing::Touching if loading.contacts[contact].tangents() > 0 => {
                    (place(Velocity::Normal), place(Velocity::Tangential))
                }
                Standing::Touching => (place(Velocity::Normal), None),
            };
            changeable.push(Changeable {
                contact,
                standing: *standing,
                friction,
                frame,
                axis,
                normal_column,
                tangential_column,
                normal_rate: DVector::zeros(0),
                tangential_rate: DVector::zeros(0),
                reaction: state.reactions[contact],
            });
        }
        let mut columns = Vec::with_capacity(velocities.len() + 1);
        for (contact, velocity) in velocities {
            let mut values = DVector::zeros(system.size());
            let row = system.row_of(contact);
            match velocity {
                Velocity::Normal => values[row] = 1.0,
                Velocity::Tangential => {
                    let Some(entry) = changeable.iter().find(|entry: &&Changeable| entry.contact == contact) else {
                        continue;
                    };
                    for (k, tangent) in entry.frame.tangents.iter().enumerate() {
                        if k < loading.contacts[contact].tangents() {
                            values[row + 1 + k] = dot(tangent, &entry.axis);
                        }
                    }
                }
            }
            if !factorisation.solve(&mut values) {
                return None;
            }
            columns.push(system.rate_from(state, &values));
        }
        let mut values = DVector::zeros(system.size());
        values[system.size() - 1] = 1.0;
        if !factorisation.solve(&mut values) {
            return None;
        }
        columns.push(system.rate_from(state, &values));
        for entry in &mut changeable {
            let reaction = |column: &Rate| column.reactions[entry.contact];
            entry.normal_rate = DVector::from_iterator(columns.len(), columns.iter().map(|c| reaction(c).normal));
            entry.tangential_rate = DVector::from_iterator(
                columns.len(),
                columns.iter().map(|c| dot(&reaction(c).tangential, &entry.axis)),
            );
            // The columns hold the rate of the whole force; the reaction's own parts turn with the place on the obstacle.
            if let (Some(column), true) = (entry.tangential_column, entry.frame.curvature != 0.0) {
                entry.normal_rate[column] += entry.frame.curvature * dot(&entry.reaction.tangential, &entry.axis);
                entry.tangential_rate[column] -= entry.frame.curvature * entry.reaction.normal;
            }
        }
        Some(Self { loading, columns, changeable })
    }

    /// Options of one contact, holding first: where the number examined is bounded, the held structure is among them.
    fn options(&self, entry: &Changeable) -> Vec<Mode> {
        match entry.standing {
            Standing::Settled(mode) => vec![mode],
            Standing::OnCone { direction } => vec![Mode::Stick, Mode::Slip { direction }],
            Standing::Touching if entry.tangential_column.is_some() => vec![
                Mode::Stick,
                Mode::Slip { direction: entry.axis },
                Mode::Slip { direction: scaled(&entry.axis, -1.0) },
                Mode::Free,
            ],
            Standing::Touching => vec![Mode::Slip { direction: [0.0; 3] }, Mode::Free],
        }
    }

    /// Examines the contact modes one after another, at most so many.
    pub(super) fn enumerate(
        &self,
        held: &[Mode],
        state: &State,
        most_modes: u64,
        cancel: &CancelFlag,
        found: &mut Found,
    ) {
        let options: Vec<Vec<Mode>> = self.changeable.iter().map(|entry| self.options(entry)).collect();
        let total = options.iter().try_fold(1u64, |total, option| total.checked_mul(option.len() as u64));
        let examined = total.unwrap_or(u64::MAX).min(most_modes);
        found.unexplored = total.unwrap_or(u64::MAX) - examined;
        for number in 0..examined {
            if cancel.is_cancelled() {
                found.unexplored += examined - number;
                return;
            }
            let mut rest = number;
            let chosen: Vec<Mode> = options
                .iter()
                .map(|option| {
                    let mode = option[(rest % option.len() as u64) as usize];
                    rest /= option.len() as u64;
                    mode
                })
                .collect();
            self.examine(&chosen, held, state, found);
        }
    }

    /// The directions of one mode.
    fn examine(&self, chosen: &[Mode], held: &[Mode], state: &State, found: &mut Found) {
        let columns = self.columns.len();
        let mut equations = DMatrix::zeros(columns - 1, columns);
        let mut next = 0;
        let mut put = |form: DVector<f64>| {
            equations.set_row(next, &form.transpose());
            next += 1;
        };
        let unit = |column: usize| DVector::from_fn(columns, |row, _| f64::from(u8::from(row == column)));
        for (entry, mode) in self.changeable.iter().zip(chosen) {
            match mode {
                Mode::Free => {
                    put(entry.normal_rate.clone());
                    if entry.tangential_column.is_some() {
                        put(entry.tangential_rate.clone());
                    }
                }
                Mode::Stick => {
                    for column in [entry.normal_column, entry.tangential_column].into_iter().flatten() {
                        put(unit(column));
                    }
                }
                Mode::Slip { direction } => {
                    if let Some(column) = entry.normal_column {
                        put(unit(column));
                    }
                    if entry.tangential_column.is_some() {
                        put(&entry.tangential_rate
                            + &entry.normal_rate * (entry.friction * dot(direction, &entry.axis)));
                    }
                }
            }
        }
        let Some(basis) = null_space(&equations, RANK) else {
            found.degenerate = true;
            return;
        };
        if basis.ncols() > 1 {
            found.degenerate = true;
            found.mechanism |= basis.column_iter().any(|column| {
                let (rate, _) = self.combine(&column.into_owned());
                is_mechanism(self.loading, state, &rate)
            });
            return;
        }
        for sense in [1.0, -1.0] {
            let weights: DVector<f64> = basis.column(0) * sense;
            let (mut rate, weights) = self.combine(&weights);
            if rate.size() < 0.5 {
                // Reactions that change with nothing else: redundant contacts.
                found.degenerate = true;
                return;
            }
            let Some(weak) = self.feasible(chosen, &weights, rate.largest_reaction()) else { continue };
            let mut modes = held.to_vec();
            for (entry, mode) in self.changeable.iter().zip(chosen) {
                modes[entry.contact] = *mode;
                match mode {
                    Mode::Free => rate.reactions[entry.contact] = Reaction::default(),
                    Mode::Stick => {}
                    Mode::Slip { direction } => {
                        // Exactly on the cone along the direction; what is across it turns the direction.
                        let reaction = &mut rate.reactions[entry.contact];
                        let drag = -entry.friction * reaction.normal - dot(&reaction.tangential, direction);
                        reaction.tangential = add(&reaction.tangential, drag, direction);
                    }
                }
            }
            let dissipation = self.dissipation(&weights);
            merge(found, Candidate { rate, labels: vec![modes], weak, dissipation });
        }
    }

    /// The rate of unit arc length for weights of the columns, and the weights that give it; of no size where the
    /// weights move nothing.
    fn combine(&self, weights: &DVector<f64>) -> (Rate, DVector<f64>) {
        let mut rate = self.columns[0].clone();
        rate.scale(weights[0]);
        for (column, weight) in self.columns.iter().zip(weights.iter()).skip(1) {
            rate.displacement.iter_mut().zip(&column.displacement).for_each(|(sum, value)| *sum += weight * value);
            rate.load += weight * column.load;
            for (sum, value) in rate.reactions.iter_mut().zip(&column.reactions) {
                sum.add(*weight, value);
            }
        }
        self.take_reactions_apart(&mut rate);
        let size = rate.size();
        if size > WEAK * rate.largest_reaction() {
            rate.scale(1.0 / size);
            (rate, weights / size)
        } else {
            rate.scale(0.0);
            (rate, weights.clone())
        }
    }

    /// On curved obstacles: from the rate of the whole force to the rates of normal and tangential reaction.
    fn take_reactions_apart(&self, rate: &mut Rate) {
        for entry in self.changeable.iter().filter(|entry| entry.frame.curvature != 0.0) {
            let motion = self.loading.relative_rate(entry.contact, rate);
            let curvature = entry.frame.curvature;
            let slid = add(&motion, -dot(&motion, &entry.frame.normal), &entry.frame.normal);
            let across = curvature * dot(&entry.reaction.tangential, &slid);
            let reaction = &mut rate.reactions[entry.contact];
            reaction.normal += across;
            reaction.tangential = add(&reaction.tangential, -curvature * entry.reaction.normal, &slid);
            reaction.tangential = add(&reaction.tangential, -across, &entry.frame.normal);
        }
    }

    /// Whether the inequalities hold; `Some(true)` where one of them holds with equality.
    fn feasible(&self, chosen: &[Mode], weights: &DVector<f64>, reaction_size: f64) -> Option<bool> {
        if !weights.iter().all(|weight| weight.is_finite()) {
            return None;
        }
        let force = WEAK * reaction_size.max(f64::MIN_POSITIVE);
        let mut weak = false;
        let mut holds = |value: f64, tolerance: f64| {
            weak |= value.abs() <= tolerance;
            value >= -tolerance
        };
        for (entry, mode) in self.changeable.iter().zip(chosen) {
            let normal_rate = entry.normal_rate.dot(weights);
            let tangential_rate = entry.tangential_rate.dot(weights);
            let velocity = |column: Option<usize>| column.map_or(0.0, |column| weights[column]);
            let touching = entry.standing == Standing::Touching;
            let feasible = match mode {
                Mode::Free => holds(velocity(entry.normal_column), WEAK),
                Mode::Stick => match entry.standing {
                    Standing::OnCone { .. } => holds(entry.friction * normal_rate + tangential_rate, force),
                    Standing::Settled(_) | Standing::Touching => {
                        holds(entry.friction * normal_rate - tangential_rate.abs(), force)
                    }
                },
                Mode::Slip { direction } => {
                    let along = dot(direction, &entry.axis) * velocity(entry.tangential_column);
                    let sliding = entry.tangential_column.is_none() || holds(along, WEAK);
                    let pressed = !touching || holds(normal_rate, force);
                    sliding && pressed
                }
            };
            if !feasible {
                return None;
            }
        }
        Some(weak)
    }

    fn dissipation(&self, weights: &DVector<f64>) -> f64 {
        self.changeable
            .iter()
            .map(|entry| match (entry.standing, entry.tangential_column) {
                (Standing::OnCone { .. }, Some(column)) => entry.friction * entry.reaction.normal * weights[column],
                _ => 0.0,
            })
            .sum()
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
