//! The path's direction at a converged point, by a factorisation there or nearby.

use crate::algebra::SystemFactorisation;
use crate::algebra::sparse::SparseFactorisation;
use crate::algebra::sparse::preconditioned_refinement::Nearby;
use crate::mechanics::equations::corrected_point::{Corrected, Tangent};
use crate::mechanics::equations::{Iterate, Kind, ModeSystem, Role, matrix, mode_factorisation, rate_recovery};
use crate::mechanics::problem::state::Rate;
use crate::step::corrector::tolerances::{REUSABLE_PIVOT_RATIO, UNCERTAIN_PIVOT_RATIO};

/// Number of contacts whose stiffness is found together: no more memory than a factorisation takes, however many slip.
const TOGETHER: usize = 32;

/// The path's direction at a converged point, and an estimate of the point's error: the size of one more Newton
/// correction across the path.
///
/// `serving` is a factorisation of the equations nearby, if there is one. Where it is not suitable, a factorisation at
/// the point itself takes its place, and `factorisations` counts it.
pub fn tangent_and_error(
    system: &ModeSystem<'_>,
    corrected: &Corrected,
    towards: &Rate,
    serving: &mut Option<SystemFactorisation>,
    factorisations: &mut u64,
) -> Option<Tangent> {
    let iterate = system.iterate_of(corrected);
    if let Some(SystemFactorisation::Sparse(nearby)) = serving
        && let Some(rate) = tangent_nearby(system, nearby, &iterate, towards)
        && let Some(error) = error_by(system, nearby, corrected)
    {
        let (determinant, stiffness_across) = (Some(nearby.determinant_sign()), Vec::new());
        return Some(Tangent { rate, error, determinant, stiffness_across });
    }
    *factorisations += 1;
    let factorisation = mode_factorisation::factorise_bordered(system, &iterate, towards)?;
    let mut values = corrected.left_over.clone();
    values[system.size - 1] = 0.0;
    if !factorisation.solve(&mut values) {
        return None;
    }
    let error = rate_recovery::length_of(system, &values);
    rate_recovery::border_into(system, &mut values);
    if !factorisation.solve(&mut values) {
        return None;
    }
    let rate = rate_recovery::direction_from(system, &iterate, &values)?;
    let stiffness_across = stiffness_across_slips(system, &factorisation);
    let certain = factorisation.pivot_ratio() > UNCERTAIN_PIVOT_RATIO;
    let determinant = certain.then(|| factorisation.determinant_sign());
    *serving = may_serve(system, factorisation);
    Some(Tangent { rate, error, determinant, stiffness_across })
}

/// The stiffness of each contact across its slip, where that may turn; empty where no slip may.
fn stiffness_across_slips(system: &ModeSystem<'_>, factorisation: &SystemFactorisation) -> Vec<Option<f64>> {
    if !system.has_tracks() {
        return Vec::new();
    }
    let in_planes = system.roles.iter().enumerate().filter(|(_, role)| matches!(role, Role::Plane { .. }));
    let in_planes: Vec<usize> = in_planes.map(|(contact, _)| contact).collect();
    let mut stiffness = vec![None; system.roles.len()];
    for contacts in in_planes.chunks(TOGETHER) {
        let mut values = vec![0.0; contacts.len() * system.size];
        for (right, contact) in values.chunks_exact_mut(system.size).zip(contacts) {
            right[system.row_of(*contact) + 1] = 1.0;
        }
        if factorisation.solve_all(&mut values, system.size) {
            for (solution, contact) in values.chunks_exact(system.size).zip(contacts) {
                stiffness[*contact] = Some(-solution[system.column_of(*contact) + 1]);
            }
        }
    }
    stiffness
}

/// An estimate of a point's error by a factorisation nearby.
pub(crate) fn error_by(system: &ModeSystem<'_>, nearby: &SparseFactorisation, corrected: &Corrected) -> Option<f64> {
    let mut values = corrected.left_over.clone();
    values[system.size - 1] = 0.0;
    let solved = nearby.solve_once(&mut values);
    solved.then(|| rate_recovery::length_of(system, &values))
}

/// The factorisation, where it may be reused nearby: not with slips in planes, whose directions have equations of their
/// own, nor where it is dense, since dense matrices are factorised as fast.
pub(crate) fn may_serve(system: &ModeSystem<'_>, factorisation: SystemFactorisation) -> Option<SystemFactorisation> {
    let may = matches!(factorisation, SystemFactorisation::Sparse(_)) && !system.has_tracks();
    may.then_some(factorisation)
}

/// The path's direction by a factorisation of the equations nearby.
fn tangent_nearby(
    system: &ModeSystem<'_>,
    nearby: &SparseFactorisation,
    iterate: &Iterate,
    towards: &Rate,
) -> Option<Rate> {
    if nearby.pivot_ratio() < REUSABLE_PIVOT_RATIO {
        return None;
    }
    let nearby = Nearby::new(nearby, matrix::assemble_sparse(system, iterate, Kind::Rates)?)?;
    let values = nearby.solve(&rate_recovery::bordering(system))?;
    // The direction is on the same side of both borders, so that the determinants have the same sign.
    rate_recovery::direction_from(system, iterate, &values).filter(|rate| rate.product(towards) > 0.0)
}
