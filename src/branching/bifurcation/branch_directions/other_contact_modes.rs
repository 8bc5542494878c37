//! Directions at a bifurcation point in other modes of the contacts that can change there.

use crate::branching::bifurcation::branch_directions::tolerances::DOUBTFUL_MARGIN;
use crate::branching::bifurcation::branch_directions::{Branches, BranchingPoint, MOST_MODES, SingularPoint};
use crate::branching::bifurcation::singularity::bordering::{Bordering, orthonormal};
use crate::branching::bifurcation::singularity::null_vectors::NullVectors;
use crate::branching::bifurcation::singularity::tolerances::SINGULAR_PIVOT;
use crate::complementarity::rates::cartesian_product::{combinations, count};
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::{ModeSystem, rate_recovery};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use nalgebra::{DMatrix, DVector};

/// Adds the directions in other modes of the contacts that can change to those in `found`.
///
/// For points at which the structure with these contacts fixed is singular, so that the rate problem cannot be
/// condensed on them: every combination of modes is examined separately. `nulls` are the null vectors in the modes
/// `modes`, where they are already known.
pub fn in_other_modes(here: SingularPoint<'_>, modes: &[Mode], nulls: Option<&NullVectors>, found: &mut Branches) {
    let options: Vec<Vec<Mode>> = here
        .standings
        .iter()
        .zip(here.loading.contacts)
        .zip(modes)
        .map(|((standing, contact), mode)| match standing {
            Standing::OnCone { direction } => vec![Mode::Stick, Mode::Slip { direction: *direction }],
            Standing::Touching if contact.tangents() > 0 => vec![Mode::Stick, Mode::Free],
            Standing::Touching => vec![Mode::Slip { direction: [0.0; 3] }, Mode::Free],
            Standing::Settled(_) | Standing::Cornered { .. } => vec![*mode],
        })
        .collect();
    found.unexplored = found.unexplored.saturating_add(count(&options).saturating_sub(MOST_MODES));
    // A touching contact with friction is examined in sticking and free modes only, a corner not at all.
    let partly = here.standings.iter().zip(here.loading.contacts).filter(|(standing, contact)| match standing {
        Standing::Touching => contact.tangents() > 0,
        Standing::Cornered { .. } => true,
        Standing::OnCone { .. } | Standing::Settled(_) => false,
    });
    found.unexplored = found.unexplored.saturating_add(partly.count() as u64);
    for chosen in combinations(&options, MOST_MODES) {
        if chosen == modes {
            continue;
        }
        let system = ModeSystem::new(here.loading, &chosen, here.state);
        let nulls = nulls.and_then(|nulls| in_mode(&system, here, modes, nulls));
        let point = BranchingPoint { here, modes: &chosen, system, eigenvalues: None, nulls: nulls.as_ref() };
        match point.all_directions(&mut found.degenerate) {
            Some(directions) => directions.into_iter().for_each(|direction| point.add_if_tried(direction, found)),
            None => found.degenerate = true,
        }
    }
}

/// The null vectors of a mode, computed from the null vectors of another.
fn in_mode(
    system: &ModeSystem<'_>,
    here: SingularPoint<'_>,
    modes: &[Mode],
    nulls: &NullVectors,
) -> Option<NullVectors> {
    let other = ModeSystem::new(here.loading, modes, here.state);
    let rows = orthonormal(nulls.right.iter().map(|values| rate_recovery::rate_from(&other, here.state, values)))?;
    let unknowns = here.loading.structure.unknowns();
    let columns: Option<Vec<DVector<f64>>> =
        nulls.left.iter().map(|left| left.rows(0, unknowns).into_owned().try_normalize(0.0)).collect();
    Bordering::new(system, here.state.clone(), &rows, &columns?)?.null_vectors(SINGULAR_PIVOT)
}

/// Whether some motion without load among the null vectors leaves all contacts that can change at rest: then the
/// equations are singular in every mode of these contacts.
pub fn are_singular_in_all_modes(here: SingularPoint<'_>, modes: &[Mode], nulls: &NullVectors) -> bool {
    let system = ModeSystem::new(here.loading, modes, here.state);
    let can_change = |contact: &usize| !matches!(here.standings[*contact], Standing::Settled(_));
    let told: Vec<DVector<f64>> = nulls
        .right
        .iter()
        .map(|values| {
            let rate = rate_recovery::rate_from(&system, here.state, values);
            let size = rate.size();
            let motions = (0..modes.len())
                .filter(can_change)
                .flat_map(|contact| here.loading.relative_rate(contact, here.state, &rate));
            DVector::from_iterator(
                1 + 3 * (0..modes.len()).filter(can_change).count(),
                std::iter::once(rate.load).chain(motions).map(|value| value / size),
            )
        })
        .collect();
    let count = told.len();
    let gram = DMatrix::from_fn(count, count, |i, j| told[i].dot(&told[j]));
    gram.symmetric_eigenvalues().iter().any(|value| *value <= DOUBTFUL_MARGIN * DOUBTFUL_MARGIN)
}
