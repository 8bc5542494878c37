//! Loads that follow the structure: the external forces of the elements that stand for loads, and their rates.
//!
//! ```text
//! p_f(u) = -Σ_e A_eᵀ f_e(u_e),      ṗ_f = -Σ_e A_eᵀ K_e(u_e) u̇_e,      e: elements that stand for loads
//! ```
//!
//! `f_int` and its tangent contain these elements; energies and works need their part alone.

use crate::mechanics::structure::Structure;
use crate::mechanics::structure::assembly::{ForceBuffer, StiffnessBuffer};

/// The forces over all degrees of freedom; empty without such loads.
pub fn forces(structure: &Structure, displacement: &[f64]) -> Vec<f64> {
    if !structure.has_following_loads() {
        return Vec::new();
    }
    let (mut forces, mut buffer) = (vec![0.0; structure.freedoms()], ForceBuffer::default());
    for at in structure.elements().filter(|at| at.element.is_load()) {
        at.alone().each_force(displacement, &mut buffer, |freedom, value| forces[freedom] -= value);
    }
    forces
}

/// The derivatives of the [`forces`] by arc length, for the rate of all degrees of freedom.
pub fn force_rates(structure: &Structure, displacement: &[f64], rate: &[f64]) -> Vec<f64> {
    let (mut rates, mut buffer) = (vec![0.0; structure.freedoms()], StiffnessBuffer::default());
    for at in structure.elements().filter(|at| at.element.is_load()) {
        at.alone().each_stiffness(displacement, &mut buffer, &mut |row, column, value| {
            rates[row] -= value * rate[column];
        });
    }
    rates
}
