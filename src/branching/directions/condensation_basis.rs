//! How the basis of the condensation on the contacts that can change is found: the rates of the structure for unit
//! velocities of these contacts at zero load, and the structure's own direction with zero velocities. They are the matrix
//! `Z` and the vector `z₀` of `condensed_rate_problem` (the usual condensation on the contacts: A. Klarbring, Ing. Arch.
//! 60 (1990) 529, doi:10.1007/BF00541909).
//!
//! Let `A` be the rate equations in which these contacts are fixed, with a last row `l`: then `A Z = v` (unit
//! velocities in the rows of the contacts) and `A z₀ = (0, 1)`. Alternatively, let `M` be the equations of the modes
//! just before the point, in which each of these contacts has some velocities prescribed and the others free: then
//! `M x_j = e_j` with a unit velocity where it is prescribed and a unit force where it is free, and `t` is the incoming
//! direction. Both span the rates that satisfy equilibrium with these forces free, so `[Z z₀] = [X t] G⁻¹`, with `G`
//! the velocities and the load rate of `[X t]`. Of many velocities only the load rates and the reactions are computed,
//! as products of half solutions.

use crate::algebra::dense::matrix_sink::Sink;
use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::preconditioned_refinement::Nearby;
use crate::algebra::{Factorisation, SystemFactorisation, null_space};
use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::rate_basis::{CombinationSolver, RateBasis, RatesAtContacts};
use crate::branching::directions::tolerances::{ACCEPTED_BACKWARD_ERROR, SMALLEST_SPANNING_PIVOT, TANGENTIAL_COSINE};
use crate::mechanics::contact::Reaction;
use crate::mechanics::contact::vector::{Vector, dot};
use crate::mechanics::equations::tolerances::RANK_TOLERANCE;
use crate::mechanics::equations::{Kind, ModeSystem, Role, matrix, mode_factorisation, rate_recovery};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::multi_contact::rate_options::contact_options::Changeable;
use crate::mechanics::problem::state::Rate;
use crate::resources::budget;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Number of velocities up to which corrections of solutions by a factorisation nearby, two or three of each, take less
/// than a factorisation of their own, and above which rates at the contacts take less than whole ones. The value affects
/// only effort, and the result by no more than rounding.
const MOST_NEARBY: usize = 8;

/// The velocities of all contacts that can change: the contact and the direction of each.
fn velocities(changeable: &[Changeable]) -> impl Iterator<Item = (usize, &Vector)> {
    changeable.iter().flat_map(|entry| entry.velocities.iter().map(|(_, direction)| (entry.contacts[0], direction)))
}

/// The rates for unit velocities of each contact that can change, which this system prescribes, one after the other,
/// and last the direction with zero velocities; `None` where this direction is not unique.
pub(crate) fn basis<'a>(
    equations: &'a ModeSystem<'a>,
    changeable: &[Changeable],
    incoming: Option<Incoming<'_>>,
) -> Option<RateBasis<'a>> {
    let is_cheaper = |_: &Incoming<'_>| velocities(changeable).count() <= MOST_NEARBY;
    if let Some(columns) =
        incoming.filter(is_cheaper).and_then(|incoming| columns_nearby(equations, changeable, incoming))
    {
        return Some(RateBasis::Whole(columns));
    }
    let factorisation = bordered_somehow(equations, incoming.map(|incoming| incoming.rate))?;
    let are_many = velocities(changeable).count() > MOST_NEARBY;
    match are_many.then(|| rates_at_contacts(equations, changeable, &factorisation)).flatten() {
        Some(rates) => Some(RateBasis::AtContacts(rates)),
        None => columns_held(equations, changeable, &factorisation).map(RateBasis::Whole),
    }
}

/// The whole rates by a factorisation of the equations in which the contacts are fixed.
fn columns_held(
    equations: &ModeSystem<'_>,
    changeable: &[Changeable],
    factorisation: &SystemFactorisation,
) -> Option<Vec<Rate>> {
    let size = equations.size;
    let count = velocities(changeable).count() + 1;
    // The right-hand sides, their solutions, and the rates.
    let of_rate = equations.loading.structure.freedoms() + 4 * equations.loading.contacts.len();
    let _held = budget::take::<f64>(count * (2 * size + of_rate));
    budget::spend(count * size);
    let mut values = Vec::with_capacity(count * size);
    let rights = velocities(changeable).map(|(contact, direction)| moving(equations, contact, direction));
    for right in rights.chain(std::iter::once_with(|| rate_recovery::bordering(equations))) {
        values.extend_from_slice(right.as_slice());
    }
    if !factorisation.solve_all(&mut values, size) {
        return None;
    }
    let iterate = equations.iterate(equations.anchor.clone());
    let rate =
        |values: &[f64]| rate_recovery::rate_at(equations, &iterate, &DVector::from_column_slice(values), Kind::Rates);
    Some(values.chunks_exact(size).map(rate).collect())
}

/// The rates at the contacts by a factorisation of the equations in which they are fixed. `None` where options need more
/// than velocities and reactions of their own contact, and where reactions depend on the motion of their nodes.
fn rates_at_contacts<'a>(
    equations: &'a ModeSystem<'a>,
    changeable: &[Changeable],
    factorisation: &SystemFactorisation,
) -> Option<RatesAtContacts<'a>> {
    let SystemFactorisation::Sparse(factorisation) = factorisation else { return None };
    let count = velocities(changeable).count();
    let state = equations.anchor;
    let turns = |(contact, role): (usize, &Role)| match role {
        Role::Free | Role::Stick | Role::Held | Role::HeldBy | Role::Frictionless => false,
        Role::Line { .. } | Role::Plane { .. } => !equations.loading.frame(contact, state).curvature.is_zero(),
        Role::Edge { .. } => true,
    };
    let is_plain = |entry: &Changeable| matches!(entry.standing, Standing::OnCone { .. } | Standing::Touching);
    if !changeable.iter().all(is_plain) || equations.roles.iter().enumerate().any(turns) {
        return None;
    }
    let structure = equations.loading.structure;
    let unknowns = structure.unknowns();
    let mut rights: Vec<SparseEntries> =
        velocities(changeable).map(|(contact, direction)| moved(equations, contact, direction)).collect();
    let at_borders = |right: &SparseEntries| right.iter().map(|(row, value)| (row - unknowns, *value)).collect();
    let borders: Vec<SparseEntries> = rights.iter().map(at_borders).collect();
    // The values at the borders with their terms, and the rates.
    let of_column = 6 * (equations.size - unknowns) + 4 * equations.loading.contacts.len();
    let _held = budget::take::<f64>(count * of_column);
    let values = factorisation.border_values(&borders)?;
    let mut own = rate_recovery::bordering(equations);
    if !factorisation.solve(&mut own) {
        return None;
    }
    rights.push(std::iter::once((equations.size - 1, 1.0)).collect());
    let iterate = equations.iterate(state.clone());
    let at_contacts = |values: &DVector<f64>| {
        let mut rate = Rate { displacement: Vec::new(), ..rate_recovery::no_rate(equations) };
        rate_recovery::rate_into(equations, &iterate, values, Kind::Rates, &mut rate);
        rate
    };
    let mut whole = DVector::zeros(equations.size);
    let mut rates: Vec<Rate> = Vec::with_capacity(count + 1);
    for column in values.column_iter() {
        whole.rows_mut(unknowns, column.len()).copy_from(&column);
        rates.push(at_contacts(&whole));
    }
    rates.push(at_contacts(&own));
    let driven = (0..structure.freedoms()).filter(|freedom| structure.unknown_of[*freedom].is_none());
    let prescribed: f64 = driven.map(|freedom| equations.loading.support_rate(freedom).powi(2)).sum();
    let solver = CombinationSolver {
        factorisation: factorisation.clone(),
        rights,
        unknowns,
        load_size: (1.0 + prescribed).sqrt(),
    };
    let own_size = rate_recovery::length_of(equations, &own);
    Some(RatesAtContacts { equations, rates, solver: Arc::new(solver), own_size })
}

/// The right-hand side for a unit motion of the node of a closed contact along a direction, in the directions that the
/// contact constrains.
pub(crate) fn moving(equations: &ModeSystem<'_>, contact: usize, direction: &Vector) -> DVector<f64> {
    let mut values = DVector::zeros(equations.size);
    moved(equations, contact, direction).into_iter().for_each(|(row, value)| values[row] = value);
    values
}

/// The entries of this right-hand side.
fn moved(equations: &ModeSystem<'_>, contact: usize, direction: &Vector) -> SparseEntries {
    let row = equations.row_of(contact);
    let held = equations.held_directions(contact);
    if held.is_empty() {
        // A frictionless contact constrains the normal direction alone, and so does a slipping one.
        let normal = equations.loading.frame(contact, equations.anchor).normal;
        return std::iter::once((row, dot(&normal, direction))).collect();
    }
    held.iter().enumerate().map(|(k, one)| (row + k, dot(one, direction))).collect()
}

/// A factorisation with a border that makes it regular: the load, the incoming direction, or the null vector itself.
fn bordered_somehow(equations: &ModeSystem<'_>, incoming: Option<&Rate>) -> Option<SystemFactorisation> {
    let iterate = equations.iterate(equations.anchor.clone());
    let by_load = |matrix: &mut dyn Sink| matrix.add(equations.size - 1, equations.loading.structure.unknowns(), 1.0);
    if let Some(factorisation) = mode_factorisation::factorise(equations, &iterate, Kind::Rates, by_load) {
        return Some(factorisation);
    }
    if let Some(rate) = incoming
        && let Some(factorisation) = mode_factorisation::factorise_bordered(equations, &iterate, rate)
    {
        return Some(factorisation);
    }
    if !equations.loading.structure.allows_dense() {
        return None;
    }
    let matrix = matrix::rate_matrix(equations, equations.anchor);
    let basis = null_space(&matrix.rows(0, equations.size - 1).into_owned(), RANK_TOLERANCE)?;
    if basis.ncols() != 1 {
        return None;
    }
    let mut by_null_vector = matrix;
    by_null_vector.set_row(equations.size - 1, &basis.column(0).transpose());
    Factorisation::new(by_null_vector).map(SystemFactorisation::Dense)
}

/// The columns by the factorisation that led to the point, of the modes just before. In these modes each contact that
/// changes prescribes some velocities and leaves the others free, with zero forces along them; the solutions for a unit
/// of each in turn, together with the incoming direction, span the space of the columns.
///
/// Valid on flat obstacles: on a curved one the reactions turn with the node, differently in each mode. `None` where
/// one of these assumptions does not hold.
fn columns_nearby(equations: &ModeSystem<'_>, changeable: &[Changeable], incoming: Incoming<'_>) -> Option<Vec<Rate>> {
    let (nearby, modes) = (incoming.nearby?.sparse()?, incoming.modes?);
    let (loading, state) = (equations.loading, equations.anchor);
    let changes = |contact: usize| changeable.iter().any(|entry| entry.contacts == [contact]);
    let held = equations.modes.iter().zip(modes).enumerate();
    let is_alike = held.into_iter().all(|(contact, (held, mode))| changes(contact) || held.continues(*mode));
    if !is_alike || !changeable.iter().all(|entry| is_plain(equations, entry)) {
        return None;
    }
    let system = ModeSystem::new(loading, modes, state);
    let iterate = system.iterate(state.clone());
    let nearby = Nearby::new(nearby, matrix::assemble_sparse(&system, &iterate, Kind::Rates)?)?;
    let velocities: Vec<(usize, &Vector)> = velocities(changeable).collect();
    // The right-hand sides, their solutions, and the rates.
    let _held = budget::take::<f64>((velocities.len() + 1) * (5 * system.size + 4 * loading.contacts.len()));
    let mut rights = Vec::with_capacity(velocities.len() * system.size);
    for (contact, direction) in &velocities {
        let is_held = holds(&system, *contact, direction)?;
        let right = if is_held { moving(&system, *contact, direction) } else { pushed(&system, *contact, direction) };
        rights.extend_from_slice(right.as_slice());
    }
    let solved = nearby.solve_all(&rights, ACCEPTED_BACKWARD_ERROR)?;
    let mut solutions = Vec::with_capacity(velocities.len() + 1);
    for ((contact, direction), values) in velocities.iter().zip(solved.chunks_exact(system.size)) {
        let mut rate = rate_recovery::rate_at(&system, &iterate, &DVector::from_column_slice(values), Kind::Rates);
        if holds(&system, *contact, direction) == Some(false) {
            rate.reactions[*contact].add(1.0, &Reaction::of(direction, &loading.frame(*contact, state).normal));
        }
        solutions.push(rate.normalised()?);
    }
    solutions.push(incoming.rate.clone());
    combined(equations, &velocities, &solutions)
}

/// Whether an entry is a single contact on a flat obstacle, at a node without supports.
fn is_plain(equations: &ModeSystem<'_>, entry: &Changeable) -> bool {
    let structure = equations.loading.structure;
    let [contact] = entry.contacts[..] else { return false };
    let Some(node) = equations.loading.contacts[contact].kinematics.node() else { return false };
    let mut freedoms = structure.translations_of(node);
    equations.loading.frame(contact, equations.anchor).curvature.is_zero()
        && freedoms.all(|freedom| structure.unknown_of[freedom].is_some())
}

/// Whether a mode prescribes a contact's velocity along a direction rather than its force; `None` where it prescribes
/// neither alone.
fn holds(equations: &ModeSystem<'_>, contact: usize, direction: &Vector) -> Option<bool> {
    match equations.roles[contact] {
        Role::Free => Some(false),
        Role::Stick => Some(true),
        Role::Frictionless | Role::Line { .. } => {
            let normal = equations.loading.frame(contact, equations.anchor).normal;
            let is_normal = *direction == normal;
            (is_normal || dot(direction, &normal).abs() <= TANGENTIAL_COSINE).then_some(is_normal)
        }
        Role::Edge { .. } | Role::Plane { .. } | Role::Held | Role::HeldBy => None,
    }
}

/// The right-hand side for a unit force along a direction on the node of a contact.
pub(crate) fn pushed(equations: &ModeSystem<'_>, contact: usize, direction: &Vector) -> DVector<f64> {
    let structure = equations.loading.structure;
    let mut values = DVector::zeros(equations.size);
    equations.loading.each_column(contact, equations.anchor, |freedom, column| {
        if let Some(unknown) = structure.unknown_of[freedom] {
            values[unknown] = dot(direction, column);
        }
    });
    values
}

/// The columns as combinations of an equal number of solutions that span them.
fn combined(equations: &ModeSystem<'_>, velocities: &[(usize, &Vector)], solutions: &[Rate]) -> Option<Vec<Rate>> {
    let count = solutions.len();
    let _held = budget::take::<f64>(2 * count * count);
    let mut parts = DMatrix::zeros(count, count);
    for (row, (contact, direction)) in velocities.iter().enumerate() {
        for (column, solution) in solutions.iter().enumerate() {
            parts[(row, column)] =
                dot(direction, &equations.loading.relative_rate(*contact, equations.anchor, solution));
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
    let factorisation = Factorisation::new(parts).filter(|parts| parts.pivot_ratio() >= SMALLEST_SPANNING_PIVOT)?;
    let column = |(index, size): (usize, &f64)| {
        let mut weights = DVector::zeros(count);
        weights[index] = 1.0 / size;
        if !factorisation.solve(&mut weights) {
            return None;
        }
        budget::spend(count * equations.size);
        let mut rate = rate_recovery::no_rate(equations);
        solutions.iter().zip(weights.iter()).for_each(|(solution, weight)| rate.add(solution, *weight));
        Some(rate)
    };
    sizes.iter().enumerate().map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::branching::directions::candidate::held_modes;
    use crate::branching::directions::condensed_rate_problem::changeable;
    use crate::check::scenes::lattice::LatticeArch;
    use crate::complementarity::rates::rate_problem::MotionOfWeights;
    use crate::continuation::path::iterator::Path;
    use crate::continuation::scene::Scene;
    use crate::mechanics::multi_contact::changeable_contacts::Standing;
    use crate::resources::cancel::CancelFlag;
    use crate::step::corrector::cached_factorisation::CachedFactorisation;
    use crate::step::corrector::cost_counters::Work;
    use crate::step::mode_step::StepStart;

    /// At the contact changes of an arch that lands, the factorisation that led to each gives the same columns as a
    /// factorisation of the equations in which the contacts are fixed, and so do rates at the contacts and what is solved
    /// for from them.
    #[test]
    fn a_factorisation_of_the_modes_before_and_rates_at_contacts_give_the_same() {
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
                // The incoming direction, computed again from a point nearby.
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
                let nearby = CachedFactorisation::shared(serving.as_ref());
                let came = ModeSystem::new(loading, &arriving.modes, state);
                let Some(incoming) = mode_factorisation::factorise_bordered(&came, &came.iterate(state.clone()), rate)
                    .and_then(|bordered| rate_recovery::tangent_by(&came, &bordered, &came.iterate(state.clone())))
                else {
                    continue;
                };
                let incoming =
                    Incoming { modes: Some(&arriving.modes), nearby: Some(&nearby), ..Incoming::along(&incoming) };
                let held = held_modes(loading, &standings);
                let system = ModeSystem::new(loading, &held, state);
                let changeable = changeable(loading, state, &standings);
                let Some(columns) = columns_nearby(&system, &changeable, incoming) else { continue };
                let factorisation = bordered_somehow(&system, None).expect("a regular point");
                let expected = columns_held(&system, &changeable, &factorisation).expect("solutions");
                by_nearby += 1;
                let mut compare = |one: &Rate, other: &Rate| {
                    let mut difference = one.clone();
                    difference.add(other, -1.0);
                    let forces = difference.largest_reaction() / other.largest_reaction().max(1.0);
                    most = most.max(difference.size() / other.size()).max(forces);
                };
                columns.iter().zip(&expected).for_each(|(one, other)| compare(one, other));
                let at_contacts = rates_at_contacts(&system, &changeable, &factorisation).expect("plain contacts");
                for (place, whole) in expected.iter().enumerate() {
                    let unit = DVector::from_fn(expected.len(), |row, _| f64::from(row == place));
                    let known = &at_contacts.rates[place];
                    compare(&Rate { displacement: whole.displacement.clone(), ..known.clone() }, whole);
                    let motion = at_contacts.solver.of(&unit).norm();
                    assert!((motion - whole.size()).abs() <= 1e-9 * motion, "{motion} and {}", whole.size());
                    compare(&RateBasis::AtContacts(at_contacts.clone()).combined(&unit), whole);
                }
            }
        }
        assert!(by_nearby >= 30, "{by_nearby} changes");
        assert!(most < 1e-9, "{most}");
    }
}
