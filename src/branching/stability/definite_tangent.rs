//! A test that is sufficient for stability, however many contacts can change.
//!
//! A motion `v` that grows in some mode slips by `α_c ≥ 0` along the direction `d_c` at each contact on its friction cone
//! and opens or slides at contacts without reaction. Tested with `w = v + Σ μ_c α_c n_c`, where `n_c` moves contact `c`
//! alone along its normal, the friction of the slipping contacts does no work and the rest does none that drives:
//!
//! ```text
//! λ² wᵀ v <= - wᵀ K v
//! ```
//!
//! If the symmetric parts of both forms are positive for all `v` that the contacts allow, no motion grows.

use crate::algebra::null_space;
use crate::branching::stability::AssessedState;
use crate::branching::stability::tolerances::DEFINITE;
use crate::mechanics::contact::vector::{Vector, dot};
use crate::mechanics::contact::{Mode, Sliding};
use crate::mechanics::equations::tolerances::RANK_TOLERANCE;
use crate::mechanics::equations::{ModeSystem, matrix};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::step::corrector::cost_counters::Work;
use nalgebra::{Cholesky, DMatrix};

/// Whether the form is positive; `false` where it is not known.
pub(super) fn is_definite(at: AssessedState<'_>, work: &mut Work) -> bool {
    let (structure, contacts) = (at.loading.structure, at.loading.contacts);
    let unknowns = structure.unknowns();
    let mut modes = Vec::with_capacity(contacts.len());
    for (standing, contact) in at.standings.iter().zip(contacts) {
        modes.push(match standing {
            Standing::Settled(mode) => *mode,
            Standing::Touching if contact.tangents() == 0 => Mode::Free,
            Standing::OnCone { direction } if !matches!(contact.sliding, Sliding::Plane) => {
                Mode::Slip { direction: *direction }
            }
            Standing::Touching | Standing::OnCone { .. } | Standing::Cornered { .. } => return false,
        });
    }
    let system = ModeSystem::new(at.loading, &modes, at.state);
    let equations = matrix::rate_matrix(&system, at.state);
    let constraints = system.size() - 1 - unknowns;
    let tangent = equations.view((0, 0), (unknowns, unknowns)).into_owned();
    let held = equations.view((unknowns, 0), (constraints, unknowns)).into_owned();
    // The motions of the other contacts that can change: along the slip, or along the normal.
    let changing: Vec<(usize, Vector, f64)> = (0..contacts.len())
        .filter_map(|contact| match at.standings[contact] {
            Standing::OnCone { direction } => Some((contact, direction, contacts[contact].friction.bound(1.0))),
            Standing::Touching => Some((contact, at.loading.frame(contact, at.state).normal, 0.0)),
            Standing::Settled(_) | Standing::Cornered { .. } => None,
        })
        .collect();
    let mut along = DMatrix::zeros(changing.len(), unknowns);
    for (row, (contact, direction, _)) in changing.iter().enumerate() {
        at.loading.each_column(*contact, at.state, |freedom, column| {
            if let Some(unknown) = structure.unknown_of[freedom] {
                along[(row, unknown)] += dot(column, direction);
            }
        });
    }
    let all = DMatrix::from_fn(constraints + changing.len(), unknowns, |row, column| {
        if row < constraints { held[(row, column)] } else { along[(row - constraints, column)] }
    });
    let Ok(inverse) = all.pseudo_inverse(RANK_TOLERANCE) else { return false };
    let (mut stiffness, mut mass) = (tangent.clone(), DMatrix::identity(unknowns, unknowns));
    for (row, (contact, _, friction)) in changing.iter().enumerate().filter(|(_, (_, _, friction))| *friction > 0.0) {
        // The motion that moves this contact along its normal, and no other in any way.
        let normal = inverse.column(system.row_of(*contact) - unknowns);
        let slip = along.row(row).transpose() * *friction;
        stiffness += &slip * (tangent.transpose() * normal).transpose();
        mass += &slip * normal.transpose();
    }
    let basis = match constraints {
        0 => Some(DMatrix::identity(unknowns, unknowns)),
        _ => null_space(&held, RANK_TOLERANCE),
    };
    let Some(basis) = basis else { return false };
    work.factorisations += 1;
    basis.ncols() == 0 || [stiffness, mass].iter().all(|form| is_positive(&(basis.transpose() * form * &basis)))
}

/// Whether the symmetric part of a matrix is positive definite beyond round-off.
fn is_positive(form: &DMatrix<f64>) -> bool {
    let mut symmetric = (form + form.transpose()) * 0.5;
    let margin = DEFINITE * symmetric.amax();
    (0..symmetric.nrows()).for_each(|place| symmetric[(place, place)] -= margin);
    Cholesky::new(symmetric).is_some()
}
