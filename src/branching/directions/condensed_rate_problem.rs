//! The rate equations condensed on the contacts that can change, and the directions of each contact mode.
//!
//! With `v` the velocities of these contacts and `τ` the coordinate along the direction `z₀` of the structure with the
//! contacts fixed, `(u̇, ṡ, ṙ) = Z v + z₀ τ`; a mode selects one linear equation for each velocity and leaves a line,
//! taken in both senses. The inequalities are those listed in `selection::enumeration`; `rate_options` formulates them,
//! `rates` finds the rays.

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::{
    Alternative, CandidateDirection, FoundDirections, is_mechanism, merge, sort,
};
use crate::branching::directions::condensation_basis;
use crate::branching::directions::rate_basis::{RateBasis, column_by_column};
use crate::branching::directions::tolerances::WEAK_MARGIN;
use crate::complementarity::rate_search::branch_and_bound::{self, Effort, Ray};
use crate::complementarity::rate_search::simultaneous_slips;
use crate::complementarity::rate_search::slip_onset_direction::{self, Touch, Turning};
use crate::complementarity::rates::rate_problem::RateProblem;
use crate::complementarity::rates::{combinations_near_vector, gauss_seidel};
use crate::mechanics::contact::vector::{Vector, add, dot, scaled};
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::multi_contact::rate_options::contact_options::{Changeable, Forms, OptionOutcome};
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::whole_rates;
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::budget::{self, Taken};
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use nalgebra::{DMatrix, DVector};

/// Largest number of contacts for which the search needs no starting guess, and slips of unknown direction are sought
/// separately.
const FEW: usize = 6;

/// The rate equations condensed on the changeable contacts: weight `j` is `v_j`, the last one `τ`.
pub(crate) struct Condensed<'a> {
    loading: Loading<'a>,
    basis: RateBasis<'a>,
    changeable: Vec<Changeable>,
    problem: RateProblem,
    /// The contact modes that each option of each entry stands for.
    outcomes: Vec<Vec<OptionOutcome>>,
    _held: Taken,
}

impl<'a> Condensed<'a> {
    /// Condenses the rate equations; `None` where the structure with the contacts fixed has more than one independent
    /// direction.
    pub(crate) fn new(
        system: &'a ModeSystem<'a>,
        loading: Loading<'a>,
        state: &State,
        standings: &[Standing],
        incoming: Option<Incoming<'_>>,
    ) -> Option<Self> {
        let changeable = changeable(loading, state, standings);
        let basis = condensation_basis::basis(system, &changeable, incoming)?;
        let columns = basis.rates();
        // The rates themselves, and the matrices of their motions and reactions.
        let of_column = columns[0].displacement.len() + 4 * loading.contacts.len();
        let held = budget::take::<f64>(2 * columns.len() * of_column);
        let normals = |contact: usize| loading.frame(contact, state).normal;
        let mut forms = Forms { columns, normals: &normals, rows: Vec::new(), is_force: Vec::new(), held };
        let (entities, outcomes) = changeable.iter().map(|entry| entry.options(loading, state, &mut forms)).unzip();
        forms.held.add::<f64>(forms.rows.len() * columns.len());
        let reactions = column_by_column(4 * loading.contacts.len(), columns.len(), |row, column| {
            let reaction = &columns[column].reactions[row / 4];
            if row % 4 == 0 { reaction.normal } else { reaction.tangential[row % 4 - 1] }
        });
        let mut problem = RateProblem {
            forms: column_by_column(forms.rows.len(), columns.len(), |row, column| forms.rows[row][column]),
            is_force: forms.is_force,
            entities,
            load: basis.load(),
            sizes: basis.sizes(),
            motion: basis.motion(),
            reactions,
        };
        problem.rescale_last_weight();
        let held = forms.held;
        Some(Self { loading, basis, changeable, problem, outcomes, _held: held })
    }

    /// The rate problem, for tests that try every combination.
    #[cfg(test)]
    pub(crate) fn problem(&self) -> &RateProblem {
        &self.problem
    }

    /// Lists the directions, by branch and bound over the contacts' options.
    pub(crate) fn enumerate(
        &self,
        held: &[Mode],
        state: &State,
        incoming: Option<&Rate>,
        effort: Effort<'_>,
        found: &mut FoundDirections,
    ) {
        let first = || {
            let mut first = vec![vec![0; self.changeable.len()]];
            if let Some(rate) = incoming {
                first.extend(combinations_near_vector::near(&self.problem, &self.weights_of(state, rate)));
            }
            if self.changeable.len() > FEW {
                first.extend(incoming.map(|rate| self.released(rate)).unwrap_or_default());
                first.extend(gauss_seidel::sweeps(&self.problem, effort.cancel));
            }
            first
        };
        let findings = branch_and_bound::explore(&self.problem, first, effort);
        found.unexplored = findings.unexplored;
        found.degenerate |= findings.degenerate;
        for basis in &findings.planes {
            let motions: Vec<Rate> = basis.column_iter().map(|column| self.combine(&column.into_owned()).0).collect();
            found.mechanism |= motions.iter().any(|rate| is_mechanism(self.loading, state, rate));
            if let Some(incoming) = incoming {
                self.add_nearest_mechanism(&motions, incoming, held, state, found);
            }
        }
        for ray in &findings.rays {
            self.add(ray, &[], held, state, found);
        }
        let touches: Vec<Touch> = (0..self.changeable.len())
            .filter(|entry| self.changeable[*entry].may_turn(self.loading))
            .filter_map(|entry| {
                let contact = self.changeable[entry].contacts[0];
                Touch::of(&self.problem, entry, self.loading.contacts[contact].friction.coefficient)
            })
            .collect();
        let mut turning: Vec<Turning> = Vec::new();
        if touches.len() <= FEW {
            for touch in &touches {
                let onsets = slip_onset_direction::slips(&self.problem, touch, effort);
                turning.extend(onsets.slips);
                found.unexplored = found.unexplored.saturating_add(u64::from(!onsets.complete));
            }
        }
        if touches.len() > 1 {
            let at_once = simultaneous_slips::slips(&self.problem, &touches, effort.cancel);
            turning.extend(at_once.rays);
            if !at_once.complete {
                found.slips_in_doubt = touches.len() as u64;
                found.unexplored = found.unexplored.saturating_add(found.slips_in_doubt);
            }
        }
        self.add_slips_out_of_groups(held, state, effort, found);
        for slip in &turning {
            let directions: Vec<(usize, Vector)> = slip
                .slips
                .iter()
                .map(|(entity, parts)| {
                    let tangents = self.changeable[*entity].tangents();
                    let direction = add(&scaled(&tangents[0], parts[0]), parts[1], &tangents[1]);
                    (self.changeable[*entity].contacts[0], direction)
                })
                .collect();
            self.add(&slip.ray, &directions, held, state, found);
        }
    }

    /// The combinations in which all contacts are free that may be, and those whose force the incoming direction leaves
    /// at zero. A stretch of a structure may come to lie flat on an obstacle without force: its contacts are free on both
    /// sides of this point, and what the search computes of so many is round-off.
    fn released(&self, incoming: &Rate) -> Vec<Vec<usize>> {
        let freed = |is_freed: &dyn Fn(usize) -> bool| {
            let option = |outcomes: &Vec<OptionOutcome>| {
                let is_free = |(contact, mode): &(usize, Mode)| *mode == Mode::Free && is_freed(*contact);
                outcomes.iter().position(|outcome| outcome.modes.iter().all(is_free)).unwrap_or(0)
            };
            self.outcomes.iter().map(option).collect()
        };
        vec![freed(&|_| true), freed(&|contact| incoming.reactions[contact] == Reaction::default())]
    }

    /// Adds slips of an unloaded node out of a corner, which begin along one of its obstacles in an unknown direction.
    fn add_slips_out_of_groups(&self, held: &[Mode], state: &State, effort: Effort<'_>, found: &mut FoundDirections) {
        let normals = |contact: usize| self.loading.frame(contact, state).normal;
        let columns = self.basis.rates();
        let mut forms = Forms {
            columns,
            normals: &normals,
            rows: self.problem.forms.row_iter().map(|row| row.transpose()).collect(),
            is_force: self.problem.is_force.clone(),
            held: Taken::default(),
        };
        let mut touches = Vec::new();
        for (entity, entry) in self.changeable.iter().enumerate() {
            touches.extend(entry.touches_in_group(entity, &mut forms));
        }
        if touches.is_empty() {
            return;
        }
        let copied = self.problem.reactions.len() + forms.rows.len() * columns.len();
        forms.held.add::<f64>(copied);
        let rows = DMatrix::from_fn(forms.rows.len(), columns.len(), |row, column| forms.rows[row][column]);
        let problem = RateProblem {
            forms: rows,
            is_force: forms.is_force,
            entities: self.problem.entities.clone(),
            load: self.problem.load.clone(),
            sizes: self.problem.sizes.clone(),
            motion: self.problem.motion.clone(),
            reactions: self.problem.reactions.clone(),
        };
        for (contact, touch) in &touches {
            let tangents = self.loading.frame(*contact, state).tangents;
            let onsets = slip_onset_direction::slips(&problem, touch, effort);
            found.unexplored = found.unexplored.saturating_add(u64::from(!onsets.complete));
            for slip in onsets.slips {
                let parts = slip.slips[0].1;
                let direction = add(&scaled(&tangents[0], parts[0]), parts[1], &tangents[1]);
                self.add(&slip.ray, &[(*contact, direction)], held, state, found);
            }
        }
    }

    /// Adds, of a set of motions that no element resists, the one closest to the incoming direction.
    fn add_nearest_mechanism(
        &self,
        motions: &[Rate],
        incoming: &Rate,
        held: &[Mode],
        state: &State,
        found: &mut FoundDirections,
    ) {
        let mut basis: Vec<Rate> = Vec::new();
        for motion in motions.iter().filter(|rate| is_mechanism(self.loading, state, rate)) {
            let mut rest = motion.clone();
            basis.iter().for_each(|known| rest.add(known, -known.product(&rest)));
            let size = rest.size();
            if size > WEAK_MARGIN {
                rest.scale(1.0 / size);
                basis.push(rest);
            }
        }
        let [first, others @ ..] = &basis[..] else { return };
        let mut nearest = first.clone();
        nearest.scale(first.product(incoming));
        others.iter().for_each(|motion| nearest.add(motion, motion.product(incoming)));
        let size = nearest.size();
        let opens = |entry: &Changeable| {
            let contact = entry.contacts[0];
            dot(&self.loading.frame(contact, state).normal, &self.loading.relative_rate(contact, state, &nearest))
                >= -WEAK_MARGIN
        };
        if size <= WEAK_MARGIN || !self.changeable.iter().all(opens) {
            return;
        }
        nearest.scale(1.0 / size);
        let mut modes = held.to_vec();
        self.changeable.iter().flat_map(|entry| &entry.contacts).for_each(|contact| modes[*contact] = Mode::Free);
        let forces = whole_rates(self.loading, state, &nearest);
        let (alternatives, dissipation) = (Vec::new(), 0.0);
        merge(
            found,
            CandidateDirection {
                rate: nearest,
                forces,
                modes,
                alternatives,
                weak: true,
                dissipation,
                cached: CachedFactorisation::default(),
            },
        );
    }

    /// The weights of the columns that best represent a rate: its velocities, and its component along `z₀`.
    fn weights_of(&self, state: &State, rate: &Rate) -> DVector<f64> {
        let last = self.problem.weights() - 1;
        let mut weights = DVector::zeros(last + 1);
        for entry in &self.changeable {
            let motion = self.loading.relative_rate(entry.contacts[0], state, rate);
            for (column, direction) in &entry.velocities {
                weights[*column] = dot(&motion, direction);
            }
        }
        let mut rest = rate.clone();
        rest.add(&self.basis.combined(&weights), -1.0);
        let own = self.basis.combined(&DVector::from_fn(last + 1, |row, _| f64::from(row == last)));
        weights[last] = own.product(&rest) / own.product(&own);
        weights
    }

    /// Adds a ray as a candidate direction.
    fn add(&self, ray: &Ray, turning: &[(usize, Vector)], held: &[Mode], state: &State, found: &mut FoundDirections) {
        let (mut rate, _) = self.combine(&ray.weights);
        let mut modes = held.to_vec();
        for ((entry, outcomes), choice) in self.changeable.iter().zip(&self.outcomes).zip(ray.chosen()) {
            entry.take_reaction_apart(self.loading, state, &mut rate);
            let slips_out = turning.iter().any(|(slipping, _)| entry.contacts.contains(slipping));
            for (contact, mode) in &outcomes[choice].modes {
                // The node leaves its other obstacles.
                let mode = if slips_out && entry.contacts.len() > 1 { &Mode::Free } else { mode };
                let slips = turning.iter().find(|(turning, _)| turning == contact);
                let mode = &slips.map_or(*mode, |(_, direction)| Mode::Slip { direction: *direction });
                modes[*contact] = *mode;
                let reaction = &mut rate.reactions[*contact];
                match mode {
                    Mode::Free if entry.contacts.len() == 1 => *reaction = Reaction::default(),
                    Mode::Slip { direction } if entry.contacts.len() == 1 => {
                        // Exactly on the cone along the direction; the rate across it turns the direction.
                        let friction = self.loading.contacts[*contact].friction;
                        let drag = -friction.bound(reaction.normal) - dot(&reaction.tangential, direction);
                        reaction.tangential = add(&reaction.tangential, drag, direction);
                    }
                    Mode::Free | Mode::Stick | Mode::Slip { .. } => {}
                }
            }
        }
        self.changeable.iter().for_each(|entry| entry.move_to_slider(self.loading, &modes, &mut rate, state));
        let force = WEAK_MARGIN * rate.largest_reaction().max(f64::MIN_POSITIVE);
        if !self.changeable.iter().all(|entry| entry.is_in_cone(self.loading, &modes, &rate, force)) {
            return;
        }
        let dissipation =
            self.changeable.iter().map(|entry| entry.dissipation(self.loading, &modes, &rate, state)).sum();
        let alternatives = self.alternatives(ray, turning, &modes, (state, &rate), force);
        let forces = whole_rates(self.loading, state, &rate);
        let just_held = |entry: &Changeable| entry.margin(&modes, &rate).is_some_and(|margin| margin <= force);
        let weak = ray.weak || self.changeable.iter().any(just_held);
        merge(
            found,
            CandidateDirection {
                rate,
                forces,
                modes,
                alternatives,
                weak,
                dissipation,
                cached: CachedFactorisation::default(),
            },
        );
    }

    /// The alternative modes of each contact along a ray.
    fn alternatives(
        &self,
        ray: &Ray,
        turning: &[(usize, Vector)],
        modes: &[Mode],
        (state, rate): (&State, &Rate),
        force: f64,
    ) -> Vec<Vec<Alternative>> {
        budget::spend(self.changeable.len());
        let of_entity = |((entry, outcomes), in_doubt): ((&Changeable, &Vec<OptionOutcome>), &Vec<usize>)| {
            if turning.iter().any(|(turning, _)| entry.contacts.contains(turning)) {
                return vec![entry.contacts.iter().map(|contact| (*contact, modes[*contact])).collect()];
            }
            let mut alternatives: Vec<Alternative> =
                in_doubt.iter().map(|&choice| outcomes[choice].modes.clone()).collect();
            alternatives.retain(|alternative| {
                budget::spend(modes.len());
                let mut modes = modes.to_vec();
                alternative.iter().for_each(|(contact, mode)| modes[*contact] = *mode);
                entry.is_in_cone(self.loading, &modes, rate, force)
            });
            if let [contact] = entry.contacts[..]
                && alternatives.contains(&vec![(contact, Mode::Free)])
            {
                alternatives.extend(entry.grazing_slip(self.loading, state, rate).map(|slip| vec![(contact, slip)]));
            }
            sort(&mut alternatives);
            alternatives
        };
        self.changeable.iter().zip(&self.outcomes).zip(&ray.in_doubt).map(of_entity).collect()
    }

    /// The rate of unit arc length for weights of the columns, and the weights scaled accordingly; a zero rate where
    /// the weights produce no motion.
    pub(crate) fn combine(&self, weights: &DVector<f64>) -> (Rate, DVector<f64>) {
        let mut rate = self.basis.combined(weights);
        let size = rate.size();
        if size > WEAK_MARGIN * rate.largest_reaction() {
            rate.scale(1.0 / size);
            (rate, weights / size)
        } else {
            rate.scale(0.0);
            (rate, weights.clone())
        }
    }
}

/// The contacts that can change, each corner once, with the numbers of their columns.
pub(crate) fn changeable(loading: Loading<'_>, state: &State, standings: &[Standing]) -> Vec<Changeable> {
    let mut entries: Vec<Changeable> = Vec::new();
    let mut next = 0;
    for (contact, standing) in standings.iter().enumerate() {
        let contacts = match standing {
            Standing::Settled(_) => continue,
            Standing::OnCone { .. } | Standing::Touching => vec![contact],
            Standing::Cornered { .. } => {
                if entries.iter().any(|entry| entry.contacts.contains(&contact)) {
                    continue;
                }
                let cornered = |other: &usize| matches!(standings[*other], Standing::Cornered { .. });
                let corner = loading.corners.iter().find(|corner| corner.contacts.contains(&contact));
                corner.map_or(vec![contact], |corner| corner.contacts.iter().copied().filter(cornered).collect())
            }
        };
        let entry = Changeable::new(loading, state, contacts, *standing, next);
        next += entry.velocities.len();
        entries.push(entry);
    }
    entries
}
