//! Energies and modes.
//!
//! ```text
//! ΔW = f_held·Δu + ½ (s₀ + s₁) f·Δu + ½ (p₀ + p₁)·Δu + ½ (R₀ + R₁)·Δu_support + ½ Σ (F₀ + F₁)·Δx_obstacle
//! ΔD = -½ Σ (t₀ + t₁)·Δx_slip
//! ```
//!
//! by the trapezoidal rule; `p` are loads that follow the structure, `R` the forces of supports, `F` those of obstacles
//! on nodes. `strain` is the structure's strain energy alone: the elastic energy of the penalties is in none of the
//! three, so that it appears in `energy_error`.

use crate::continuation::penalty::law::PenaltyResponse;
use crate::continuation::penalty::penalty_equations::{PenaltyPoint, PenaltySystem};
use crate::mechanics::contact::Mode;
use crate::mechanics::contact::vector::{add, dot, size};
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::structure::following_loads;
use crate::result::increment::Status;

/// `(ΔW, ΔD)` of an increment.
pub fn work_and_dissipation(system: &PenaltySystem<'_>, from: &PenaltyPoint, to: &PenaltyPoint) -> (f64, f64) {
    let loading = system.loading;
    let mean_load = 0.5 * (from.state.load + to.state.load);
    let mut work = 0.0;
    let change: Vec<f64> =
        to.state.displacement.iter().zip(&from.state.displacement).map(|(end, start)| end - start).collect();
    for (freedom, change) in change.iter().enumerate() {
        work += (loading.held.forces[freedom] + mean_load * loading.pattern.forces[freedom]) * change;
    }
    let following = [from, to].map(|at| following_loads::forces(loading.structure, &at.state.displacement));
    for (change, (before, after)) in change.iter().zip(following[0].iter().zip(&following[1])) {
        work += 0.5 * (before + after) * change;
    }
    if loading.pattern.moves_boundary() {
        let (start, end) = (system.evaluate(from, &from.state), system.evaluate(from, &to.state));
        for (freedom, change) in change.iter().enumerate() {
            if loading.structure.unknown_of[freedom].is_none() {
                work += 0.5 * (start.unbalanced[freedom] + end.unbalanced[freedom]) * change;
            }
        }
        for (index, (before, after)) in from.contacts.iter().zip(&to.contacts).enumerate() {
            let moved = contact_jacobian::velocity(
                loading.structure,
                &loading.contacts[index],
                &from.state.displacement,
                &change,
            );
            let relative = loading.relative_motion(index, &from.state, &to.state);
            let obstacle = add(&moved, -1.0, &relative);
            work += 0.5 * dot(&add(&before.force, 1.0, &after.force), &obstacle);
        }
    }
    let dissipated = from.contacts.iter().zip(&to.contacts).map(|(before, after)| dissipation(before, after)).sum();
    (work, dissipated)
}

fn dissipation(before: &PenaltyResponse, after: &PenaltyResponse) -> f64 {
    let (first, last) = (&before.reaction.tangential, &after.reaction.tangential);
    let at_end = -dot(last, &after.slip);
    // Slip that has just begun or reversed took place approximately at the final reaction.
    let went_on = before.status == Status::Slip && dot(first, last) > 0.0;
    if went_on { 0.5 * (at_end - dot(first, &after.slip)) } else { at_end }
}

/// Violation of the exact law by the regularised one: the largest penetration or elastic slip.
pub fn give(system: &PenaltySystem<'_>, point: &PenaltyPoint) -> f64 {
    let of_contact = |response: &PenaltyResponse| {
        let tangential = size(&response.reaction.tangential) / system.penalties.tangential;
        tangential.max(response.reaction.normal / system.penalties.normal)
    };
    point.contacts.iter().map(of_contact).fold(0.0, f64::max)
}

/// Contact modes in the increment that led to the point.
pub fn modes(point: &PenaltyPoint) -> Vec<Mode> {
    let mode = |response: &PenaltyResponse| match response.status {
        Status::Free => Mode::Free,
        Status::Stick => Mode::Stick,
        Status::Slip => Mode::Slip { direction: [0.0; 3] },
    };
    point.contacts.iter().map(mode).collect()
}
