//! Full rates of the structure with given velocities of the contacts that can change, and with no load; and with none of
//! them, its own direction: the matrix `Z` and the vector `z₀` of `condensed_rate_problem` (the usual condensation on the contacts: A.
//! Klarbring, Ing. Arch. 60 (1990) 529, doi:10.1007/BF00541909).
//!
//! With `A` the rate equations in which those contacts are held and a last row `l`, `A Z = v` (unit velocities in the rows
//! of the contacts) and `A z₀ = (0, 1)`. Or, with `M` the equations of the modes just before, in which each such contact
//! holds some velocities and not the others: `M x_j = e_j` with a unit velocity where one is held and a unit force where
//! none is, and the incoming direction `t`. The rates that obey equilibrium with these forces free are the same space, so
//! `[Z z₀] = [X t] G⁻¹`, `G` the velocities and the load rate of `[X t]`.

use crate::algebra::dense::assembly::Sink;
use crate::algebra::{Factorisation, SystemFactorisation, null_space};
use crate::branching::directions::arrival_tangent::Incoming;
use crate::mechanics::contact::Reaction;
use crate::mechanics::contact::vector::{Vector, dot};
use crate::mechanics::equations::scaled_rows::RANK;
use crate::mechanics::equations::{Kind, ModeSystem, Role};
use crate::mechanics::multi_contact::rate_options::contact_options::Changeable;
use crate::mechanics::problem::state::Rate;
use crate::resources::budget;
use nalgebra::{DMatrix, DVector};

/// Cosine up to which a direction lies across a normal.
const ACROSS: f64 = 1e-12;
/// Backward error of the solutions that columns are made of, as of those by a factorisation of their own: on a lattice of
/// 102,304 unknowns they tell rates to about 2e-9.
const ACCEPTED: f64 = 1e-11;
/// Smallest pivot of the velocities and loads of solutions, of sizes about 1, at which these span all that is asked for.
const SPANS: f64 = 1e-3;

/// The velocities of all: the contact and the direction of each.
fn velocities(changeable: &[Changeable]) -> impl Iterator<Item = (usize, &Vector)> {
    changeable.iter().flat_map(|entry| entry.velocities.iter().map(|(_, direction)| (entry.contacts[0], direction)))
}

impl ModeSystem<'_> {
    /// The rates for unit velocities of each contact that can change, which this system holds, one after the other, and
    /// after them the direction without; `None` where that is more than one.
    pub(crate) fn columns(&self, changeable: &[Changeable], incoming: Option<Incoming<'_>>) -> Option<Vec<Rate>> {
        incoming
            .and_then(|incoming| self.columns_nearby(changeable, incoming))
            .or_else(|| self.columns_held(changeable, incoming.map(|incoming| incoming.rate)))
    }

    /// By a factorisation of the held equations.
    fn columns_held(&self, changeable: &[Changeable], incoming: Option<&Rate>) -> Option<Vec<Rate>> {
        let factorisation = self.bordered_somehow(incoming)?;
        let solved = |mut values: DVector<f64>| {
            budget::spend(self.size);
            let is_solved = factorisation.solve(&mut values);
            is_solved.then(|| self.rate_from(self.anchor, &values))
        };
        let rights = velocities(changeable).map(|(contact, direction)| self.moving(contact, direction));
        rights.chain(std::iter::once_with(|| self.bordering())).map(solved).collect()
    }

    /// A right-hand side: the node of a closed contact moves along a direction, as far as the contact holds it.
    pub(crate) fn moving(&self, contact: usize, direction: &Vector) -> DVector<f64> {
        let mut values = DVector::zeros(self.size);
        let row = self.row_of(contact);
        let normal = self.loading.frame(contact, self.anchor).normal;
        let held = self.held_directions(contact);
        // A smooth contact holds along its normal alone, and so does one that slips.
        let held = if held.is_empty() { std::slice::from_ref(&normal) } else { held };
        held.iter().enumerate().for_each(|(k, one)| values[row + k] = dot(one, direction));
        values
    }

    /// A factorisation with a border that makes it regular: the load, the incoming direction, or the null vector itself.
    fn bordered_somehow(&self, incoming: Option<&Rate>) -> Option<SystemFactorisation> {
        let iterate = self.iterate(self.anchor.clone());
        let by_load = |matrix: &mut dyn Sink| matrix.add(self.size - 1, self.loading.structure.unknowns(), 1.0);
        if let Some(factorisation) = self.factorise(&iterate, Kind::Rates, by_load) {
            return Some(factorisation);
        }
        if let Some(rate) = incoming
            && let Some(factorisation) = self.bordered(&iterate, rate)
        {
            return Some(factorisation);
        }
        if !self.loading.structure.allows_dense() {
            return None;
        }
        let matrix = self.matrix(self.anchor);
        let basis = null_space(&matrix.rows(0, self.size - 1).into_owned(), RANK)?;
        if basis.ncols() != 1 {
            return None;
        }
        let mut by_null_vector = matrix;
        by_null_vector.set_row(self.size - 1, &basis.column(0).transpose());
        Factorisation::new(by_null_vector).map(SystemFactorisation::Dense)
    }

    /// By the factorisation that led here, of the modes just before. In these each contact that changes holds some
    /// velocities and leaves the forces along the others, at which there are none, to be what they are; with a unit of each
    /// in turn, and with the direction in which the path came, their solutions span what the columns are to span.
    ///
    /// On a flat obstacle: on another the reactions turn with the node, each mode's in its own way. `None` where
    /// something else is not as described.
    fn columns_nearby(&self, changeable: &[Changeable], incoming: Incoming<'_>) -> Option<Vec<Rate>> {
        let (nearby, modes) = (incoming.nearby?.sparse()?, incoming.modes?);
        let (loading, state) = (self.loading, self.anchor);
        let changes = |contact: usize| changeable.iter().any(|entry| entry.contacts == [contact]);
        let held = self.modes.iter().zip(modes).enumerate();
        let is_alike = held.into_iter().all(|(contact, (held, mode))| changes(contact) || held.continues(*mode));
        if !is_alike || !changeable.iter().all(|entry| self.is_plain(entry)) {
            return None;
        }
        let system = ModeSystem::new(loading, modes, state);
        let iterate = system.iterate(state.clone());
        let nearby = nearby.nearby(system.assemble_sparse(&iterate, Kind::Rates)?)?;
        let velocities: Vec<(usize, &Vector)> = velocities(changeable).collect();
        // The right-hand sides, what comes of them, and the rates.
        let _held = budget::take::<f64>((velocities.len() + 1) * (5 * system.size + 4 * loading.contacts.len()));
        let mut rights = Vec::with_capacity(velocities.len() * system.size);
        for (contact, direction) in &velocities {
            let is_held = system.holds(*contact, direction)?;
            let right = if is_held { system.moving(*contact, direction) } else { system.pushed(*contact, direction) };
            rights.extend_from_slice(right.as_slice());
        }
        let solved = nearby.solve_all(&rights, ACCEPTED)?;
        let mut solutions = Vec::with_capacity(velocities.len() + 1);
        for ((contact, direction), values) in velocities.iter().zip(solved.chunks_exact(system.size)) {
            let mut rate = system.rate_at(&iterate, &DVector::from_column_slice(values), Kind::Rates);
            if system.holds(*contact, direction) == Some(false) {
                rate.reactions[*contact].add(1.0, &Reaction::of(direction, &loading.frame(*contact, state).normal));
            }
            solutions.push(rate.normalised()?);
        }
        solutions.push(incoming.rate.clone());
        self.combined(&velocities, &solutions)
    }

    /// Whether a contact changes alone, on a flat obstacle, at a node that is free to move.
    fn is_plain(&self, entry: &Changeable) -> bool {
        let structure = self.loading.structure;
        let [contact] = entry.contacts[..] else { return false };
        let first = self.loading.contacts[contact].node * structure.dimension;
        let mut freedoms = first..first + structure.dimension;
        self.loading.frame(contact, self.anchor).curvature == 0.0
            && freedoms.all(|freedom| structure.unknown_of[freedom].is_some())
    }

    /// Whether a mode gives a contact's velocity along a direction, not the force; `None` where it is not that simple.
    fn holds(&self, contact: usize, direction: &Vector) -> Option<bool> {
        match self.roles[contact] {
            Role::Free => Some(false),
            Role::Stick => Some(true),
            Role::Frictionless | Role::Line { .. } => {
                let normal = self.loading.frame(contact, self.anchor).normal;
                let is_normal = *direction == normal;
                (is_normal || dot(direction, &normal).abs() <= ACROSS).then_some(is_normal)
            }
            Role::Edge { .. } | Role::Plane { .. } | Role::Held | Role::HeldBy => None,
        }
    }

    /// A right-hand side: a unit force along a direction on the node of a contact.
    pub(crate) fn pushed(&self, contact: usize, direction: &Vector) -> DVector<f64> {
        let structure = self.loading.structure;
        let first = self.loading.contacts[contact].node * structure.dimension;
        let mut values = DVector::zeros(self.size);
        for (freedom, part) in (first..first + structure.dimension).zip(direction) {
            if let Some(unknown) = structure.unknown_of[freedom] {
                values[unknown] = *part;
            }
        }
        values
    }

    /// The columns as combinations of solutions, as many, that span them.
    fn combined(&self, velocities: &[(usize, &Vector)], solutions: &[Rate]) -> Option<Vec<Rate>> {
        let count = solutions.len();
        let _held = budget::take::<f64>(2 * count * count);
        let mut parts = DMatrix::zeros(count, count);
        for (row, (contact, direction)) in velocities.iter().enumerate() {
            for (column, solution) in solutions.iter().enumerate() {
                parts[(row, column)] = dot(direction, &self.loading.relative_rate(*contact, solution));
            }
        }
        for (column, solution) in solutions.iter().enumerate() {
            parts[(count - 1, column)] = solution.load;
        }
        let sizes: Vec<f64> = parts.row_iter().map(|row| row.amax()).collect();
        if !sizes.iter().all(|size| size.is_finite() && *size > 0.0) {
            return None;
        }
        parts.row_iter_mut().zip(&sizes).for_each(|(mut row, size)| row /= *size);
        let factorisation = Factorisation::new(parts).filter(|parts| parts.pivot_ratio() >= SPANS)?;
        let column = |(index, size): (usize, &f64)| {
            let mut weights = DVector::zeros(count);
            weights[index] = 1.0 / size;
            if !factorisation.solve(&mut weights) {
                return None;
            }
            budget::spend(count * self.size);
            let mut rate = self.no_rate();
            solutions.iter().zip(weights.iter()).for_each(|(solution, weight)| rate.add(solution, *weight));
            Some(rate)
        };
        sizes.iter().enumerate().map(column).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::branching::directions::candidate::held_modes;
    use crate::branching::directions::condensed_rate_problem::changeable;
    use crate::check::scenes::lattice::LatticeArch;
    use crate::continuation::path::iterator::Path;
    use crate::continuation::scene::Scene;
    use crate::mechanics::multi_contact::contact_status::Standing;
    use crate::resources::cancel::CancelFlag;
    use crate::step::corrector::cached_factorisation::AtHand;
    use crate::step::corrector::cost_counters::Work;
    use crate::step::segment::StepStart;

    /// At the changes of an arch that lands, the factorisation that led there gives the columns as one of the held
    /// equations does.
    #[test]
    fn a_factorisation_of_the_modes_before_gives_the_same() {
        let (mut by_nearby, mut most) = (0, 0.0_f64);
        for friction in [0.0, 0.3] {
            let arch = LatticeArch { increments: 90, friction, ..LatticeArch::of_unknowns(400) }.landing(20);
            let mut scene = Scene::new(&arch.request().expect("a request")).expect("a scene");
            scene.structure.set_sparse(true);
            let mut path = Path::new(&scene, CancelFlag::default());
            while path.next().is_some() {
                let Some(listed) = &path.trace.at.listed else { continue };
                let (Some(arriving), Some(taken)) = (&listed.arriving, listed.taken) else { continue };
                let (loading, state) = (path.trace.loading(), &path.trace.at.here.state);
                let standings = path.trace.standings(state);
                if standings.iter().all(|standing| matches!(standing, Standing::Settled(_))) {
                    continue;
                }
                let rate = &listed.options[taken].rate;
                // The direction in which the path came, found once more from a point nearby.
                let before = state.advanced(rate, -1e-6);
                let start = StepStart {
                    loading,
                    state: &before,
                    rate,
                    modes: &arriving.modes,
                    drift: None,
                    force_scale: path.trace.at.totals.force_scale,
                    is_singular: false,
                    beside: None,
                };
                let mut serving = None;
                let mut work = Work::default();
                if start.reach_by(state.clone(), 1e-6, &mut serving, &mut work).is_err() {
                    continue;
                }
                let nearby = AtHand::shared(serving.as_ref());
                let came = ModeSystem::new(loading, &arriving.modes, state);
                let Some(incoming) = came
                    .bordered(&came.iterate(state.clone()), rate)
                    .and_then(|bordered| came.tangent_by(&bordered, &came.iterate(state.clone())))
                else {
                    continue;
                };
                let incoming =
                    Incoming { modes: Some(&arriving.modes), nearby: Some(&nearby), ..Incoming::along(&incoming) };
                let held = held_modes(loading, &standings);
                let system = ModeSystem::new(loading, &held, state);
                let changeable = changeable(loading, state, &standings);
                let Some(columns) = system.columns_nearby(&changeable, incoming) else { continue };
                let expected = system.columns_held(&changeable, None).expect("a regular point");
                by_nearby += 1;
                for (one, other) in columns.iter().zip(&expected) {
                    let mut difference = one.clone();
                    difference.add(other, -1.0);
                    let forces = difference.largest_reaction() / other.largest_reaction().max(1.0);
                    most = most.max(difference.size() / other.size()).max(forces);
                }
            }
        }
        assert!(by_nearby >= 30, "{by_nearby} changes");
        assert!(most < 1e-9, "{most}");
    }
}
