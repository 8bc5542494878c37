//! Whether the state at a point is stable.
//!
//! Two questions are answered. How many eigenvalues of the tangent in the present contact mode are negative: the equations
//! of the rates without load,
//!
//! ```text
//! [ K  C ] [v]       [κ v]
//! [ G  0 ] [ρ]   =   [ 0 ]
//! ```
//!
//! with the columns `C` of the contacts' forces, friction included, and the rows `G` of their motions; `1/(κ - σ)` are the
//! eigenvalues of the first block of the inverse with `K - σ` in the place of `K`, where the shift `σ` is 0 unless a `κ` is. Without slip against friction the tangent is symmetric.
//!
//! And whether the state is stable while the load stays (dead load), by the directional criterion of frictional contact
//! (J. A. C. Martins, A. Pinto da Costa, Int. J. Solids Struct. 37 (2000) 2519): the state is unstable if some motion `v e^{λt}`,
//! `λ > 0`, is admissible, that is if
//!
//! ```text
//! (λ² M + λ C + K) v = Σ Bᵀ ṙ,     v and ṙ by the laws of contact and friction in rates
//! ```
//!
//! Mass and damping are equal at all degrees of freedom, so that `-κ` takes the place of `λ²` and `λ`, and the answer is
//! the same for both. Contacts that can change make this an eigenvalue complementarity problem.
//!
//! | file | contents |
//! |---|---|
//! | `mode_eigenvalues` | the eigenvalues of one contact mode, and their motions |
//! | `growing_motion` | admissible growing motions: all modes of few contacts, some of many |
//! | `definite_tangent` | a test that is sufficient for stability however many contacts can change |

mod definite_tangent;
mod growing_motion;
mod mode_eigenvalues;
mod tolerances;

use crate::branching::bifurcation::singularity::test_functions::negative_eigenvalues;
use crate::branching::directions::trial_step::stepped;
use crate::branching::stability::growing_motion::GrowthVerdict;
use crate::branching::stability::mode_eigenvalues::ModeEigenvalues;
use crate::branching::stability::tolerances::{MOST_UNKNOWNS, SHORT_WAYS};
use crate::mechanics::contact::{ContactPair, Mode};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{DeadLoadStability, Instability, Stability};
use crate::step::corrector::cost_counters::Work;

/// A state, the modes of its contacts, and those that can change.
#[derive(Clone, Copy)]
pub(crate) struct AssessedState<'a> {
    pub loading: Loading<'a>,
    pub state: &'a State,
    pub modes: &'a [Mode],
    pub standings: &'a [Standing],
    /// An eigenvalue of these modes is zero: the point is a limit or bifurcation point.
    pub is_critical: bool,
}

impl AssessedState<'_> {
    /// Whether some contact slips against friction in these modes.
    fn slips(&self, modes: &[Mode]) -> bool {
        let slips =
            |(mode, contact): (&Mode, &ContactPair)| matches!(mode, Mode::Slip { .. }) && contact.tangents() > 0;
        modes.iter().zip(self.loading.contacts).any(slips)
    }

    fn can_change(&self) -> bool {
        self.standings.iter().any(|standing| !matches!(standing, Standing::Settled(_)))
    }
}

/// The stability of a state.
pub(crate) fn assess(at: AssessedState<'_>, cancel: &CancelFlag, work: &mut Work) -> Stability {
    if at.loading.structure.unknowns() > MOST_UNKNOWNS {
        return of_many_unknowns(at, work);
    }
    let present = ModeEigenvalues::in_modes(at, at.modes, work);
    let negative = present.as_ref().map(|present| present.negative() as u64);
    let flutters = present.as_ref().is_some_and(ModeEigenvalues::is_complex);
    // Oscillations of contacts that slip against friction at rest would have to slip back.
    let dead_load = if flutters && !at.slips(at.modes) && !at.can_change() {
        DeadLoadStability::Unstable
    } else {
        dead_load(at, cancel, work)
    };
    // Where the state is stable, contacts prevent the motions of negative eigenvalues.
    let is_soft = negative.is_some_and(|count| count > 0) && dead_load != DeadLoadStability::Stable;
    let diverges = dead_load == DeadLoadStability::Unstable && !flutters || is_soft;
    let instability = match (diverges, flutters) {
        (true, _) => Some(Instability::Divergence),
        (false, true) => Some(Instability::Flutter),
        (false, false) => None,
    };
    Stability { negative_eigenvalues: negative, dead_load, instability }
}

fn dead_load(at: AssessedState<'_>, cancel: &CancelFlag, work: &mut Work) -> DeadLoadStability {
    if at.can_change() && !at.is_critical && definite_tangent::is_definite(at, work) {
        return DeadLoadStability::Stable;
    }
    match growing_motion::search(at, cancel, work) {
        GrowthVerdict::Found => DeadLoadStability::Unstable,
        GrowthVerdict::None => DeadLoadStability::Stable,
        GrowthVerdict::NotDecided => DeadLoadStability::Unknown,
    }
}

/// The number of negative eigenvalues a short way along a direction, in its modes; `None` where it is not found.
pub(crate) fn negative_ahead(
    loading: Loading<'_>,
    state: &State,
    (rate, modes): (&Rate, &[Mode]),
    force_scale: f64,
) -> Option<usize> {
    if loading.structure.unknowns() > MOST_UNKNOWNS {
        return None;
    }
    let ahead = |way: &f64| stepped(loading, state, rate, modes, *way, force_scale);
    let (corrected, _) = SHORT_WAYS.iter().find_map(ahead)?;
    let at = AssessedState { loading, state: &corrected.state, modes, standings: &[], is_critical: false };
    ModeEigenvalues::in_modes(at, modes, &mut Work::default()).map(|found| found.negative())
}

/// By the signs of pivots alone, where no contact slips against friction.
fn of_many_unknowns(at: AssessedState<'_>, work: &mut Work) -> Stability {
    let count = |modes: &[Mode], work: &mut Work| {
        let allowed = at.loading.structure.allows_dense() && !at.slips(modes);
        allowed.then(|| negative_eigenvalues(at.loading, modes, at.state, at.state, work)).flatten()
    };
    let negative = count(at.modes, work);
    // With every contact open that can open, more motions are admissible than there are.
    let loose = at.standings.iter().map(|standing| match standing {
        Standing::Touching => Some(Mode::Free),
        Standing::Settled(mode) => Some(*mode),
        Standing::OnCone { .. } | Standing::Cornered { .. } => None,
    });
    let loose: Option<Vec<Mode>> = loose.collect();
    let of_loose = loose.and_then(|modes| if modes == at.modes { negative } else { count(&modes, work) });
    let dead_load = match (of_loose, negative) {
        _ if at.is_critical => DeadLoadStability::Unknown,
        (Some(0), _) => DeadLoadStability::Stable,
        (Some(_), Some(own)) if own > 0 && !at.can_change() => DeadLoadStability::Unstable,
        _ => DeadLoadStability::Unknown,
    };
    let instability = (dead_load == DeadLoadStability::Unstable).then_some(Instability::Divergence);
    Stability { negative_eigenvalues: negative.map(|count| count as u64), dead_load, instability }
}
