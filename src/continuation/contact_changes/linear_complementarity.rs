//! Finds the frictionless contacts that are closed at the end of a step from a single linearisation.
//!
//! Let `x₀` be the state after one iteration in some mode, and `x_j` the solutions of the same equations for a unit
//! force of each contact that is open in this mode and for a unit gap of each closed contact. Each `x₀ + Σ z_j x_j`
//! satisfies equilibrium to first order. Let `w` be the gaps of the open contacts and the forces of the closed ones:
//!
//! ```text
//! w = w₀ + M z,    0 <= w ⊥ z >= 0
//! ```
//!
//! This linear complementarity problem of the contacts that change is solved by block pivoting, without the safeguard
//! against cycling. A contact enters the problem when its own sign is wrong.

use crate::algebra::sparse::SparseFactorisation;
use crate::algebra::{Factorisation, SystemFactorisation};
use crate::branching::directions::condensation_basis;
use crate::complementarity::rates::block_pivoting::{self, RoundResult, Rounds};
use crate::mechanics::contact::vector::dot;
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::equations::{Kind, ModeSystem, rate_recovery};
use crate::mechanics::problem::state::{Rate, State};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Largest number of contacts that may change: for each a solution of the size of the structure is stored.
const MOST_CHANGING: usize = 64;
/// Largest number of active sets tried.
const MOST_SETS: usize = 12;

/// The end of a step by the equations linearised once.
pub(crate) struct Complementary {
    /// The contacts that change.
    pub changed: Vec<usize>,
    /// Approximate state at the end of the step after these changes.
    pub state: State,
    /// Whether the stiffness condensed on the contacts that may change is positive definite.
    pub leaves_no_choice: bool,
}

/// The contacts known so far that may change.
struct ActiveSetCandidates {
    contacts: Vec<usize>,
    /// Whether each contact is changed.
    are_changed: Vec<bool>,
    /// The rate for the unit force or unit gap of each contact.
    columns: Vec<Rate>,
}

/// The contacts that change near the state found by one iteration of this system, with the factorisation of the
/// iteration; the `first` contacts are known to violate their modes. `broken` returns the contacts that violate their
/// modes at a state, or `None` where another quantity is violated; `rate` is the approximate direction of the path
/// there. `None` where no consistent set is found.
pub(crate) fn complementary(
    system: &ModeSystem<'_>,
    state: &State,
    rate: &Rate,
    factorisation: &SystemFactorisation,
    first: &[usize],
    broken: impl Fn(&State) -> Option<Vec<usize>>,
) -> Option<Complementary> {
    let SystemFactorisation::Sparse(factorisation) = factorisation else { return None };
    let mut changing = ActiveSetCandidates { contacts: Vec::new(), are_changed: Vec::new(), columns: Vec::new() };
    join(system, &mut changing, first, state, factorisation)?;
    let examine = |changing: &ActiveSetCandidates| {
        let (end, wrong) = with_changes(system, changing, state)?;
        let mut changes: Vec<SetChange> = wrong.into_iter().map(SetChange::Toggled).collect();
        for contact in broken(&end)? {
            match changing.contacts.iter().position(|other| *other == contact) {
                // Contacts already changed are judged by their new modes.
                Some(at) if changing.are_changed[at] => {}
                Some(at) => changes.push(SetChange::Toggled(at)),
                None => changes.push(SetChange::Joined(contact)),
            }
        }
        if !changes.is_empty() {
            return Some(RoundResult::Violated(changes));
        }
        let changed = changing.contacts.iter().zip(&changing.are_changed);
        let changed = changed.filter_map(|(contact, is_changed)| is_changed.then_some(*contact)).collect();
        let leaves_no_choice = leaves_no_choice(system, changing, state, rate);
        Some(RoundResult::Solved(Complementary { changed, state: end, leaves_no_choice }))
    };
    let change = |changing: &mut ActiveSetCandidates, changes: Vec<SetChange>| {
        let mut joining = Vec::new();
        for change in changes {
            match change {
                SetChange::Toggled(at) => changing.are_changed[at] ^= true,
                SetChange::Joined(contact) => joining.push(contact),
            }
        }
        join(system, changing, &joining, state, factorisation)
    };
    // The result serves only as a guess, so that a cycle of blocks need not be broken.
    block_pivoting::block_pivot(changing, Rounds { in_blocks: MOST_SETS, one_by_one: 0 }, examine, change)
}

/// A change of the set of contacts that change.
enum SetChange {
    /// A contact known to the set, by its index there, changes or changes no longer.
    Toggled(usize),
    /// A contact joins the set and changes.
    Joined(usize),
}

/// Adds contacts to those that may change.
fn join(
    system: &ModeSystem<'_>,
    changing: &mut ActiveSetCandidates,
    contacts: &[usize],
    state: &State,
    factorisation: &SparseFactorisation,
) -> Option<()> {
    if changing.contacts.len() + contacts.len() > MOST_CHANGING {
        return None;
    }
    let normal = |contact: usize| system.loading.frame(contact, state).normal;
    let mut values = Vec::with_capacity(contacts.len() * system.size);
    for contact in contacts {
        let is_closed = system.modes[*contact].is_active();
        let right = if is_closed { condensation_basis::moving } else { condensation_basis::pushed };
        values.extend_from_slice(right(system, *contact, &normal(*contact)).as_slice());
    }
    if !factorisation.solve_all_once(&mut values, contacts.len()) || !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    let iterate = system.iterate(state.clone());
    for (contact, values) in contacts.iter().zip(values.chunks_exact(system.size)) {
        let mut rate = rate_recovery::rate_at(system, &iterate, &DVector::from_column_slice(values), Kind::Rates);
        if system.modes[*contact] == Mode::Free {
            let normal = normal(*contact);
            rate.reactions[*contact].add(1.0, &Reaction::of(&normal, &normal));
        }
        changing.columns.push(rate);
        changing.contacts.push(*contact);
        changing.are_changed.push(true);
    }
    Some(())
}

/// Whether at constant load the matrix of the open contacts' gaps due to their forces, and that of the closed contacts'
/// forces due to their gaps, are positive definite: then (additivity of inertia) the tangent has as many negative
/// eigenvalues with all of these contacts closed as with all of them open.
fn leaves_no_choice(system: &ModeSystem<'_>, changing: &ActiveSetCandidates, state: &State, rate: &Rate) -> bool {
    [false, true].into_iter().all(|are_closed| {
        let contacts: Vec<usize> = (0..changing.contacts.len())
            .filter(|at| system.modes[changing.contacts[*at]].is_active() == are_closed)
            .collect();
        let matrix = DMatrix::from_fn(contacts.len(), contacts.len(), |row, column| {
            let (contact, column) = (changing.contacts[contacts[row]], &changing.columns[contacts[column]]);
            // The columns are solutions at constant arc length.
            let along = left_over_by(system, contact, rate, state) * column.load / rate.load;
            left_over_by(system, contact, column, state) - along
        });
        Cholesky::new(matrix).is_some()
    })
}

/// The rate of a contact's constraint residual: the force of a contact that is closed in the mode, the gap of one that
/// is open.
fn left_over_by(system: &ModeSystem<'_>, contact: usize, rate: &Rate, state: &State) -> f64 {
    if system.modes[contact].is_active() {
        rate.reactions[contact].normal
    } else {
        let normal = system.loading.frame(contact, state).normal;
        dot(&normal, &system.loading.relative_rate(contact, state, rate))
    }
}

/// The state at which the changed contacts satisfy their new modes, and those among them with the wrong sign there.
fn with_changes(system: &ModeSystem<'_>, changing: &ActiveSetCandidates, state: &State) -> Option<(State, Vec<usize>)> {
    let changed: Vec<usize> = (0..changing.contacts.len()).filter(|at| changing.are_changed[*at]).collect();
    let count = changed.len();
    if count == 0 {
        return Some((state.clone(), Vec::new()));
    }
    let entry = |row: usize, column: usize| {
        left_over_by(system, changing.contacts[changed[row]], &changing.columns[changed[column]], state)
    };
    let left_over = |row: usize| {
        let contact = changing.contacts[changed[row]];
        let is_closed = system.modes[contact].is_active();
        if is_closed { state.reactions[contact].normal } else { system.loading.gap(contact, state) }
    };
    let matrix = DMatrix::from_fn(count, count, entry);
    let mut parts = DVector::from_fn(count, |row, _| -left_over(row));
    if !Factorisation::new(matrix)?.solve(&mut parts) {
        return None;
    }
    let mut end = state.clone();
    changed.iter().zip(parts.iter()).for_each(|(at, part)| end.advance(&changing.columns[*at], *part));
    let wrong = changed.iter().zip(parts.iter()).filter(|(_, part)| **part < 0.0).map(|(at, _)| *at).collect();
    Some((end, wrong))
}

#[cfg(test)]
mod tests {
    use super::complementary;
    use crate::check::scenes::lattice::LatticeArch;
    use crate::continuation::contact_changes::simultaneous;
    use crate::continuation::path::iterator::Path;
    use crate::continuation::scene::Scene;
    use crate::mechanics::contact::Mode;
    use crate::mechanics::equations::ModeSystem;
    use crate::mechanics::equations::closing_equation::ArcLengthEquation;
    use crate::mechanics::problem::state::State;
    use crate::resources::cancel::CancelFlag;
    use crate::step::corrector::cost_counters::Work;
    use crate::step::corrector::newton;
    use crate::step::corrector::single_iteration;
    use crate::step::mode_step::StepStart;
    use std::collections::BTreeSet;

    /// Where an arch lands on several contacts at a time, its equations linearised without them approximate the state
    /// with them: gaps and forces obey the contact law, most of the contacts' effect on the step is predicted, and the
    /// uniqueness test agrees with the eigenvalues of the tangent.
    #[test]
    fn the_end_of_a_step_onto_several_contacts_is_foreseen() {
        let arch = LatticeArch { increments: 150, friction: 0.0, ..LatticeArch::of_unknowns(400) }.landing(40);
        let mut scene = Scene::new(&arch.request().expect("a request")).expect("a scene");
        scene.structure.set_sparse(true);
        let mut path = Path::new(&scene, CancelFlag::default());
        let (mut looks, mut choices, mut most) = (0, 0, 0.0_f64);
        while path.next().is_some() {
            let (loading, here) = (path.trace.loading(), &path.trace.at.here);
            let Some(rate) = &here.rate else { continue };
            let step = path.trace.at.step;
            let closing = ArcLengthEquation { from: &here.state, step };
            let forces = path.trace.at.totals.force_scale;
            let start = StepStart {
                loading,
                state: &here.state,
                rate,
                modes: &here.modes,
                drift: None,
                force_scale: forces,
                is_singular: false,
                beside: None,
            };
            let broken = |state: &State| simultaneous::broken(&start, &here.modes, state, forces);
            let system = ModeSystem::new(loading, &here.modes, &here.state).along(rate);
            let guess = here.state.advanced(rate, step);
            let Some((far, factorisation)) =
                single_iteration::iterated_once(&system, guess, &closing, &mut Work::default())
            else {
                continue;
            };
            let Some(first) = broken(&far).filter(|first| first.len() > 1) else { continue };
            let along = single_iteration::direction_about(&system, &far, &factorisation, rate).expect("a direction");
            let Some(foreseen) = complementary(&system, &far, &along, &factorisation, &first, broken) else { continue };
            let asked: BTreeSet<usize> = first.iter().chain(&foreseen.changed).copied().collect();
            let counted = simultaneous::negative_where_held_or_free(&start, &asked, &far, &mut Work::default());
            assert_eq!(foreseen.leaves_no_choice, counted.is_some(), "{asked:?}");
            choices += u32::from(!foreseen.leaves_no_choice);
            let mut modes = here.modes.clone();
            for contact in &foreseen.changed {
                let is_closed = modes[*contact].is_active();
                modes[*contact] = if is_closed { Mode::Free } else { Mode::Slip { direction: [0.0; 3] } };
            }
            for (contact, mode) in modes.iter().enumerate() {
                let (gap, force) = (loading.gap(contact, &foreseen.state), foreseen.state.reactions[contact].normal);
                let (none, some) = if mode.is_active() { (gap, force) } else { (force, gap) };
                assert!(none.abs() < 1e-9 && some > -1e-9, "contact {contact} of {first:?}: gap {gap}, force {force}");
            }
            let system = ModeSystem::new(loading, &modes, &here.state);
            let Ok(end) = newton::correct(&system, foreseen.state.clone(), &closing, forces) else { continue };
            looks += 1;
            most = most.max(end.state.distance(&foreseen.state) / far.distance(&foreseen.state));
        }
        assert!(looks >= 10 && choices >= 1, "{looks} steps, {choices} with a choice");
        assert!(most < 0.4, "{most}");
    }
}
