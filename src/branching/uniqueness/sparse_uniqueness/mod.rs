//! Directions where many contacts can change, without a condensed matrix of their velocities.
//!
//! Let `w >= 0` be the speeds of the nodes on their cones, along the directions `d` in which they may slip, and
//! `y = μ ṙ_n + d·ṙ_t >= 0` the rates at which their forces move into the cones, `w y = 0`; let `v` be the velocities
//! of the nodes that touch without reaction, and `x` those of the free nodes. The rates obey
//!
//! ```text
//! A (x, w, v) - q ṡ = (0, y, ṙ),      A = Rᵀ K C,      columns C of a node on its cone: d,      rows R: d + μ n
//! ```
//!
//! in the plane. [`proof`] shows by sparse Cholesky factorisations where each load rate has at most one solution;
//! [`pivoting`] finds it: solve in a mode, change every contact that violates it, and repeat. Time and memory are
//! proportional to the size of the structure's matrices.
//!
//! Where the contacts are too many for the condensed matrix and there is no such proof, the directions found by
//! pivoting are listed, and the modes not examined are counted.

pub(crate) mod pivoting;
pub(crate) mod proof;
pub(crate) mod sparse_rate_equations;
#[cfg(test)]
mod tests;
pub(crate) mod tolerances;

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::FoundDirections;
use crate::complementarity::rate_search::branch_and_bound::Effort;
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;
use proof::DistinguishingQuantity;
use sparse_rate_equations::Equations;

/// Numbers of contacts that can change up to which a search of all combinations is as fast: of all of them, and of
/// those that touch, each of which has four modes.
const FEW: usize = 16;
const FEW_TOUCHING: usize = 3;
/// Lower bound of this number with sparse matrices: each contact that can change takes one more solve, which is cheaper
/// relative to the factorisations of a proof the longer the factor's columns are.
const FEW_OF_MANY: usize = 4;
/// Upper bound: up to here dense matrices of the contacts take less time than the factorisations of large structures. The
/// search, which may have to try every combination, is cut short where it takes too long.
const MOST_OF_MANY: usize = 512;
/// A proof takes a multiple of the squares of the entries of a column of the factor, the search one solve for each
/// contact: so many contacts as this part of the square can be searched as fast. A block of 8,256 unknowns, with some 45
/// entries and up to 129 slipping contacts, takes 12.0, 11.4 and 9.6 s with 15, 45 and 180.
const CONTACTS_OF_SQUARE: usize = 10;
/// Largest number of entries of the condensed equations (velocities of contacts that can change times the reactions of all).
const MOST_CONDENSED: usize = 25_000_000;

/// Lists the directions; `false` where they are not proven to be complete and the contacts are few enough for a search.
pub(crate) fn directions(
    loading: Loading<'_>,
    state: &State,
    standings: &[Standing],
    incoming: Option<Incoming<'_>>,
    effort: Effort<'_>,
    found: &mut FoundDirections,
) -> bool {
    if !effort.certify {
        return false;
    }
    let Some(equations) = Equations::new(loading, state, standings) else { return false };
    let columns = equations.changing.len() * loading.structure.dimension;
    let is_huge = columns * 4 * loading.contacts.len() > MOST_CONDENSED;
    // Where contacts are few, families of motions that no element resists are left to the search.
    let is_few = equations.changing.len() <= FEW;
    let proof = proof::proof(&equations, incoming.map(|incoming| incoming.rate))
        .filter(|proof| !is_few || proof.free_motions() <= 1);
    if proof.is_none() && !is_huge {
        return false;
    }
    let mut candidates = Vec::new();
    let mut complete = proof.is_some();
    for sign in [1.0, -1.0] {
        if proof.as_ref().is_some_and(|proof| proof::has_none(&equations, sign, proof)) {
            continue;
        }
        let control = proof.as_ref().map_or(DistinguishingQuantity::Load, |proof| proof.control);
        let candidate = pivoting::solve(&equations, control, sign, incoming);
        complete &=
            proof.as_ref().zip(candidate.as_ref()).is_some_and(|(proof, one)| proof::is_only(&equations, one, proof));
        candidates.extend(candidate);
    }
    if !complete && !is_huge {
        return false;
    }
    if let Some(proof) = proof.filter(|_| complete) {
        proof::add_free_motions(&equations, &proof, found);
        if proof.control == DistinguishingQuantity::Power {
            candidates.extend(pivoting::at_rest(&equations));
        }
    }
    found.candidates.extend(candidates);
    found.is_proven = complete;
    found.candidates.sort_by_cached_key(|candidate| pivoting::order(&equations, candidate));
    if !complete {
        let modes = |ways: u64, count: usize| ways.saturating_pow(u32::try_from(count).unwrap_or(u32::MAX));
        let touching = equations.changing.iter().filter(|one| one.direction.is_none()).count();
        found.unexplored = modes(2, equations.changing.len() - touching).saturating_mul(modes(4, touching));
    }
    true
}

/// Whether the search is faster than a proof.
pub(crate) fn are_few(loading: Loading<'_>, standings: &[Standing]) -> bool {
    let touching = standings.iter().filter(|standing| matches!(standing, Standing::Touching)).count();
    let changing = standings.iter().filter(|standing| !matches!(standing, Standing::Settled(_))).count();
    let few = loading.structure.layout().map_or(FEW, |layout| {
        let entries_of_column = layout.pattern.factor_entries() / layout.pattern.size().max(1);
        (entries_of_column * entries_of_column / CONTACTS_OF_SQUARE).clamp(FEW_OF_MANY, MOST_OF_MANY)
    });
    changing <= few && touching <= FEW_TOUCHING
}
