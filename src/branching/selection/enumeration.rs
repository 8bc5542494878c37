//! All one-sided directions of the path at a point.
//!
//! Contacts that cannot change keep their equations. For the others (on the cone, or touching without reaction) let `v`
//! be their velocities against the obstacle. With all of them fixed, the rate equations
//!
//! ```text
//! K u̇ - f ṡ - B ṙ = 0,    G u̇ = v
//! ```
//!
//! have one solution for each `v` and one more, `z₀`, along which the structure with fixed contacts moves: one
//! factorisation, bordered so that it is regular, gives `(u̇, ṡ, ṙ)` as a linear function of `(v, τ)`. Each contact
//! mode is then a small linear system in `(v, τ)` with one-dimensional solution, taken in both senses and kept where it
//! satisfies
//!
//! ```text
//! on the cone   stick: v = 0, μ ṙ_n + d ṙ_t >= 0     slip: μ ṙ_n + d ṙ_t = 0, d v_t >= 0
//! touching      free: ṙ = 0, ġ >= 0                  stick: v = 0, μ ṙ_n >= |ṙ_t|
//!               slip: ġ = 0, ṙ_t = -μ d ṙ_n, ṙ_n >= 0, d v_t >= 0
//! ```
//!
//! The rate problem is that of A. Klarbring, Ing. Arch. 60 (1990) 529, doi:10.1007/BF00541909; the condensation on the
//! contacts is the usual one. The zero set of a piecewise linear map from n+1 to n unknowns is an even number of rays
//! where it is not degenerate: an odd count is reported.

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::{FoundDirections, held_modes, resists_nothing};
use crate::branching::directions::condensed_rate_problem::Condensed;
use crate::branching::uniqueness::sparse_uniqueness;
use crate::complementarity::rate_search::branch_and_bound::Effort;
use crate::mechanics::equations::ModeSystem;
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::multi_contact::determinacy;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::State;

/// Lists the directions; `incoming` may border the equations where the structure with fixed contacts is singular.
pub fn directions(
    loading: Loading<'_>,
    state: &State,
    standings: &[Standing],
    incoming: Option<Incoming<'_>>,
    effort: Effort<'_>,
) -> FoundDirections {
    let held = held_modes(loading, standings);
    let system = ModeSystem::new(loading, &held, state);
    let mut found = FoundDirections::default();
    if determinacy::is_not_available(loading, state) {
        found.corner_not_available = true;
        return found;
    }
    let are_few = sparse_uniqueness::are_few(loading, standings);
    if !are_few && sparse_uniqueness::directions(loading, state, standings, incoming, effort, &mut found) {
        return found;
    }
    let Some(condensed) = Condensed::new(&system, loading, state, standings, incoming) else {
        found.degenerate = true;
        found.mechanism = resists_nothing(&system, loading, state);
        return found;
    };
    condensed.enumerate(&held, state, incoming.map(|incoming| incoming.rate), effort, &mut found);
    if are_few && found.unexplored > 0 && loading.structure.layout().is_some() {
        // Where the search was cut short, a uniqueness proof may succeed.
        let mut proven = FoundDirections::default();
        if sparse_uniqueness::directions(loading, state, standings, incoming, effort, &mut proven) && proven.is_proven {
            return proven;
        }
    }
    found
}
