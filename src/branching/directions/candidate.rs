//! Directions of first order: the rate, and the contact modes compatible with it.

use crate::algebra::null_space;
use crate::branching::directions::tolerances::{FRICTION_ROUND_OFF, MERGE_TOLERANCE, WEAK_MARGIN};
use crate::mechanics::contact::vector::{Vector, add, size};
use crate::mechanics::contact::{ContactPair, Mode, Reaction};
use crate::mechanics::equations::tolerances::RANK_TOLERANCE;
use crate::mechanics::equations::{ModeSystem, matrix, rate_recovery};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use itertools::Itertools;

/// A feasible direction.
#[derive(Debug, Clone)]
pub struct CandidateDirection {
    pub rate: Rate,
    /// Rates of the contact forces, those on the same node combined: see `node_contact_forces::whole_rates`.
    pub forces: Vec<Vector>,
    /// Modes under which the direction is feasible at first order: stuck where a contact may stick.
    pub modes: Vec<Mode>,
    /// The modes that contacts which change together admit, exactly or nearly at first order, one entry for each that
    /// can change (contacts without doubt may be omitted); more than one alternative where an inequality holds with
    /// equality. Every combination of alternatives that hold is feasible.
    pub alternatives: Vec<Vec<Alternative>>,
    /// Some inequality holds with equality: only a finite step can decide whether the direction exists.
    pub weak: bool,
    /// `-r_t·u̇_t` summed over the contacts.
    pub dissipation: f64,
    /// The factorisation with which the direction was found, bordered by it.
    pub cached: CachedFactorisation,
}

/// Modes of contacts that change together.
pub type Alternative = Vec<(usize, Mode)>;

/// The directions found at a point.
#[derive(Debug, Clone, Default)]
pub struct FoundDirections {
    pub candidates: Vec<CandidateDirection>,
    /// A matrix whose principal minors are all positive proves that the list is complete.
    pub is_proven: bool,
    /// Modes that were not examined.
    pub unexplored: u64,
    /// Number of unexamined modes in which nodes in space begin to slip simultaneously, in directions not proven to be
    /// complete.
    pub slips_in_doubt: u64,
    /// Some mode has more than one independent direction.
    pub degenerate: bool,
    /// Some direction set contains a motion that no element resists.
    pub mechanism: bool,
    /// A node is in contact with several obstacles in a configuration that is not available.
    pub corner_not_available: bool,
}

/// Largest number of candidates among which inner members of families are sought, in each with every pair of the others.
/// Longer lists are those of several contacts that change independently, which are isolated.
const MOST_COMPARED: usize = 24;

/// The modes in which every contact that can change sticks, or remains closed where it has no friction.
pub(crate) fn held_modes(loading: Loading<'_>, standings: &[Standing]) -> Vec<Mode> {
    let held = |(standing, contact): (&Standing, &ContactPair)| match standing {
        Standing::Settled(mode) => *mode,
        Standing::OnCone { .. } | Standing::Cornered { .. } => Mode::Stick,
        Standing::Touching if contact.tangents() > 0 => Mode::Stick,
        Standing::Touching => Mode::Slip { direction: [0.0; 3] },
    };
    standings.iter().zip(loading.contacts).map(held).collect()
}

/// Whether the structure with these contacts closed has a motion that no element resists.
pub(crate) fn resists_nothing(system: &ModeSystem<'_>, loading: Loading<'_>, state: &State) -> bool {
    if !loading.structure.allows_dense() {
        return false;
    }
    let matrix = matrix::rate_matrix(system, state);
    let Some(basis) = null_space(&matrix.rows(0, system.size() - 1).into_owned(), RANK_TOLERANCE) else { return false };
    basis.column_iter().any(|column| {
        let rate = rate_recovery::rate_from(system, state, &column.into_owned());
        is_mechanism(loading, state, &rate)
    })
}

/// Whether a rate is a mechanism: a motion that no element resists, without change of load or reactions.
pub fn is_mechanism(loading: Loading<'_>, state: &State, rate: &Rate) -> bool {
    let size = rate.size();
    size > 0.0
        && rate.load.abs() < WEAK_MARGIN * size
        && rate.largest_reaction() < WEAK_MARGIN * size
        && loading.structure.resistance(&state.displacement, &rate.displacement) < WEAK_MARGIN
}

/// Adds a candidate; candidates with the same motion are merged into one entry, whatever their modes.
pub(crate) fn merge(found: &mut FoundDirections, candidate: CandidateDirection) {
    for known in &mut found.candidates {
        let same_motion = (1.0 - known.rate.product(&candidate.rate)) < 0.5 * MERGE_TOLERANCE * MERGE_TOLERANCE;
        if same_motion && difference_of_forces(&known.forces, &candidate.forces, 1.0) <= MERGE_TOLERANCE {
            for (alternatives, others) in known.alternatives.iter_mut().zip(candidate.alternatives) {
                for other in others {
                    if !alternatives.contains(&other) {
                        alternatives.push(other);
                    }
                }
                sort(alternatives);
            }
            known.weak = true;
            return;
        }
    }
    found.candidates.push(candidate);
}

/// Removes candidates that are combinations of two others with positive weights, in motions and forces; returns whether
/// there were any.
///
/// Where a whole family of directions continues the path (both feet of a frame slip, and how the slip is shared is left
/// open), the equations of its inner members are singular: round-off alone names one of them, and no step follows it.
/// The edges of the family remain.
pub(crate) fn remove_inner(candidates: &mut Vec<CandidateDirection>) -> bool {
    if !(3..=MOST_COMPARED).contains(&candidates.len()) {
        return false;
    }
    let is_inner = |which: usize| {
        let others = (0..candidates.len()).filter(|other| *other != which);
        others
            .array_combinations()
            .any(|[first, second]| is_between(&candidates[which], &candidates[first], &candidates[second]))
    };
    let keeps: Vec<bool> = (0..candidates.len()).map(|which| !is_inner(which)).collect();
    let removes = keeps.contains(&false);
    let mut keeps = keeps.into_iter();
    candidates.retain(|_| keeps.next().unwrap_or(true));
    removes
}

/// Whether a candidate is the sum of positive multiples of two others along which the load changes in the same sense: a
/// motion without load, such as a rigid one, is no edge of a family of loaded ones.
fn is_between(inner: &CandidateDirection, first: &CandidateDirection, second: &CandidateDirection) -> bool {
    let is_loaded = |one: &CandidateDirection| one.rate.load * inner.rate.load.signum() > MERGE_TOLERANCE;
    // In the inner member's modes, at most at their edge: a contact that slips in them may stick.
    let is_within = |edge: &CandidateDirection| {
        inner.modes.iter().zip(&edge.modes).all(|(own, of_edge)| {
            own.continues(*of_edge) || (matches!(own, Mode::Slip { .. }) && *of_edge == Mode::Stick)
        })
    };
    if ![first, second].into_iter().all(|edge| is_loaded(edge) && is_within(edge)) {
        return false;
    }
    let cosine = first.rate.product(&second.rate);
    let parts = [&first.rate, &second.rate].map(|rate| rate.product(&inner.rate));
    let determinant = 1.0 - cosine * cosine;
    if determinant <= MERGE_TOLERANCE {
        return false;
    }
    let weights = [(parts[0] - cosine * parts[1]) / determinant, (parts[1] - cosine * parts[0]) / determinant];
    if weights.iter().any(|weight| *weight <= MERGE_TOLERANCE) {
        return false;
    }
    let mut rest = inner.rate.clone();
    rest.add(&first.rate, -weights[0]);
    rest.add(&second.rate, -weights[1]);
    // Friction may be small beside all other forces: each is compared with itself.
    let least = FRICTION_ROUND_OFF * inner.rate.largest_reaction();
    let is_alike = |(rest, own): (&Reaction, &Reaction)| {
        rest.normal.abs() <= MERGE_TOLERANCE * own.normal.abs() + least
            && size(&rest.tangential) <= MERGE_TOLERANCE * size(&own.tangential) + least
    };
    rest.size() <= MERGE_TOLERANCE && rest.reactions.iter().zip(&inner.rate.reactions).all(is_alike)
}

/// Largest difference between forces and a multiple of others, relative to the largest of all.
pub(crate) fn difference_of_forces(forces: &[Vector], others: &[Vector], factor: f64) -> f64 {
    let largest = forces.iter().chain(others).fold(f64::MIN_POSITIVE, |largest, force| largest.max(size(force)));
    forces
        .iter()
        .zip(others)
        .fold(0.0, |most, (force, other)| f64::max(most, size(&add(force, -factor, other)) / largest))
}

/// Sorts alternatives: those with more sticking contacts first, then those with more closed contacts.
pub(crate) fn sort(alternatives: &mut [Alternative]) {
    let count = |modes: &Alternative, is: fn(&Mode) -> bool| modes.iter().filter(|(_, mode)| is(mode)).count();
    alternatives
        .sort_by_key(|modes| (count(modes, |mode| *mode != Mode::Stick), count(modes, |mode| *mode == Mode::Free)));
}
